"""The half space that scatters isotropically and absorbs: how much it reflects.

The plane albedo of a beam is also the radiance seen at that angle under a uniform sky of radiance 1 (reciprocity).
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.chandrasekhar_h import METHOD, RELATIVE_ERROR, angle, log_h, one_minus_theta_cot
from fogproof.analytic.multiple.orders import taylor_coefficients
from fogproof.analytic.multiple.scattering_arguments import checked_albedo, checked_cosine, checked_count
from fogproof.contracts import Reference
from fogproof.scene.arrays import Count, FloatArray

SOURCE = "Chandrasekhar 1960, Radiative Transfer, sections 33 and 39"

_STEP = 0.2
_S = _STEP * np.arange(-450, 251)


@quantity(
    unit="1",
    convention="plane albedo: share of a beam of cosine mu0 to the normal, all orders, isotropic scattering",
    source="Chandrasekhar 1960, Radiative Transfer, section 33, eq. 81",
    example={"albedo": [0.5, 0.9, 1], "mu0": 0.5},
)
def half_space_reflectance(albedo: FloatArray, mu0: FloatArray) -> Reference:
    """Return the plane albedo 1 - sqrt(1 - c) H(mu0): what is reflected of a beam of cosine mu0 to the normal.

    albedo  (...) c in [0, 1]
    mu0     (...) in (0, 1]; broadcast against the albedo

    It is also the radiance in direction mu0 under a uniform sky of radiance 1. Error: below 16 eps.
    Source: Chandrasekhar 1960, Radiative Transfer, section 33, eq. 81.
    """
    c, mu0 = np.broadcast_arrays(checked_albedo(albedo), checked_cosine("mu0", mu0))
    value = _plane_albedo(c, 1 - c, mu0)
    return Reference(value, np.full(value.shape, RELATIVE_ERROR), METHOD, SOURCE)


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
    )


def _plane_albedo(c: np.ndarray, absorbed: np.ndarray, mu0: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return -np.expm1(0.5 * np.log(absorbed) + log_h(c, absorbed, mu0))


@quantity(
    unit="1",
    convention="share of diffuse light, the same from all directions; isotropic scattering",
    source="Chandrasekhar 1960, Radiative Transfer, sections 38 and 39",
    example={"albedo": [0.5, 0.9, 0.99, 1]},
)
def half_space_spherical_albedo(albedo: FloatArray) -> Reference:
    """Return the spherical albedo: what is reflected of diffuse light, the same from all directions.

    albedo  (...) c in [0, 1]

    It is 1 - 2 sqrt(1 - c) alpha_1 with alpha_1 = int_0^1 mu H dmu, whose value follows from how H tends to its limit at
    mu = inf: alpha_1 = 2 sqrt(1 - c)/(pi c) int ln(1 + c (1 - theta cot theta)/(1 - c)) e^-s ds, tan(theta) = e^s.
    Error: below 32 eps.
    Source: Chandrasekhar 1960, Radiative Transfer, sections 38 and 39.
    """
    c = checked_albedo(albedo)
    flat, absorbed = np.maximum(c.ravel(), 1e-100)[:, None], 1 - c.ravel()[:, None]
    with np.errstate(all="ignore"):
        integrand = np.log1p(flat / absorbed * one_minus_theta_cot(angle(_S))) * np.exp(-_S)
        integral = _STEP * np.sum(integrand, axis=-1)
        value = 1 - 4 * absorbed[:, 0] / (np.pi * flat[:, 0]) * integral
    value = np.where(absorbed[:, 0] == 0, 1.0, value).reshape(c.shape)
    return Reference(value, np.full(c.shape, 32 * EPS), METHOD, SOURCE)


@quantity(
    unit="1/sr",
    convention="radiance per irradiance of the surface, isotropic scattering; cosines to the normal; it does not depend on azimuth",
    source="Chandrasekhar 1960, Radiative Transfer, section 33, eq. 1 and section 13, eq. 14",
    example={"albedo": 0.9, "mu0": 0.5, "mu": [0.2, 0.5, 1]},
)
def half_space_brdf(albedo: FloatArray, mu0: FloatArray, mu: FloatArray) -> Reference:
    """Return the reflectance distribution c H(mu0) H(mu) / (4 pi (mu0 + mu)) [1/sr]: radiance per irradiance.

    albedo   (...) c in [0, 1]
    mu0, mu  (...) cosines of the beam and of the view to the normal, in (0, 1]; all three broadcast

    The irradiance is that on the surface: mu0 times that of the beam. Relative error: below 48 eps.
    Source: Chandrasekhar 1960, Radiative Transfer, section 33, eq. 1 and section 13, eq. 14.
    """
    c, mu0, mu = np.broadcast_arrays(checked_albedo(albedo), checked_cosine("mu0", mu0), checked_cosine("mu", mu))
    with np.errstate(under="ignore"):
        value = c * np.exp(log_h(c, 1 - c, mu0) + log_h(c, 1 - c, mu)) / (4 * np.pi * (mu0 + mu))
        return Reference(value, 3 * RELATIVE_ERROR * value + TINY, METHOD, SOURCE)
