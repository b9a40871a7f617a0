"""Cornette & Shanks 1992: Draine's function with alpha = 1."""

from fogproof.estimators.phase.draine import cosines, density, polar

__all__ = ["cosines", "density", "polar"]
