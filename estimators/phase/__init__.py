"""Samplers of phase functions."""
