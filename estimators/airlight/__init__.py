"""Estimators of single scattering."""
