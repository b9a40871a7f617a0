"""Radiance in a slab as a sum of modes that grow or decay exponentially, once the angles are discrete.

At nodes mu_i of a quadrature on (0, 1) let p = I(mu) + I(-mu) and q = I(mu) - I(-mu). With x the depth from the middle
of a slab of half thickness h, every solution is a sum over modes k_j of

    even:  p = p_j cosh(k_j x) / cosh(k_j h),         q = -q_j k_j sinh(k_j x) / cosh(k_j h),
    odd:   p = p_j sinh(k_j x) / (k_j cosh(k_j h)),   q = -q_j cosh(k_j x) / cosh(k_j h).

Even and odd illumination decouple, nothing overflows however thick the slab is, and the odd solution has a limit where
a mode's k vanishes, which happens when nothing is absorbed.
Source: Chandrasekhar 1960, Radiative Transfer, chapters 3 and 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988.
"""

from __future__ import annotations

from functools import cache
from typing import Literal, NamedTuple

import numpy as np

SOURCE = "Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988"

Parity = Literal["even", "odd"]
PARITIES: tuple[Parity, Parity] = ("even", "odd")


class Modes(NamedTuple):
    """Modes of a medium at n nodes: real, or complex for a complex albedo.

    mu, w   (n,) nodes and weights on (0, 1)
    k       (m,) per mean free path, real part >= 0
    p, q    (n, m) as above
    source  (L + 1, m) Legendre moments of the scattered source: sum_l P_l(mu) source[l, j] is what mode j scatters
            into mu, from p for even l and from q for odd l
    """

    mu: np.ndarray
    w: np.ndarray
    k: np.ndarray
    p: np.ndarray
    q: np.ndarray
    source: np.ndarray


def quadrature(smallest: float, n: int, top: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights on (0, top): 2 n of them, and at most n more for each factor 6 of top below 3 `smallest`.

    Radiance is of the form a(mu) + b(mu) ln(mu) near mu = 0, and it changes where mu is about the thickness of the slab:
    `smallest` is the smallest mu that matters. The lowest panel has nodes y^2 of a Gauss-Legendre rule in y, the others
    are geometric.
    """
    low = min(top, max(3 * smallest, 1e-14))
    count = max(0, int(np.ceil(np.log(top / low) / np.log(6))))
    few = n if count == 0 else min(n, 20)
    y, v = unit_rule(2 * few)
    if count == 0:
        return top * y * y, 2 * top * y * v
    edges = low * (top / low) ** (np.arange(count + 1) / count)
    mu, w = [low * y * y], [2 * low * y * v]
    for a, b, size in zip(edges[:-1], edges[1:], [few] * (count - 1) + [n], strict=True):
        y, v = unit_rule(size)
        mu.append(a + (b - a) * y)
        w.append((b - a) * v)
    return np.concatenate(mu), np.concatenate(w)


@cache
def unit_rule(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the Gauss-Legendre rule of n nodes on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(n)
    return (1 + x) / 2, w / 2


def shape_at_boundary(modes: Modes, half: float, parity: Parity) -> tuple[np.ndarray, np.ndarray]:
    """Return p and -q of every mode at the boundary x = h, (n, m) each."""
    with np.errstate(under="ignore"):
        t = np.tanh(modes.k * half)
    if parity == "even":
        return modes.p, modes.q * (modes.k * t)
    return modes.p * _over_k(t, modes.k, half), modes.q


def _over_k(t: np.ndarray, k: np.ndarray, half: float) -> np.ndarray:
    """Return tanh(k h) / k."""
    small = np.abs(k) * half < 1e-8
    return np.where(small, half, t / np.where(small, 1.0, k))


def amplitudes(
    modes: Modes, half: float, parity: Parity, incoming: np.ndarray, mirror: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return the amplitudes (m,) for which the radiance that enters at x = h is incoming + mirror * what leaves, (n,).

    At x = -h the same enters, with the opposite sign if odd.
    """
    p, d = shape_at_boundary(modes, half, parity)
    mirror = np.broadcast_to(mirror, modes.mu.shape)[:, None]
    system = ((1 - mirror) * p + (1 + mirror) * d) / 2
    scale = 1 / np.abs(system).max(axis=0)
    return np.linalg.solve(system * scale, incoming) * scale


def leaving(modes: Modes, half: float, parity: Parity, amplitude: np.ndarray) -> np.ndarray:
    """Return the radiance that leaves at x = h at the nodes, (n,)."""
    p, d = shape_at_boundary(modes, half, parity)
    return ((p - d) / 2) @ amplitude


def scattered(modes: Modes, half: float, parity: Parity, amplitude: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return what is scattered into directions mu (v,) along the way from x = -h and arrives at x = h, (v,).

    This is the integral of the source times exp(-(h - x)/mu) over dx/mu, in closed form for each mode.
    """
    even, odd = _source(modes, mu)
    k, m = modes.k, mu[:, None]
    with np.errstate(under="ignore", over="ignore"):
        mode_decay, ray_decay = np.exp(-2 * half * k), np.exp(-2 * half / m)
        plus = -np.expm1(-2 * half * (k + 1 / m)) / (1 + k * m)
        minus = _difference(mode_decay, ray_decay, k, m, half)
        cosh, sinh = (plus + minus) / (1 + mode_decay), (plus - minus) / (1 + mode_decay)
        if parity == "even":
            return (even * cosh - odd * (k * sinh)) @ amplitude
        t = _over_k(np.tanh(k * half), k, half)
        slow = np.abs(k * m) < 0.5
        sinh_over_k = np.where(
            slow,
            (t - m + (t + m) * ray_decay) / np.where(slow, (1 - k * m) * (1 + k * m), 1.0),
            sinh / np.where(slow, 1.0, k),
        )
        return (even * sinh_over_k - odd * cosh) @ amplitude


def _difference(
    mode_decay: np.ndarray, ray_decay: np.ndarray, k: np.ndarray, mu: np.ndarray, half: float
) -> np.ndarray:
    """Return (exp(-2 k h) - exp(-2 h/mu)) / (1 - k mu), whose limit at k mu = 1 is (2 h/mu) exp(-2 h/mu)."""
    z = (2 * half / mu) * (1 - k * mu)
    positive = np.real(z) >= 0
    magnitude = np.where(positive, z, -z)
    small = np.abs(magnitude) < 1e-5
    safe = np.where(small, 1.0, magnitude)
    ratio = np.where(small, 1 - magnitude / 2 + magnitude * magnitude / 6, -np.expm1(-safe) / safe)
    return (2 * half / mu) * np.where(positive, mode_decay, ray_decay) * ratio


def _source(modes: Modes, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what each mode scatters into mu from p and from q, (v, m) each."""
    P = legendre(len(modes.source) - 1, mu)
    return P[0::2].T @ modes.source[0::2], P[1::2].T @ modes.source[1::2]


def legendre(highest: int, mu: np.ndarray) -> np.ndarray:
    """Return P_0 … P_highest at mu (v,), (highest + 1, v)."""
    P = np.ones((highest + 1, len(mu)))
    if highest:
        P[1] = mu
    for n in range(1, highest):
        P[n + 1] = ((2 * n + 1) * mu * P[n] - n * P[n - 1]) / (n + 1)
    return P
