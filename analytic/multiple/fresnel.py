"""Transmission of unpolarised light at a smooth boundary between two dielectrics."""

from __future__ import annotations

from typing import Any

import numpy as np


def transmissivity(index: float, inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """Return the share that crosses the boundary of a medium of refractive index >= 1, the same in both directions.

    inside, outside  (...) cosines on either side that belong together by Snell's law; outside = 0 beyond the critical angle

    It is 1 minus the reflectance, written as a product: no digit is lost at grazing angles. Relative error: 12 eps.
    Source: Fresnel 1823; Born & Wolf 1999, Principles of Optics, section 1.5.2.
    """
    if index == 1:
        return np.ones(np.broadcast_shapes(np.shape(inside), np.shape(outside)))
    s, p = index * inside + outside, index * outside + inside
    return 2 * (index * inside / s / s + index * inside / p / p) * outside


def reflectivity(index: float, inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """Return 1 - `transmissivity`, in a form in which no digit is lost where the index is close to 1. Relative error: 32 eps.

    By Snell's law (n inside)^2 = n^2 - 1 + outside^2, which takes n^2 - 1 out of both amplitudes.
    """
    if index == 1:
        return np.zeros(np.broadcast_shapes(np.shape(inside), np.shape(outside)))
    excess = (index - 1) * (index + 1)
    s = excess / np.square(index * inside + outside)
    p = excess * ((index * index + 1) * np.square(outside) - 1) / np.square(index * (index * outside + inside))
    return np.where(outside > 0, (s * s + p * p) / 2, 1.0)


def inside_cosine(index: float, mu: Any) -> np.ndarray:
    """Return the cosine inside for cosines mu outside (Snell's law)."""
    if index == 1:
        return np.asarray(mu, float)
    with np.errstate(under="ignore"):
        return np.sqrt((index - 1) * (index + 1) + np.square(mu)) / index
