"""Cornette & Shanks 1992: Draine's function with alpha = 1."""

from fogproof.analytic.phase.draine import METHOD, airlight, ball, cdf, legendre_moments, mean_cosine, pdf, peak

SOURCE = "Cornette & Shanks 1992, Appl. Opt. 31, 3152"

__all__ = ["METHOD", "SOURCE", "airlight", "ball", "cdf", "legendre_moments", "mean_cosine", "pdf", "peak"]
