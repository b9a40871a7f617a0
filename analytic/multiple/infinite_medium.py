"""An isotropic point source of unit power in an infinite medium. For isotropic scattering

    4 pi r phi(r) = N e^(-kappa r) + int_0^inf e^(-(1 + u) r) / ((1 - c nu atanh nu)^2 + (pi c nu/2)^2) du,   nu = 1/(1 + u),

with kappa the root of c atanh(kappa) = kappa. Lengths are in mean free paths, phi is the fluence, 4 pi times the mean
radiance. With kappa = tanh y, everything is written so that neither c -> 0 nor c -> 1 loses digits; u = e^s makes the
integral one over the whole line, of an analytic function.
Source: Case, de Hoffmann & Placzek 1953, Introduction to the Theory of Neutron Diffusion 1, section 14.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import TINY
from fogproof.analytic.declaration import MEAN_FREE_PATHS, quantity
from fogproof.analytic.multiple.infinite_medium_phase import METHOD as PHASE_METHOD
from fogproof.analytic.multiple.infinite_medium_phase import SOURCE as PHASE_SOURCE
from fogproof.analytic.multiple.infinite_medium_phase import around_point_source
from fogproof.analytic.multiple.scattering_arguments import checked_albedo, checked_length, checked_phase
from fogproof.analytic.multiple.slab_by_doubling import is_isotropic
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase import PhaseFunctionField

METHOD = "residue and trapezoidal rule on the whole line"
SOURCE = "Case, de Hoffmann & Placzek 1953, section 14"

STEP = 0.125
REACH = 45.0
"""How far the integral goes beyond where it matters, in s on either side: exp(-45) = 3e-20."""

FAINT = 1 / 350
"""Albedo below which the residue, about 8 y^2 e^(-2 y) with y = 1/c, is nothing."""

BLOCK = 64

RELATIVE_ERROR = 1e-13
"""Of the fluence; compared with 27 digits in the tests."""


@quantity(
    unit="1",
    convention="4 pi times the mean radiance around a source of unit power, per square mean free path; "
    + MEAN_FREE_PATHS,
    source="Case, de Hoffmann & Placzek 1953, Introduction to the Theory of Neutron Diffusion 1, section 14",
    example={"albedo": [0.5, 0.9, 0.99], "distance": 1},
)
def point_source_fluence(
    albedo: FloatArray, distance: FloatArray, phase: PhaseFunctionField | None = None
) -> Reference:
    """Return the fluence around an isotropic point source of unit power, per square mean free path.

    albedo    (...) in [0, 1]
    distance  (...) from the source in mean free paths, >= 0; broadcast against the albedo
    phase     phase function, isotropic unless given

    In physical units phi = sigma_t^2 power times this, at sigma_t r. At the source it is inf.
    Relative error: below 1e-13 (1 + distance/100), rounding of the exponent included, and what errors of the Legendre moments
    are worth; where they fall too slowly for 1024 to be all of them, three times the largest difference to 768 and fewer besides.
    Source: Case, de Hoffmann & Placzek 1953, section 14; for other phase functions McCormick & Kuscer 1966.
    """
    c, r = np.broadcast_arrays(checked_albedo(albedo), checked_length("distance", distance))
    phase = checked_phase(phase)
    if not is_isotropic(phase):
        with np.errstate(under="ignore", over="ignore", divide="ignore", invalid="ignore"):
            value, error = around_point_source(c.ravel(), r.ravel(), phase, lambda alpha, r: np.exp(-alpha * r))
            value, error = (x.reshape(r.shape) / (4 * np.pi * r) for x in (value, error))
        return Reference(np.where(r > 0, value, np.inf), np.where(r > 0, error + TINY, 0.0), PHASE_METHOD, PHASE_SOURCE)
    with np.errstate(all="ignore"):
        y, residue = _pole(c)
        discrete = residue * np.exp(-np.tanh(y) * r)
        continuous = _over_the_cut(c, r, lambda alpha, r: np.exp(-alpha * r))
        value = (discrete + continuous) / (4 * np.pi * r)
        error = np.where(r > 0, RELATIVE_ERROR * (1 + r / 100) * value + TINY, 0.0)
    return Reference(np.where(r > 0, value, np.inf), error, METHOD, SOURCE)


@quantity(
    unit="1",
    convention="mean number within a ball around the source, per photon; " + MEAN_FREE_PATHS,
    source="Case, de Hoffmann & Placzek 1953, Introduction to the Theory of Neutron Diffusion 1, section 14",
    example={"albedo": [0.5, 0.9, 0.99], "radius": 1},
)
def point_source_collisions(
    albedo: FloatArray, radius: FloatArray, phase: PhaseFunctionField | None = None
) -> Reference:
    """Return the mean number of collisions within a ball around the source, per photon: the integral of the fluence.

    albedo  (...) in [0, 1]
    radius  (...) of the ball in mean free paths, >= 0; broadcast against the albedo
    phase   phase function, isotropic unless given

    It tends to 1/(1 - albedo), and to 1 - exp(-radius) without scattering. Relative error: below 1e-13 for isotropic scattering,
    else as in `point_source_fluence`.
    """
    c, R = np.broadcast_arrays(checked_albedo(albedo), checked_length("radius", radius))
    phase = checked_phase(phase)
    if not is_isotropic(phase):
        with np.errstate(all="ignore"):
            value, error = around_point_source(c.ravel(), R.ravel(), phase, _within)
        value = np.where(R < 1e-100, R, value.reshape(R.shape))
        return Reference(value, error.reshape(R.shape), PHASE_METHOD, PHASE_SOURCE)
    with np.errstate(all="ignore"):
        y, residue = _pole(c)
        value = residue * _within(np.tanh(y), R) + _over_the_cut(c, R, _within)
        value = np.where(R < 1e-100, R, value)
    return Reference(value, RELATIVE_ERROR * value + TINY, METHOD, SOURCE)


def _within(alpha: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Return int_0^R r e^(-alpha r) dr = (1 - (1 + x) e^-x)/alpha^2 with x = alpha R."""
    x = alpha * R
    small = x < 0.5
    t = np.where(small, x, 0.0)
    series = np.zeros_like(t)
    for n in range(17, -1, -1):  # sum (-t)^n / (n! (n + 2)), from the last term on
        series = 1 / (n + 2) - t / (n + 1) * series
    far = np.where(small, 1.0, x)
    return np.where(small, R * R * series, -(np.expm1(-far) + far * np.exp(-far)) / np.where(small, 1.0, alpha * alpha))


def _pole(c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return y with tanh(y)/y = c, and the residue 4 y^3/(sinh(2 y) (y^2 - z - z^2)), where z = y coth(y) - 1 = (1 - c)/c."""
    some = np.maximum(c, FAINT)
    z = (1 - some) / some
    y = np.sqrt(3 * z + z * z)
    for _ in range(12):
        found = _y_coth_y_minus_1(y)
        slope = (y * y - found - found * found) / y
        y = np.where(z > 0, y - (found - z) / slope, 0.0)
    z = _y_coth_y_minus_1(y)
    residue = 4 * y**3 / (np.sinh(2 * y) * (y * y - z - z * z))
    return y, np.where(c < FAINT, 0.0, np.where(y < 1e-6, 3.0, residue))


def _y_coth_y_minus_1(y: np.ndarray) -> np.ndarray:
    """Return y coth(y) - 1, by a continued fraction where it would cancel."""
    square = np.where(y < 2, y * y, 1.0)
    denominator = np.full_like(square, 27.0)
    for odd in range(25, 1, -2):
        denominator = odd + square / denominator
    return np.where(y < 2, square / denominator, y / np.tanh(y) - 1)


def _over_the_cut(c: np.ndarray, r: np.ndarray, kernel: Any) -> np.ndarray:
    """Return the integral over u of kernel(1 + u, r)/(…), with u = e^s as a sum over s."""
    c, r = np.broadcast_arrays(c, r)
    flat_c, flat_r, value = c.ravel(), np.maximum(r.ravel(), 1e-130), np.empty(c.size)
    for i in range(0, c.size, BLOCK):
        cc, rr = flat_c[i : i + BLOCK, None], flat_r[i : i + BLOCK, None]
        # What counts lies between u = 1 and u = 1/r.
        low, high = np.minimum(0.0, -np.log(rr)) - REACH, np.maximum(0.0, -np.log(rr)) + REACH
        count = int(np.max(high - low) / STEP) + 1
        u = np.exp(low + STEP * np.arange(count))
        nu = 1 / (1 + u)
        density = u / ((1 - cc * nu * 0.5 * np.log1p(2 / u)) ** 2 + (np.pi * cc * nu / 2) ** 2)
        value[i : i + BLOCK] = STEP * np.sum(density * kernel(1 + u, rr), axis=1)
    return value.reshape(c.shape)
