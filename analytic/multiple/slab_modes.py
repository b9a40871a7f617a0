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

import math
from typing import Literal, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.gauss_legendre import unit_rule

SOURCE = "Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988"

Parity = Literal["even", "odd"]
PARITIES: tuple[Parity, Parity] = ("even", "odd")


FINEST = 1e-18
"""Smallest cosine told from 0: what is seen there changes like mu ln(mu)."""

FEWEST = 4

BLOCK = 4096
"""Directions whose modes are in memory at the same time."""

BEND = 0.98
"""Share of y^2 in the substitution at mu = 0: with 1 the smallest node would be 25 times smaller, and nothing gained."""

PRECISION = 2.0**52


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


def quadrature(smallest: float, n: int, top: float = 1.0, weight: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights on (0, top): 2 n of them, and at most n more for each factor 6 of top below 3 `smallest`.

    Radiance is of the form a(mu) + b(mu) ln(mu) near mu = 0, and it changes where mu is about the thickness of the slab:
    `smallest` is the smallest mu that matters. The lowest panel has nodes of a Gauss-Legendre rule in y, nearly y^2, the
    others end at top/6, top/36, … The error of n nodes on one of them is about 6^(-n), of which only a share counts: its
    upper end over `smallest`, or `weight`.
    """
    count = max(0, math.ceil(math.log(top / min(top, max(3 * smallest, FINEST))) / math.log(6)))
    ends = top * 6.0 ** -np.arange(count, -1, -1)
    share = np.minimum(1.0, np.maximum(np.minimum(ends, weight), smallest))
    sizes = np.maximum(FEWEST, np.ceil(n * (1 + np.log(np.maximum(share, FINEST)) / math.log(PRECISION)))).astype(int)
    y, v = unit_rule(2 * (n if count == 0 else int(sizes[0])))
    mu, w = [ends[0] * y * (1 - BEND + BEND * y)], [ends[0] * (1 - BEND + 2 * BEND * y) * v]
    for a, b, size in zip(ends[:-1], ends[1:], sizes[1:], strict=True):
        y, v = unit_rule(int(size))
        mu.append(a + (b - a) * y)
        w.append((b - a) * v)
    return np.concatenate(mu), np.concatenate(w)


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
    return in_blocks(lambda some: (_scattered(modes, half, parity, amplitude, some),), BLOCK, mu)[0]


def _scattered(modes: Modes, half: float, parity: Parity, amplitude: np.ndarray, mu: np.ndarray) -> np.ndarray:
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
