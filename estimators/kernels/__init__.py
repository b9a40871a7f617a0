"""Loops that branch per ray, compiled by numba when first used."""
