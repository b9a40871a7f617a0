"""Fournier & Forand 1994 in the form of Fournier & Jonasz 1999, rewritten so that nothing cancels.

With x = (1 - mu)/2, y = 1 - x, k = 4/(3 (n-1)^2), a = (slope - 3)/2 in (0, 1) and the decreasing function

    E(d) = (d^a - 1)/(d - 1) = int_0^1 a (1 + t (d - 1))^(a-1) dt,

their distribution of angles is the probability F(mu) = y E(k x) - E(k) mu x y/2 of a cosine up to mu, and its derivative
4 pi f = E(k x) - k y E'(k x) + E(k) (3 mu^2 - 1)/4, which is at least 3/4 E(k) and at x -> 0 grows as a k^a x^(a-1).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.arithmetic.gauss_legendre import RULES
from fogproof.analytic.proven.balls import flint, rational
from fogproof.scene.phase import FournierForand

SOURCE = "Fournier & Jonasz 1999, Proc. SPIE 3761, 62"
METHOD = "closed form"

NEAR = 0.5
"""|log d| up to which E is integrated: the singularity at t = 1/(1 - d) is then beyond the ellipse of 8."""

T, W = RULES[12]


def _parameters(phase: FournierForand) -> tuple[float, float]:
    """Return k, relative error 3 eps, and a, exact to eps/a."""
    k = 4 / (3 * (phase.refractive_index - 1) ** 2)
    return k, (phase.junge_slope - 3) / 2


def _bracket(a: float, d: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return E, -d E'(d) and their errors for d > 0 of relative error 4 eps."""
    L = np.log(d)
    near = np.abs(L) <= NEAR
    far = np.where(near, np.e**2, d)
    l = np.where(near, 2.0, L)  # noqa: E741
    with np.errstate(over="ignore"):
        power, less = np.power(far, a), far - 1
        value = np.expm1(a * l) / less
        plus, minus = far / less * value, a * power / less
    relative = (16 + 4 * a * np.abs(l)) * EPS
    slope, slope_error = plus - minus, relative * (np.abs(plus) + np.abs(minus))
    error = relative * value
    if near.any():
        u = d[near, None] - 1
        bracket = a * np.power(1 + T * u, a - 1)
        value[near] = bracket @ W
        slope[near] = (d[near, None] * (1 - a) * bracket * T / (1 + T * u)) @ W
        error[near], slope_error[near] = 32 * EPS * value[near], 32 * EPS * slope[near]
    return value, slope, error, slope_error


def density(phase: FournierForand, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f where (1 - mu)/2 = x and (1 + mu)/2 = y; relative error some 1e-14, inf at x = 0."""
    k, a = _parameters(phase)
    there = x > 0
    at = np.where(there, x, 1.0)
    E, slope, error, slope_error = _bracket(a, k * at)
    last, _, last_error, _ = _bracket(a, np.array([k]))
    mu = y - x
    angle = (3 * mu * mu - 1) / 4
    with np.errstate(over="ignore"):
        ratio = y / at
        value = E + ratio * slope + last * angle
        size = error + ratio * slope_error + 8 * EPS * (E + ratio * np.abs(slope) + last) + last_error
    return np.where(there, value, np.inf) / (4 * np.pi), np.where(there, size, 0.0) / (4 * np.pi)


def pdf(phase: FournierForand, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error some 1e-14, inf at mu = 1."""
    return density(phase, (1 - mu) / 2, (1 + mu) / 2)


def cdf(phase: FournierForand, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu); absolute error some 1e-15."""
    k, a = _parameters(phase)
    x, y = (1 - mu) / 2, (1 + mu) / 2
    E, _, error, _ = _bracket(a, k * np.where(x > 0, x, 1.0))
    last, _, last_error, _ = _bracket(a, np.array([k]))
    wave = last * mu * x * y / 2
    value = np.where(x > 0, y * E - wave, 1.0)
    size = y * error + last_error / 16 + 8 * EPS * (y * E + np.abs(wave))
    return np.clip(value, 0, 1), np.where(x > 0, size, 0.0)


def airlight(phase: FournierForand) -> AirlightPhase:
    """Return 4 pi f, with x = w / (w + wt) and its error; analytic in asinh(t/h) as far as the rest."""
    k, a = _parameters(phase)
    last = float(_bracket(a, np.array([k]))[0][0])
    floor = 0.7499 * last

    def factor(w: Array, wt: Array) -> tuple[Array, Array]:
        value, error = density(phase, w / (w + wt), wt / (w + wt))
        return 4 * np.pi * value, 4 * np.pi * error

    def slope(_low: Array, high: Array) -> tuple[Array, Array]:
        """|d log F / d theta| is at most 4 cot(theta/2) + 1: |d log E / d log x| < 1, |d log E' / d log x| < 2."""
        with np.errstate(divide="ignore"):
            return 4 * np.sqrt((1 + high) / np.maximum(1 - high, 0.0)) + 1, np.zeros_like(high)

    folds = (1 - a) * 691 + a * math.log(k) - math.log(floor) + 1
    return AirlightPhase(factor, floor, math.inf, 4.0, slope, degree=2, noisy=True, folds=folds)


def ball(phase: FournierForand, mu: Any, analytic: bool) -> Any:
    """Return 4 pi f at a complex ball of cosines."""
    mu = flint().acb(mu)
    if mu == 1:
        return flint().acb(flint().arb.pos_inf())
    k, a = _exact(phase)
    E, slope = _ball_bracket(a, k * (1 - mu) / 2, analytic)
    last, _ = _ball_bracket(a, flint().acb(k), False)
    return E - k * (1 + mu) / 2 * slope + last * (3 * mu * mu - 1) / 4


def peak(phase: FournierForand, mu: Any) -> Any:
    """Return an upper bound of 4 pi f at cosines up to the ball mu: but for the last term f grows with mu."""
    k, a = _exact(phase)
    E, slope = (part.real for part in _ball_bracket(a, flint().acb(k * (1 - mu) / 2), False))
    last, _ = _ball_bracket(a, flint().acb(k), False)
    return E - k * (1 + mu) / 2 * slope + last.real / 2


def _exact(phase: FournierForand) -> tuple[Any, Any]:
    n, slope = rational(phase.refractive_index), rational(phase.junge_slope)
    return 4 / (3 * (n - 1) ** 2), (slope - 3) / 2


def _ball_bracket(a: Any, d: Any, analytic: bool) -> tuple[Any, Any]:
    """Return E(d) and E'(d) at a complex ball; around d = 1 by the binomial series, whose coefficients are
    below 1: what is left out is below (16/15)^2 terms times 16^-terms."""
    arb, acb = flint().arb, flint().acb
    u = d - 1
    if u.abs_upper() >= 0.0625:
        power = (d.log(analytic=analytic) * a).exp()
        E = (power - 1) / u
        return E, (a * power / d - E) / u
    terms = flint().ctx.prec // 4 + 8
    E, slope, binomial, before, here = acb(0), acb(0), arb(a), acb(0), acb(1)
    for m in range(terms):
        E += binomial * here
        slope += m * binomial * before
        before, here = here, here * u
        binomial = binomial * (a - m - 1) / (m + 2)
    rest = arb(0, arb(16) ** (2 - terms))
    return E + acb(rest, rest), slope + acb(rest, rest)
