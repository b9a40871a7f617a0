"""Integrals of a density over its domain, with error bounds."""
