"""Densities and samplers that planted bugs share, written as those who shipped the bugs wrote them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Array = np.ndarray
Function = Callable[[Array], Array]


def ones(x: Array) -> Array:
    """Return the density 1, (n,)."""
    return np.ones(len(x))


def even(x: Array) -> Array:
    """Return the uniform density on the sphere [1/sr]."""
    return np.full(len(x), 0.25 / np.pi)


def directions(mu: Array, turn: Array) -> Array:
    """Return unit vectors (n, 3) with cosine mu about z and a share `turn` of the full circle."""
    sine, phi = np.sqrt(np.maximum(1 - mu * mu, 0)), 2 * np.pi * turn
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


def hg_cosine(g: float, u: Array) -> Array:
    """Return the cosine of Henyey & Greenstein's law (1941) for uniforms u."""
    s = (1 - g * g) / (1 - g + 2 * g * u)
    return np.asarray(np.clip((1 + g * g - s * s) / (2 * g), -1, 1))


def hg(g: float) -> tuple[Function, Function]:
    """Return sampler and pdf [1/sr] of Henyey & Greenstein's phase function about z."""
    return (
        lambda u: directions(hg_cosine(g, u[:, 0]), u[:, 1]),
        lambda x: (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]) ** 1.5),
    )


def frame(normal: tuple[float, float, float]) -> Array:
    """Return rows (t1, t2, normal) of an orthonormal frame."""
    n = np.asarray(normal) / np.linalg.norm(normal)
    t = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    t /= np.linalg.norm(t)
    return np.stack([t, np.cross(n, t), n])
