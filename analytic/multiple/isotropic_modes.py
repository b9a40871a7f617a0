"""Modes of isotropic scattering: the roots of the dispersion relation, each found to full relative accuracy.

With x = 1/k^2 the modes are the roots of

    (1 - c) - c sum_i w_i mu_i^2 / (x - mu_i^2) = 0,

one between any two mu_i^2, one above them all; it goes to infinity as c -> 1, and 1 - c stands there on its own, so
nothing is lost. A root is held as its distance from the nearest mu_i^2, which makes every x_j - mu_i^2 accurate too: the
modes 1/(1 - k^2 mu_i^2) and the system for their amplitudes then have no error but rounding.
Source: Chandrasekhar 1960, Radiative Transfer, section 21; Gu & Eisenstat 1994 for holding roots by their distances.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.multiple.slab_modes import Modes

ROUNDS = 100
"""Most steps of the bracketed Newton iteration; about eight are needed."""


def isotropic_modes(c: float, absorbed: float, mu: np.ndarray, w: np.ndarray) -> Modes:
    """Return the modes for an albedo c in (0, 1] at nodes mu (n,) with weights w.

    absorbed  1 - c
    """
    order = np.argsort(mu)
    pole, weight = mu[order], c * (w * mu * mu)[order]
    nearest, distance = _between(absorbed, pole, weight)
    last = len(pole) - 1
    nearest, distance = np.append(nearest, last), np.append(distance, _above(absorbed, pole, weight))
    near = pole[nearest]
    below = np.isfinite(distance)  # k = 0 otherwise
    gaps = (near - mu[:, None]) * (near + mu[:, None]) + np.where(below, distance, 0.0)
    x = near * near + np.where(below, distance, 0.0)
    k = np.where(below, 1 / np.sqrt(x), 0.0)
    p = np.where(below, x / np.where(below, gaps, 1.0), 1.0)
    return Modes(mu, w, k, p, mu[:, None] * p, np.full((1, len(k)), 0.5))


def _between(absorbed: float, pole: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return, for the root between each two poles, the nearer pole and the signed distance from it in mu^2."""
    n = len(pole) - 1
    left = np.arange(n)
    squares = (pole[:, None] - pole) * (pole[:, None] + pole)
    half = (pole[1:] - pole[:-1]) * (pole[1:] + pole[:-1]) / 2
    at_middle = absorbed - np.sum(weight / (squares[left] + half[:, None]), axis=1)
    nearest = np.where(at_middle < 0, left + 1, left)
    sign = np.where(at_middle < 0, -1.0, 1.0)
    own, gaps = weight[nearest], squares[nearest]

    def rest(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the relation without its own pole, times the sign, and its derivative; both change little."""
        terms = gaps + (sign * d)[:, None]
        terms[left, nearest] = np.inf
        terms = weight / terms
        with np.errstate(under="ignore"):
            slope = np.sum(terms * terms / weight, axis=1)
        return sign * (absorbed - np.sum(terms, axis=1)), slope

    # In d = |x - pole| the root is where rest(d) = own/d; rest grows with d, and own/d falls.
    low, high = np.zeros(n), half
    d = np.minimum(own / np.maximum(rest(half)[0], own / half), half)
    for _ in range(ROUNDS):
        value, slope = rest(d)
        f = value * d - own  # grows through the root
        low, high = np.where(f < 0, d, low), np.where(f < 0, high, d)
        step = d - f / (value + slope * d)
        step = np.where((step > low) & (step < high), step, (low + high) / 2)
        done = np.abs(step - d) <= 1e-16 * d
        d = np.where(f == 0, d, step)
        if np.all(done | (f == 0)):
            break
    return nearest, sign * d


def _above(absorbed: float, pole: np.ndarray, weight: np.ndarray) -> float:
    """Return the distance of the largest root from the largest pole, inf if nothing is absorbed."""
    if absorbed == 0:
        return np.inf
    gaps = (pole[-1] - pole) * (pole[-1] + pole)
    # sum weight/(gaps + d) = absorbed is convex and falls: Newton from below climbs monotonically, in 1/d even faster.
    low, high = weight[-1] / absorbed, float(np.sum(weight)) / absorbed
    d = low
    for _ in range(ROUNDS):
        terms = weight / (gaps + d)
        total = float(np.sum(terms))
        f = 1 / total - 1 / absorbed  # nearly linear in d
        step = d - f * total * total / float(np.sum(terms / (gaps + d)))
        step = min(max(step, low), high)
        if abs(step - d) <= 2e-16 * d:
            return step
        d = step
    return d
