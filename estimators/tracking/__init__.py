"""Trackers: delta, ratio, residual ratio, regular and marched."""
