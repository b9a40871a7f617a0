"""What a ray collects from a source that changes with the depth like one mode of a slab.

With y the distance from the dark side of a slab of thickness tau, the modes are held at its two sides:

    lit:   u(y) = sinh(k y)/sinh(k tau)     1 at the lit side, 0 at the dark one; y/tau for k = 0
    dark:  v(y) = exp(-k y)                 1 at the dark side

A source that is a sum of these with positive amplitudes gives positive integrals, whose relative accuracy no thickness
takes away: nothing here is a small difference of large numbers.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.gauss_legendre import RULES

_NODES, _WEIGHTS = RULES[12]

FARTHEST = 1.7e308
"""Optical depth along a ray beyond which nothing more changes."""


class Collected(NamedTuple):
    """Integrals of exp(-way/mu) over way/mu, the way from the source to the lit or to the dark side; from u and from v."""

    u_lit: np.ndarray
    u_dark: np.ndarray
    v_lit: np.ndarray
    v_dark: np.ndarray


def collected(k: np.ndarray, tau: np.ndarray, mu: np.ndarray) -> Collected:
    """Return the four integrals for k [per mean free path] >= 0, tau > 0 and cosines mu > 0, which broadcast.

    Relative error: below 16 eps + 2 eps (k tau + tau/mu), the latter in the exponents.
    """
    k, tau, mu = np.broadcast_arrays(k, tau, mu)
    with np.errstate(all="ignore"):
        z, s, bend = k * tau, np.minimum(tau / mu, FARTHEST), k * mu
        mode, ray = np.exp(-z), np.exp(-s)
        v_dark = -np.expm1(-(z + s)) / (1 + bend)
        apart = s * np.abs(1 - bend)
        near = apart < 1e-8
        away = s * np.where(near, 1 - apart / 2, -np.expm1(-apart) / np.where(near, 1.0, apart))
        v_lit = np.maximum(mode, ray) * away
        coth, csch = z_coth(z), z_csch(z)
        # Twice by parts where the mode changes slowly along the ray, else by the two exponentials of sinh.
        slow = bend < 0.5
        width, once = np.where(slow, (1 - bend) * (1 + bend), 1.0), np.where(z > 0, -np.expm1(-2 * z), 1.0)
        u_lit = np.where(slow, (1 - (coth - ray * csch) / s) / width, (v_dark - mode * v_lit) / once)
        u_dark = np.where(slow, ((csch - ray * coth) / s - ray) / width, (v_lit - mode * v_dark) / once)
        short = np.nonzero((z < 1) & (s < 2))
        if len(short[0]):
            z, s = z[short][:, None], s[short][:, None]
            u = np.where(z > 1e-8, np.sinh(z * _NODES) / np.sinh(np.maximum(z, 1e-8)), _NODES) * _WEIGHTS * s
            u_lit[short] = np.sum(u * np.exp(-s * (1 - _NODES)), axis=1)
            u_dark[short] = np.sum(u * np.exp(-s * _NODES), axis=1)
    return Collected(u_lit, u_dark, v_lit, v_dark)


def z_coth(z: Any) -> np.ndarray:
    """Return z coth z, 1 at z = 0."""
    small = np.abs(z) < 1e-4
    near = np.where(small, z, 0.0)
    return np.where(small, 1 + near * near / 3, z / np.where(small, 1.0, np.tanh(z)))


def z_csch(z: Any) -> np.ndarray:
    """Return z / sinh z, 1 at z = 0."""
    small, decay = np.abs(z) < 1e-4, np.exp(-z)
    near = np.where(small, z, 0.0)
    return np.where(small, 1 - near * near / 6, 2 * z * decay / np.where(small, 1.0, -np.expm1(-2 * z)))
