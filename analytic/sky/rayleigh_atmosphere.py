"""A clear atmosphere of air molecules: scattering cross section, optical depth, and the sky by single scattering."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.phase.functions import phase_pdf
from fogproof.analytic.rays.compositing import phi1
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase import Rayleigh
from fogproof.validate import as_float_array, require

DENSITY = 101325 / (1.380649e-23 * 288.15)
"""Molecules of standard air (288.15 K, 101325 Pa) [1/m^3], where its refractive index was measured."""

COLUMN = 101325 / (28.9647e-3 / 6.02214076e23 * 9.80665)
"""Molecules above sea level: pressure over weight of a molecule [1/m^2]."""

VALID = (230e-9, 1690e-9)
"""Wavelengths at which the refractive index was measured [m]."""


@quantity(
    unit="m^2",
    convention="Rayleigh scattering by a molecule of dry air; wavelength in m",
    source="Bodhaine, Wood, Dutton & Slusser 1999, eq. 2; Ciddor 1996; Bates 1984",
    example={"wavelength": [4e-7, 5.5e-7, 7e-7]},
)
def air_cross_section(wavelength: FloatArray) -> Reference:
    """Return the Rayleigh scattering cross section of a molecule of dry air [m^2].

        sigma = 24 pi^3 (n^2 - 1)^2 / (lambda^4 N^2 (n^2 + 2)^2) F

    wavelength  (...) lambda in vacuum [m], 230 nm to 1690 nm

    n is the refractive index of standard air, N its number density, F the King factor of its anisotropic molecules.
    The error counts rounding; the formula itself is known to some 0.1 %.
    Source: Bodhaine, Wood, Dutton & Slusser 1999, On Rayleigh optical depth calculations, eq. 2; n from Ciddor 1996,
    Refractive index of air, eq. 1; F from Bates 1984, Rayleigh scattering by air.
    """
    lam = as_float_array("wavelength", wavelength)
    require("wavelength", lam, (lam >= VALID[0]) & (lam <= VALID[1]), "must lie in [230e-9, 1690e-9] [m]", "not in nm")
    square = (1e-6 / lam) ** 2  # of the wavenumber, in 1/um^2
    excess = 1e-8 * (5792105 / (238.0185 - square) + 167917 / (57.362 - square))  # n - 1
    nitrogen = 1.034 + 3.17e-4 * square
    oxygen = 1.096 + 1.385e-3 * square + 1.448e-4 * square**2
    king = (78.084 * nitrogen + 20.946 * oxygen + 0.934 + 0.036 * 1.15) / (78.084 + 20.946 + 0.934 + 0.036)
    polarisation = excess * (2 + excess) / ((1 + excess) ** 2 + 2)
    value = 24 * np.pi**3 * (polarisation / (lam**2 * DENSITY)) ** 2 * king
    return Reference(value, 40 * EPS * value, "closed form", "Bodhaine et al. 1999, eq. 2; Ciddor 1996; Bates 1984")


@quantity(
    unit="1",
    convention="the whole atmosphere above sea level, straight up; wavelength in m",
    source="Bodhaine, Wood, Dutton & Slusser 1999, eq. 2; Ciddor 1996; Bates 1984",
    example={"wavelength": [4e-7, 5.5e-7, 7e-7]},
)
def air_optical_depth(wavelength: FloatArray) -> Reference:
    """Return the Rayleigh optical depth of the atmosphere above sea level, straight up, dimensionless.

    wavelength  (...) in vacuum [m], 230 nm to 1690 nm

    The error counts rounding. Source: as for `air_cross_section`, times the molecules above a unit area.
    """
    sigma = air_cross_section(wavelength)
    value = sigma.value * COLUMN
    return Reference(value, 48 * EPS * value, sigma.method, sigma.source)


@quantity(
    unit="1/sr",
    convention="the clear sky for unit irradiance of the sun, by single scattering; cosines from the zenith, azimuth in rad",
    source="Chandrasekhar 1960, Radiative Transfer, section 7",
    example={"tau": [0.1, 0.3], "mu_sun": 0.5, "mu_view": 0.9, "azimuth": 0},
)
def plane_parallel_sky(tau: FloatArray, mu_sun: FloatArray, mu_view: FloatArray, azimuth: FloatArray) -> Reference:
    """Return the radiance of the clear sky for unit solar irradiance on a plane facing the sun [1/sr].

        L = f_p(mu) / mu_view int_0^tau exp(-t/mu_sun - (tau - t)/mu_view) dt

    tau      (...) optical depth of the atmosphere, straight up
    mu_sun   (...) cosine of the sun's angle from the zenith, in (0, 1]
    mu_view  (...) cosine of the view's angle from the zenith, in (0, 1], looking up from the ground
    azimuth  (...) between view and sun [rad]

    Single scattering by Rayleigh's phase function, no absorption, a black ground, a flat earth. The arguments broadcast.
    Error: some 40 eps, and 8 eps of the shorter way, tau over the larger cosine.
    Source: Chandrasekhar 1960, Radiative Transfer, section 7, with single scattering as the source.
    """
    tau, azimuth = as_float_array("tau", tau), as_float_array("azimuth", azimuth)
    mu_sun, mu_view = as_float_array("mu_sun", mu_sun), as_float_array("mu_view", mu_view)
    require("tau", tau, np.isfinite(tau) & (tau >= 0), "must be finite and >= 0")
    for name, mu in (("mu_sun", mu_sun), ("mu_view", mu_view)):
        require(name, mu, (mu > 0) & (mu <= 1), "must lie in (0, 1]", "the cosine of an angle from the zenith")
    require("azimuth", azimuth, np.isfinite(azimuth), "must be finite [rad]")
    sines = np.sqrt((1 - mu_sun) * (1 + mu_sun) * (1 - mu_view) * (1 + mu_view))
    mu = np.clip(mu_sun * mu_view + sines * np.cos(azimuth), -1, 1)
    scattered = phase_pdf(Rayleigh(), mu)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        to_sun, to_view = tau / mu_sun, tau / mu_view
        shorter = np.minimum(to_sun, to_view)
        # The integral is symmetric in the two paths; the shorter one is the better factor, nothing grows. What is left
        # tends to 1 along an endless view under a sun that shines, and to nothing where no light arrives.
        left = np.where(to_view < np.inf, to_view * phi1(np.abs(to_sun - to_view)), 1.0)
        value = np.where(shorter < np.inf, scattered.value * np.exp(-shorter) * left, 0.0)
        slack = 2 * ELEMENTARY + 40 * EPS + 4 * EPS * np.abs(azimuth) + 8 * EPS * shorter
        error = np.where(value > 0, value * slack, 0.0) + TINY
    return Reference(value, error, "closed form", "Chandrasekhar 1960, section 7")
