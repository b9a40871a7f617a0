"""Bugs of microfacet lobes: GGX (Walter et al. 2007), sampled by visible normals (Heitz 2018)."""

from __future__ import annotations

import numpy as np

from fogproof.zoo.bug import Bug, sampler_bug
from fogproof.zoo.laws import Array

ALPHA = 0.5
OUT = np.array([np.sin(1.05), 0.0, np.cos(1.05)])


def visible(u: Array) -> Array:
    """Return directions reflected at visible normals, seen from OUT; some lie below the surface."""
    w = OUT * (ALPHA, ALPHA, 1)
    w /= np.linalg.norm(w)
    across = np.array([-w[1], w[0], 0.0]) / np.hypot(w[0], w[1])
    upward = np.cross(w, across)
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    a, b = r * np.cos(phi), r * np.sin(phi)
    share = 0.5 * (1 + w[2])
    b = (1 - share) * np.sqrt(1 - a * a) + share * b
    c = np.sqrt(np.maximum(1 - a * a - b * b, 0))
    normal = (a[:, None] * across + b[:, None] * upward + c[:, None] * w) * (ALPHA, ALPHA, 1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    x = 2 * (normal @ OUT)[:, None] * normal - OUT
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _seen(cosine: Array) -> Array:
    """Return Smith's masking over the cosine of its direction."""
    tangent = (1 - cosine * cosine) / (cosine * cosine)
    return 2 / (1 + np.sqrt(1 + ALPHA * ALPHA * tangent)) / cosine


def _distribution(x: Array) -> Array:
    half = x + OUT
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), 1e-300)
    d = ALPHA**2 / (np.pi * (half[:, 2] ** 2 * (ALPHA**2 - 1) + 1) ** 2)
    return np.where(half[:, 2] > 0, d, 0.0)


def density(x: Array) -> Array:
    """Return the density of `visible` [1/sr]."""
    return _distribution(x) * _seen(OUT[2]) / 4


def _swapped(x: Array) -> Array:
    return _distribution(x) * _seen(np.maximum(np.abs(x[:, 2]), 1e-6)) / 4


def bugs() -> list[Bug]:
    """Return it."""
    return [
        sampler_bug(
            "density of the way in for that of the way out",
            "pbrt-v4#215",
            visible,
            _swapped,
            ("normalisation", "wrong measure"),
        )
    ]
