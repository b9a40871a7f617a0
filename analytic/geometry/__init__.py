"""Rays and shapes: spans, chords, shadows."""
