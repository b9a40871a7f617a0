"""Fournier & Forand 1994, as printed by Fournier & Jonasz 1999, sampled by inverting their distribution of angles.

With nu = (3 - slope)/2 < 0, s = sin^2(angle/2) = (1 - mu)/2 and delta = 4 s/(3 (n-1)^2) the density is

    [nu (1-delta) - (1-delta^nu) + (delta (1-delta^nu) - nu (1-delta))/s] / (4 pi (1-delta)^2 delta^nu)
        + (1-delta_180^nu)/(16 pi (delta_180-1) delta_180^nu) (3 mu^2 - 1),

and the share up to an angle [(1-delta^(nu+1)) - (1-delta^nu) s]/((1-delta) delta^nu) + (same factor)/8 x mu sin^2. Near
delta = 1, where both are 0/0, powers of 1 - delta take over.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.special import expit

from fogproof.estimators.inversion import inverted
from fogproof.estimators.phase.polar import Polar
from fogproof.scene.phase import FournierForand

SERIES, TERMS = 0.35, 36
"""|1 - delta| up to which the series is summed, and its length: 0.35^36 < 1e-16."""

SMALLEST = 1e-300
FARTHEST, DENSE, NODES = 690.0, 50.0, 512
"""Of log(s/(1 - s)) in a table: the largest, where nodes begin to lie closer, and how many there are in a quarter of it."""


def _constants(phase: FournierForand) -> tuple[float, float, float]:
    """Return nu, delta/s, and the factor of the last term of the distribution."""
    nu, k = (3 - phase.junge_slope) / 2, 4 / (3 * (phase.refractive_index - 1) ** 2)
    return nu, k, (k**-nu - 1) / (k - 1) if k != 1 else -nu


def _binomials(nu: float) -> np.ndarray:
    """Return the coefficients of (delta^-nu - 1)/(delta - 1) in powers of delta - 1."""
    m = np.arange(1, TERMS)
    return -nu * np.cumprod(np.concatenate([[1.0], (-nu - m) / (m + 1)]))


def density(phase: FournierForand, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]; inf straight ahead."""
    nu, k, last = _constants(phase)
    s, rest = 0.5 * versine.astype(np.float64), 0.5 * coversine.astype(np.float64)
    mu = rest - s
    delta = k * np.maximum(s, SMALLEST)
    one = np.where(np.abs(1 - delta) < SERIES, 2.0, delta)
    with np.errstate(over="ignore"):
        power = one**-nu
        # Over delta^nu, and with 1/s - 1 = rest/s: no term is larger than what it adds to.
        bracket = (one * (power - 1) - nu * (1 - one) * power) * (rest / np.maximum(s, SMALLEST)) + (1 - one) * (
            1 - power
        )
        value = bracket / (1 - one) ** 2
    u = delta - 1
    series = np.abs(u) < SERIES
    if series.any():
        c = _binomials(nu)
        inner, slope = np.polynomial.polynomial.polyval(u[series], c), np.polynomial.polynomial.polyval(
            u[series], c[1:] * np.arange(1, TERMS)
        )  # fmt: skip
        value[series] = inner - k * rest[series] * slope
    value += last * (3 * mu * mu - 1) / 4
    return np.where(versine > 0, value / (4 * np.pi), np.inf).astype(versine.dtype)


def _within(phase: FournierForand, s: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return the share of light that scatters less than the angle with sin^2(angle/2) = s; rest = 1 - s."""
    nu, k, last = _constants(phase)
    delta = k * s
    series = np.abs(1 - delta) < SERIES
    one = np.where(series, 2.0, delta)
    value = (one**-nu * rest - one + s) / (1 - one)
    if series.any():
        inner = np.polynomial.polynomial.polyval(delta[series] - 1, _binomials(nu))
        value[series] = 1 - rest[series] * inner
    return value + last / 2 * (1 - 2 * s) * s * rest


def _beyond(phase: FournierForand, s: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return the share that scatters more: 1 less the other, with rest as a factor."""
    nu, k, last = _constants(phase)
    delta = k * s
    series = np.abs(1 - delta) < SERIES
    one = np.where(series, 2.0, delta)
    inner = (1 - one**-nu) / (1 - one)
    if series.any():
        inner[series] = np.polynomial.polynomial.polyval(delta[series] - 1, _binomials(nu))
    return rest * (inner - last / 2 * (1 - 2 * s) * s)


def polar(phase: FournierForand, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf.

    The share that scatters less is inverted where it is below half, else the one that scatters more. The unknown is log(s/(1 - s)):
    so either pole keeps its digits, also where the median angle itself is tiny.
    """
    wanted = xi.astype(np.float64)
    forward = wanted >= 0.5
    x = np.empty(len(xi))
    with np.errstate(under="ignore", divide="ignore"):
        x[forward] = _root(phase, _within, 1 - wanted[forward])
        x[~forward] = _root(phase, _beyond, wanted[~forward])
        s, rest = expit(x), np.where(wanted > 0, expit(-x), 0.0)
    versine = np.maximum(2 * s, np.finfo(xi.dtype).tiny)
    at_angle = versine.astype(xi.dtype), (2 * rest).astype(xi.dtype)
    return Polar(*at_angle, density(phase, *at_angle))


Share = Callable[[FournierForand, np.ndarray, np.ndarray], np.ndarray]


@lru_cache(maxsize=64)
def _table(phase: FournierForand, share: Share) -> tuple[np.ndarray, np.ndarray]:
    """Return the logarithm of a share, rising, and where it is that: between them, where Newton's method starts."""
    x = np.concatenate([np.linspace(-FARTHEST, -DENSE, NODES), np.linspace(-DENSE, DENSE, 4 * NODES)[1:-1]])
    x = np.concatenate([x, np.linspace(DENSE, FARTHEST, NODES)])
    with np.errstate(under="ignore", divide="ignore"):
        value = np.log(share(phase, expit(x), expit(-x)))
    if share is _beyond:
        value, x = value[::-1], x[::-1]
    rising = np.concatenate([[True], value[1:] > np.maximum.accumulate(value)[:-1]])
    return value[rising], x[rising]


def _root(phase: FournierForand, share: Share, target: np.ndarray) -> np.ndarray:
    """Return x = log(s/(1 - s)) in [-FARTHEST, FARTHEST] at which a share is the target."""
    sign = 1.0 if share is _within else -1.0

    def at(x: np.ndarray, which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        s, rest = expit(x), expit(-x)
        return sign * (share(phase, s, rest) - target[which]), 4 * np.pi * s * rest * density(phase, 2 * s, 2 * rest)

    start = np.interp(np.log(target), *_table(phase, share))
    return inverted(at, start, np.full_like(start, -FARTHEST), np.full_like(start, FARTHEST), unit=1.0)
