"""Derivatives of the oracle's quantities by their parameters, and the laws of path length that are such derivatives."""
