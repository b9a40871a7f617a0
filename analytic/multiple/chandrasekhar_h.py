"""Chandrasekhar's H function for isotropic scattering, the heart of the half space.

Of the known integral over theta in (0, pi/2), tan(theta) = e^s makes a convolution on the whole line,

    ln H(mu) = -1/(2 pi) int ln(1 - c theta cot(theta)) sech(s + ln mu) ds,

whose integrand is analytic for |Im s| < pi/2 whatever c and mu are: the trapezoidal rule with step h is off by about
exp(-pi^2 / h), which is 4e-22 here.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.scattering_arguments import checked_albedo, checked_cosine
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray

METHOD = "trapezoidal rule on the whole line"
SOURCE = "Chandrasekhar 1960, Radiative Transfer, section 39"

STEP = 0.2
NODES = STEP * np.arange(-210, 211)
WEIGHTS = STEP / (2 * np.pi) / np.cosh(NODES)
BLOCK = 128
"""Values evaluated at a time, each with 421 nodes."""

RELATIVE_ERROR = 16 * EPS
"""Of H: the weights sum to 1/2 and |ln| <= 80 where they count, but ln H <= 1.1; the rest is rounding of ln and exp."""


@quantity(
    unit="1",
    convention="of a half space that scatters isotropically; mu is the cosine to the normal",
    source="Chandrasekhar 1960, Radiative Transfer, section 39",
    example={"albedo": [0.5, 0.9, 1], "mu": 1},
)
def chandrasekhar_h(albedo: FloatArray, mu: FloatArray) -> Reference:
    """Return H(mu) of a half space that scatters isotropically, >= 1.

    albedo  (...) in [0, 1]
    mu      (...) cosine to the normal, in (0, 1]; broadcast against the albedo

    Relative error: below 16 eps.
    Source: Chandrasekhar 1960, Radiative Transfer, section 39.
    """
    c, mu = np.broadcast_arrays(checked_albedo(albedo), checked_cosine("mu", mu))
    value = np.exp(log_h(c, 1 - c, mu))
    return Reference(value, RELATIVE_ERROR * value, METHOD, SOURCE)


def log_h(c: np.ndarray, absorbed: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return ln H(mu); c may be complex with |c| <= 1, and `absorbed` is 1 - c."""
    c, absorbed, mu = np.broadcast_arrays(c, absorbed, mu)
    flat = [x.ravel() for x in (c, absorbed, mu)]
    value = np.empty(flat[0].shape, flat[0].dtype)
    for start in range(0, len(value), BLOCK):
        block = slice(start, start + BLOCK)
        value[block] = _log_h(*(x[block, None] for x in flat))
    return value.reshape(c.shape)


def _log_h(c: np.ndarray, absorbed: np.ndarray, mu: np.ndarray) -> np.ndarray:
    with np.errstate(under="ignore"):
        return -np.sum(WEIGHTS * log_dispersion(c, absorbed, NODES - np.log(mu)), axis=-1)


def log_dispersion(c: np.ndarray, absorbed: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return ln(1 - c theta cot(theta)) with tan(theta) = e^s, accurate where it is near 0 and where 1 - c is."""
    with np.errstate(over="ignore", under="ignore"):
        theta = angle(s)
        near = np.log(absorbed + c * one_minus_theta_cot(np.minimum(theta, 1.0)))
        far = np.log1p(-c * np.where(s > 0, theta * np.exp(-np.maximum(s, 0.0)), 0.0))
    return np.where(s > 0, far, near)


def angle(s: np.ndarray) -> np.ndarray:
    """Return theta = arctan(e^s)."""
    with np.errstate(over="ignore", under="ignore"):
        return np.where(s < 0, np.arctan(np.exp(s)), np.pi / 2 - np.arctan(np.exp(-s)))


def one_minus_theta_cot(theta: np.ndarray) -> np.ndarray:
    """Return 1 - theta cot(theta) for 0 <= theta <= pi/2, by Lambert's continued fraction: no digit is lost near 0."""
    square = theta * theta
    denominator = np.full_like(square, 29.0)
    for odd in range(27, 1, -2):
        denominator = odd - square / denominator
    return square / denominator
