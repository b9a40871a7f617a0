"""The airlight integral for phase functions that are polynomials in mu, after Pegoraro, Schott & Parker 2010.

With v = (t + r)/h and x = 1/(1 + v^2) = (1 + mu)/2 the integral is 2/h e^(sigma a) int e^(-H v) F x dv, so a phase
function F = 4 pi f_p that is a polynomial in mu makes the integrand e^(-H v) times a polynomial in x. Partial fractions
turn it into Re sum_j B_j / (v - i)^j, and each term has a closed form, by parts down to the exponential integral:

    L_j(v) = int e^(-H v) / (v - i)^j dv = -(e^(-H v) / (v - i)^(j-1) + H L_(j-1)(v)) / (j - 1),
    L_1(v) = -e^(-i H) E_1(H (v - i))

The lecture's printed recurrence is the same sum written in real terms v^k / (v^2 + 1)^n. Isotropic, Rayleigh and hazy
scattering are such polynomials, murky is one of degree 32; of the Legendre series of a Henyey-Greenstein function,
sum (2n+1) g^n P_n(mu), at most `TERMS` terms are taken, and the remainder is part of the error.

Error: a running bound of the rounding of the recurrence, whose terms grow like H^j/j! and cancel, and the remainder.
Source: Pegoraro, Schott & Parker 2010, A closed-form solution to single scattering for general phase functions and light
distributions, eqs. 8-16.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import comb
from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.pegoraro2009 import exponential_integral, v_of
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.errors import UnsupportedError
from fogproof.scene.phase import (
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Murky,
    PhaseFunction,
    Rayleigh,
)

METHOD = "Pegoraro et al. 2010, partial fractions and exponential integral"
SOURCE = "Pegoraro, Schott & Parker 2010, eqs. 8-16"

TERMS = 40
"""Terms at most of the series of a phase function that is no polynomial; fewer leave out less than REMAINDER."""

REMAINDER = 1e-13


class Series(NamedTuple):
    """Numbers B_j with F x = Re sum_j B_j / (v - i)^j (j from 1), up to a remainder below `rest` x."""

    terms: np.ndarray
    rest: float


def integrate(
    sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, phase: PhaseFunction
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over each segment, and a bound of its error."""
    series = _series(phase)
    H = sigma * h
    upper, upper_error = _antiderivative(H, v_of(b, h), series.terms)
    lower, lower_error = _antiderivative(H, v_of(a, h), series.terms)
    scale = 2 / h * np.exp(sigma * a)
    value = scale * (upper - lower)
    error = scale * (upper_error + lower_error) + (4 + sigma * np.abs(a)) * EPS * np.abs(value) + 4 * TINY
    if series.rest:
        # The remainder times the isotropic integral, which is at most the angle the segment subtends at the light.
        angle = np.where(b < np.inf, np.arctan2(b, h), np.pi / 2) - np.arctan2(a, h)
        error = error + series.rest * np.exp(-sigma * np.hypot(a, h)) * angle / h
    return value, np.where(np.isfinite(value) & np.isfinite(error), error, np.inf)


def _antiderivative(H: np.ndarray, v: np.ndarray, terms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return Re sum_j B_j L_j(v) and a running bound of its rounding error; 0 at v = inf."""
    there = v < np.inf
    d = np.where(there, v, 1.0) - 1j
    z = np.where(H > 0, H, 1.0) * d
    E, E_error = exponential_integral(z)
    turn = np.exp(-1j * H)
    L = np.where(H > 0, -turn * E, np.log(d))
    L_error = np.where(H > 0, E_error + EPS * (2 + 2 * H + np.abs(z)) * (np.abs(E) + np.exp(-z.real)), 4 * EPS)
    fall = np.exp(-H * d.real)
    total, error = (terms[0] * L).real, np.abs(terms[0]) * L_error
    power = np.ones_like(d)
    for j, B in enumerate(terms[1:], start=2):
        power = power / d
        own = fall * power
        L_error = (H * L_error + EPS * ((4 + 2 * j + 2 * H * d.real) * np.abs(own) + 3 * H * np.abs(L))) / (j - 1)
        L = -(own + H * L) / (j - 1)
        total = total + (B * L).real
        error = error + np.abs(B) * (L_error + 4 * EPS * np.abs(L))
    return np.where(there, total, 0.0), np.where(there, error + EPS * np.abs(total), 0.0)


@lru_cache(maxsize=64)
def _series(phase: PhaseFunction) -> Series:
    """Return the partial fractions of F x, from exact rational coefficients."""
    powers, rest = _powers(phase)
    m = len(powers)  # F x = sum_k powers[k] x^(k+1)
    real, imaginary = [Fraction(0)] * m, [Fraction(0)] * m
    for order, coefficient in enumerate(powers, start=1):
        for j in range(1, order + 1):
            # 1/(v^2+1)^m = 2 Re sum_j (-1)^(m-j) C(2m-j-1, m-j) (2i)^(j-2m) / (v - i)^j
            k = 2 * order - j
            size = 2 * coefficient * (-1) ** (order - j) * Fraction(comb(k - 1, order - j), 2**k)
            quarter = k % 4  # i^-k
            if quarter % 2 == 0:
                real[j - 1] += size if quarter == 0 else -size
            else:
                imaginary[j - 1] += -size if quarter == 1 else size
    return Series(np.array([complex(float(x), float(y)) for x, y in zip(real, imaginary, strict=True)]), rest)


def _powers(phase: PhaseFunction) -> tuple[list[Fraction], float]:
    """Return the coefficients of F in powers of x = (1 + mu)/2, and a bound of what is left out."""
    match phase:
        case Isotropic():
            return [Fraction(1)], 0.0
        case Rayleigh():  # 3/4 (1 + (2 x - 1)^2)
            return [Fraction(3, 2), Fraction(-3), Fraction(3)], 0.0
        case Hazy():
            return [Fraction(1, 2)] + 7 * [Fraction(0)] + [Fraction(9, 2)], 0.0
        case Murky():
            return [Fraction(1, 2)] + 31 * [Fraction(0)] + [Fraction(33, 2)], 0.0
        case HenyeyGreenstein(g):
            return _legendre_series(g)
    raise UnsupportedError(
        f"the series of Pegoraro et al. 2010 is not made for {phase!r}; it serves Isotropic, Rayleigh, Hazy, Murky and "
        "HenyeyGreenstein",
        "phase",
    )


def _legendre_series(g: float) -> tuple[list[Fraction], float]:
    """Return sum (2n+1) g^n P_n(2 x - 1) in powers of x, and a bound of the terms left out (|P_n| <= 1)."""
    size, n = abs(g), 0
    while (rest := _remainder(size, n)) > REMAINDER and n < TERMS:
        n += 1
    powers = [Fraction(0)] * max(n, 1)
    for order in range(n):
        scale = (2 * order + 1) * Fraction(g) ** order
        for k in range(order + 1):
            powers[k] += scale * (-1) ** (order + k) * comb(order, k) * comb(order + k, k)
    return powers, rest


def _remainder(g: float, n: int) -> float:
    """Return sum over m >= n of (2m+1) g^m."""
    return float(g**n * ((2 * n + 1) / (1 - g) + 2 * g / (1 - g) ** 2))
