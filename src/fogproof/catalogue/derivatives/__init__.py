"""Estimators of derivatives, of path lengths and of counts of scatterings."""
