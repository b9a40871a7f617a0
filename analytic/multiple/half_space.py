"""The half space: how much it reflects. Isotropic scattering has Chandrasekhar's H function, other phase functions are doubled.

The plane albedo of a beam is also the radiance seen at that angle under a uniform sky of radiance 1 (reciprocity).
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.chandrasekhar_h import (
    BLOCK,
    METHOD,
    NODES,
    RELATIVE_ERROR,
    WEIGHTS,
    angle,
    log_h,
    one_minus_theta_cot,
)
from fogproof.analytic.multiple.orders import taylor_coefficients
from fogproof.analytic.multiple.scattering_arguments import (
    DEEPEST,
    checked_albedo,
    checked_azimuth,
    checked_cosine,
    checked_count,
    checked_phase,
)
from fogproof.analytic.multiple.slab_by_doubling import doubled_values, is_isotropic
from fogproof.analytic.multiple.slab_directions import Beams, directional_in_parts
from fogproof.contracts import Reference
from fogproof.scene.arrays import Count, FloatArray
from fogproof.scene.phase import PhaseFunction, PhaseFunctionField

SOURCE = "Chandrasekhar 1960, Radiative Transfer, sections 33 and 39"

DEEP_METHOD = "discrete ordinates"
DEEP_SOURCE = "van de Hulst 1980, Multiple Light Scattering, section 4.4; de Haan, Bosma & Hovenier 1987"
"""Of phase functions that are not isotropic."""

FAINT = 1e-100
"""Albedo below which everything is proportional to it."""

_STEP = 0.2
_S = _STEP * np.arange(-450, 251)


@quantity(
    unit="1",
    convention="plane albedo: share of a beam of cosine mu0 to the normal, all orders of scattering",
    source="Chandrasekhar 1960, Radiative Transfer, section 33, eq. 81",
    example={"albedo": [0.5, 0.9, 1], "mu0": 0.5},
)
def half_space_reflectance(albedo: FloatArray, mu0: FloatArray, phase: PhaseFunctionField | None = None) -> Reference:
    """Return the plane albedo: what is reflected of a beam of cosine mu0 to the normal.

    albedo  (...) c in [0, 1]
    mu0     (...) in (0, 1]; broadcast against the albedo
    phase   phase function, isotropic unless given

    It is also the radiance in direction mu0 under a uniform sky of radiance 1. For isotropic scattering it is
    1 - sqrt(1 - c) H(mu0), with a relative error below 16 eps; other phase functions are those of a slab so deep that nothing
    passes, with the error of `slab_reflectance`.
    Source: Chandrasekhar 1960, Radiative Transfer, section 33, eq. 81; van de Hulst 1980, Multiple Light Scattering.
    """
    phase = checked_phase(phase)
    c, mu0 = np.broadcast_arrays(checked_albedo(albedo), checked_cosine("mu0", mu0))
    if not is_isotropic(phase):
        return _doubled(c, mu0, phase)
    value = _plane_albedo(c, 1 - c, mu0)
    with np.errstate(under="ignore"):
        return Reference(value, RELATIVE_ERROR * value + TINY, METHOD, SOURCE)


@quantity(
    unit="1",
    convention="after n = 0 … count scatterings at albedo 1, in the last axis",
    source="Chandrasekhar 1960, Radiative Transfer, section 33, eq. 81",
    example={"mu0": [0.2, 0.5, 1], "count": 3},
)
def half_space_reflectance_orders(mu0: FloatArray, count: Count) -> Reference:
    """Return the share R_n of a beam that is reflected after n scatterings at albedo 1, n = 0 … count: (..., count + 1).

    mu0    (...) cosine of the beam to the normal, in (0, 1]
    count  the highest order, a whole number >= 0

    At albedo c the n-th order is c^n R_n, and their sum over all n is the plane albedo.
    """
    mu0 = checked_cosine("mu0", mu0)
    return taylor_coefficients(
        lambda c: _plane_albedo(c, 1 - c, mu0[..., None]),
        checked_count("count", count),
        known=lambda c: half_space_reflectance(c, mu0),
        source=SOURCE,
        first=np.zeros_like(mu0),  # what has not scattered does not come back
    )


def _plane_albedo(c: np.ndarray, absorbed: np.ndarray, mu0: np.ndarray) -> np.ndarray:
    """Return 1 - sqrt(1 - c) H(mu0); its logarithm is a weighted mean of ln((1 - c)/(1 - c theta cot theta)), all negative."""
    c, absorbed, mu0 = np.broadcast_arrays(c, absorbed, mu0)
    flat = [x.ravel()[:, None] for x in (c, absorbed, mu0)]
    value = np.empty(c.size, c.dtype)
    with np.errstate(all="ignore"):
        for start in range(0, c.size, BLOCK):
            cc, aa, mu = (x[start : start + BLOCK] for x in flat)
            mean = np.sum(WEIGHTS * np.log1p(cc / aa * one_minus_theta_cot(angle(NODES - np.log(mu)))), axis=1)
            value[start : start + BLOCK] = -np.expm1(-mean)
    return np.where(absorbed == 0, 1.0, value.reshape(c.shape))


@quantity(
    unit="1",
    convention="share of diffuse light, the same from all directions",
    source="Chandrasekhar 1960, Radiative Transfer, sections 38 and 39",
    example={"albedo": [0.5, 0.9, 0.99, 1]},
)
def half_space_spherical_albedo(albedo: FloatArray, phase: PhaseFunctionField | None = None) -> Reference:
    """Return the spherical albedo: what is reflected of diffuse light, the same from all directions.

    albedo  (...) c in [0, 1]
    phase   phase function, isotropic unless given; others have the error of `slab_diffuse_reflectance`

    For isotropic scattering it is 1 - 2 sqrt(1 - c) alpha_1 with alpha_1 = int_0^1 mu H dmu, whose value follows from how H
    tends to its limit at mu = inf. With tan(theta) = e^s, z = 1 - theta cot(theta) and x = c z/(1 - c) that is
    4/pi int (z - (1 - c)/c ln(1 + x)) e^-s ds, where nothing cancels but x - ln(1 + x). Relative error: below 32 eps.
    Source: Chandrasekhar 1960, Radiative Transfer, sections 38 and 39.
    """
    c, phase = checked_albedo(albedo), checked_phase(phase)
    if not is_isotropic(phase):
        return _doubled(c, None, phase)
    (value,) = in_blocks(lambda *some: (_bimoment(*some),), _ROWS, np.maximum(c, FAINT), 1 - c)
    value = np.where(c == 1, 1.0, value) * (c / np.maximum(c, FAINT))
    return Reference(value, 32 * EPS * value + TINY, METHOD, SOURCE)


_ROWS = 1024
"""Albedos whose integrands are in memory at the same time."""


def _bimoment(flat: np.ndarray, absorbed: np.ndarray) -> np.ndarray:
    """Return the spherical albedo over the albedo itself, (v,) each; 1 is put where nothing is absorbed."""
    flat, absorbed = flat[:, None], absorbed[:, None]
    with np.errstate(all="ignore"):
        z = one_minus_theta_cot(angle(_S))
        x = flat / absorbed * z
        far = z - absorbed / flat * np.log1p(x)
        small = np.where(x < 0.25, x, 0.0)
        series = np.zeros_like(x)
        for n in range(27, -1, -1):  # (x - ln(1 + x))/x^2 = 1/2 - x/3 + …
            series = 1 / (n + 2) - small * series
        value = 4 / np.pi * _STEP * np.sum(np.where(x < 0.25, z * x * series, far) * np.exp(-_S), axis=-1)
    return np.asarray(value)


@quantity(
    unit="1/sr",
    convention="radiance per irradiance of the surface; cosines to the normal; azimuth between the ways on, 0 straight ahead",
    source="Chandrasekhar 1960, Radiative Transfer, section 33, eq. 1 and section 13, eq. 14",
    example={"albedo": 0.9, "mu0": 0.5, "mu": [0.2, 0.5, 1]},
)
def half_space_brdf(
    albedo: FloatArray,
    mu0: FloatArray,
    mu: FloatArray,
    phase: PhaseFunctionField | None = None,
    azimuth: FloatArray | None = None,
) -> Reference:
    """Return the reflectance distribution [1/sr] of a half space: radiance at any angle per irradiance.

    albedo   (...) c in [0, 1]
    mu0, mu  (...) cosines of the beam and of the view to the normal, in (0, 1]
    phase    phase function, isotropic unless given
    azimuth  (...) between the horizontal directions of travel before and after [rad]; 0 goes on ahead. It may be left out for
             isotropic scattering only; all four broadcast

    The irradiance is that on the surface: mu0 times that of the beam. For isotropic scattering it is
    c H(mu0) H(mu)/(4 pi (mu0 + mu)), with a relative error below 48 eps; other phase functions are those of a slab so deep
    that nothing passes, with the error of `slab_brdf`.
    Source: Chandrasekhar 1960, Radiative Transfer, section 33, eq. 1 and section 13, eq. 14; de Haan, Bosma & Hovenier 1987.
    """
    phase = checked_phase(phase)
    angle = checked_azimuth(azimuth, is_isotropic(phase))
    arrays = checked_albedo(albedo), checked_cosine("mu0", mu0), checked_cosine("mu", mu), angle
    c, mu0, mu, angle = np.broadcast_arrays(*arrays)
    if not is_isotropic(phase):
        value, error = np.zeros(c.size), np.zeros(c.size)
        flat = c.ravel()
        for one in np.unique(flat[flat > 0]).tolist():
            here = flat == one
            beams = Beams(mu0.ravel()[here], mu.ravel()[here], angle.ravel()[here])
            with np.errstate(under="ignore", over="ignore", divide="ignore"):
                value[here], error[here] = directional_in_parts(one, DEEPEST, beams, phase, "reflected")
        return Reference(value.reshape(c.shape), error.reshape(c.shape), DEEP_METHOD, DEEP_SOURCE)
    with np.errstate(under="ignore"):
        value = c * np.exp(log_h(c, 1 - c, mu0) + log_h(c, 1 - c, mu)) / (4 * np.pi * (mu0 + mu))
        return Reference(value, 3 * RELATIVE_ERROR * value + TINY, METHOD, SOURCE)


def _doubled(c: np.ndarray, mu0: np.ndarray | None, phase: PhaseFunction) -> Reference:
    """Return what the deepest slab reflects of a beam, or of diffuse light if mu0 is None."""
    flat = None if mu0 is None else mu0.ravel()
    value, error = doubled_values(c.ravel(), np.full(c.size, DEEPEST), flat, phase, "reflected")
    all_of_it = c.ravel() == 1
    value, error = np.where(all_of_it, 1.0, value), np.where(all_of_it, 0.0, np.minimum(error, 1.0))
    return Reference(value.reshape(c.shape), error.reshape(c.shape), DEEP_METHOD, DEEP_SOURCE)
