"""Arithmetic the oracle stands on: error-free transformations, double-double, Gauss-Legendre rules, vectors."""
