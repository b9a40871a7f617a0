"""Modes of isotropic scattering: the roots of the dispersion relation, each found to full relative accuracy.

With x = 1/k^2 the modes are the roots of

    (1 - c) - c sum_i w_i mu_i^2 / (x - mu_i^2) = 0,

one between any two mu_i^2, one above them all; it goes to infinity as c -> 1, and 1 - c stands there on its own, so
nothing is lost. A root is held as its distance from the nearest mu_i^2, which makes every x_j - mu_i^2 accurate too: the
modes 1/(1 - k^2 mu_i^2) and the system for their amplitudes then have no error but rounding.
Source: Chandrasekhar 1960, Radiative Transfer, section 21; Gu & Eisenstat 1994 for holding roots by their distances.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.multiple.slab_modes import Modes

ROUNDS = 100
"""Most steps of the bracketed Newton iteration; about eight are needed."""

SETTLED = 4 * 2.0**-53
"""Relative change that rounding explains."""


def isotropic_modes(c: Any, absorbed: Any, mu: np.ndarray, w: np.ndarray) -> Modes:
    """Return the modes for albedos c (...) in (0, 1] at nodes mu (n,) with weights w: k (..., n), p (..., n, n).

    absorbed  1 - c, of the same shape
    """
    order = np.argsort(mu)
    c, absorbed = np.asarray(c, float)[..., None], np.asarray(absorbed, float)[..., None]
    pole, weight = mu[order], c * (w * mu * mu)[order]
    nearest, distance = _between(absorbed, pole, weight)
    last = np.full(c.shape, len(pole) - 1)
    nearest = np.concatenate([nearest, last], axis=-1)
    distance = np.concatenate([distance, _above(absorbed, pole, weight)], axis=-1)
    near = pole[nearest]
    below = np.isfinite(distance)  # k = 0 otherwise
    distance = np.where(below, distance, 0.0)
    gaps = (near[..., None, :] - mu[:, None]) * (near[..., None, :] + mu[:, None]) + distance[..., None, :]
    x = near * near + distance
    k = np.where(below, 1 / np.sqrt(x), 0.0)
    below, x = below[..., None, :], x[..., None, :]
    p = np.where(below, x / np.where(below, gaps, 1.0), 1.0)
    return Modes(mu, w, k, p, mu[:, None] * p, np.full((1, len(mu)), 0.5))


def _between(absorbed: np.ndarray, pole: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return, for the root between each two poles, the nearer pole and the signed distance from it in mu^2."""
    n = len(pole) - 1
    left = np.arange(n)
    squares = (pole[:, None] - pole) * (pole[:, None] + pole)
    half = (pole[1:] - pole[:-1]) * (pole[1:] + pole[:-1]) / 2
    at_middle = absorbed - np.sum(weight[..., None, :] / (squares[left] + half[:, None]), axis=-1)
    nearest = np.where(at_middle < 0, left + 1, left)
    sign = np.where(at_middle < 0, -1.0, 1.0)
    own, gaps = np.take_along_axis(weight, nearest, axis=-1), squares[nearest]
    np.put_along_axis(gaps, nearest[..., None], np.inf, axis=-1)

    def rest(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the relation without its own pole, times the sign, and its derivative; both change little."""
        inverse = 1 / (gaps + (sign * d)[..., None])
        terms = weight[..., None, :] * inverse
        return sign * (absorbed - np.sum(terms, axis=-1)), np.sum(terms * inverse, axis=-1)

    # In d = |x - pole| the root is where rest(d) = own/d; rest grows with d, and own/d falls.
    low, high = np.zeros(own.shape), np.broadcast_to(half, own.shape)
    d = np.minimum(own / np.maximum(rest(high)[0], own / half), half)
    for _ in range(ROUNDS):
        value, slope = rest(d)
        f = value * d - own  # grows through the root
        low, high = np.where(f < 0, d, low), np.where(f < 0, high, d)
        step = d - f / (value + slope * d)
        step = np.where((step > low) & (step < high), step, (low + high) / 2)
        done = np.abs(step - d) <= SETTLED * d
        d = np.where(f == 0, d, step)
        if np.all(done | (f == 0)):
            break
    return nearest, sign * d


def _above(absorbed: np.ndarray, pole: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the distance of the largest root from the largest pole (..., 1), inf where nothing is absorbed."""
    gaps = (pole[-1] - pole) * (pole[-1] + pole)
    # sum weight/(gaps + d) = absorbed is convex and falls: Newton from below climbs monotonically, in 1/d even faster.
    some = np.where(absorbed > 0, absorbed, 1.0)
    low, high = weight[..., -1:] / some, np.sum(weight, axis=-1, keepdims=True) / some
    d = low
    for _ in range(ROUNDS):
        inverse = 1 / (gaps + d)
        terms = weight * inverse
        total = np.sum(terms, axis=-1, keepdims=True)
        f = 1 / total - 1 / some  # nearly linear in d
        step = np.clip(d - f * total * total / np.sum(terms * inverse, axis=-1, keepdims=True), low, high)
        done, d = np.abs(step - d) <= SETTLED * d, step
        if np.all(done):
            break
    return np.where(absorbed > 0, d, np.inf)
