"""Estimators with planted errors, for the broken twins."""
