"""Reflection of unpolarised light at a smooth boundary between two dielectrics."""

from __future__ import annotations

import numpy as np


def fresnel_inside(index: float, mu: np.ndarray) -> np.ndarray:
    """Return the reflectance seen from inside a medium of refractive index >= 1, at cosines mu in (0, 1].

    1 beyond the critical angle. By reciprocity it is also that seen from outside, at the refracted angle.
    Source: Fresnel 1823; Born & Wolf 1999, Principles of Optics, section 1.5.2.
    """
    if index == 1:
        return np.zeros_like(mu)
    outside = outside_cosine(index, mu)
    s = (index * mu - outside) / (index * mu + outside)
    p = (index * outside - mu) / (index * outside + mu)
    return np.where(outside > 0, (s * s + p * p) / 2, 1.0)


def outside_cosine(index: float, mu: np.ndarray) -> np.ndarray:
    """Return the cosine outside for cosines mu inside (Snell's law), 0 beyond the critical angle."""
    return np.sqrt(np.maximum(1 - index * index * (1 - mu) * (1 + mu), 0.0))


def inside_cosine(index: float, mu: np.ndarray) -> np.ndarray:
    """Return the cosine inside for cosines mu outside (Snell's law)."""
    return np.sqrt(1 - (1 - mu) * (1 + mu) / (index * index))
