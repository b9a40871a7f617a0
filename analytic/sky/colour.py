"""Colours of sun and sky in a clear atmosphere: spectra of the oracle, converted by colour-science.

Tristimulus values are those of the CIE 1931 2 degree observer, 360 nm to 780 nm in steps of 1 nm, in units of the sun above
the atmosphere: its Y is 1. `colour.XYZ_to_xy` and `colour.XYZ_to_sRGB` take it from there.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import quantity
from fogproof.analytic.sky.rayleigh_atmosphere import air_optical_depth, plane_parallel_sky
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray
from fogproof.validate import as_float_array, require

WAVELENGTHS = np.arange(360, 781) * 1e-9
"""Where the spectra are taken [m]."""

_BLOCK = 4096
"""Spectra in memory at the same time."""

SOURCE = "CIE 015:2018, tristimulus values, by colour-science; spectra: Bodhaine et al. 1999"


@quantity(
    unit="1",
    convention="CIE 1931 XYZ in the last axis; the sun above the atmosphere, D65, has Y = 1",
    source="CIE 15:2004; Bodhaine, Wood, Dutton & Slusser 1999",
    example={"air_mass": [0, 1, 10]},
)
def sun_colour(air_mass: FloatArray) -> Reference:
    """Return XYZ of direct sunlight after `air_mass` vertical atmospheres, (...) -> (..., 3); the sun above them has Y = 1.

    air_mass  (...) 0 above the atmosphere, 1 with the sun in the zenith, 1/cos of its angle from there on a flat earth,
              38 at the horizon of the round one

    The sun's spectrum is the daylight illuminant D65. Error: rounding, 1e-13 relative or so.
    """
    air_mass = as_float_array("air_mass", air_mass)
    require("air_mass", air_mass, np.isfinite(air_mass) & (air_mass >= 0), "must be finite and >= 0")
    value, error = in_blocks(_sun, _BLOCK, air_mass)
    return Reference(value, error, "sum over the spectrum, Beer's law", SOURCE)


def _sun(air_mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    path = air_mass[..., None] * air_optical_depth(WAVELENGTHS).value
    return _tristimulus(np.exp(-path), 60 * np.max(path, axis=-1))


@quantity(
    unit="1/sr",
    convention="CIE 1931 XYZ in the last axis; the sun above the air, D65, has Y = 1; cosines from the zenith, azimuth in rad",
    source="CIE 15:2004; Bodhaine, Wood, Dutton & Slusser 1999",
    example={"mu_sun": 0.5, "mu_view": [0.5, 0.9], "azimuth": 0},
)
def sky_colour(mu_sun: FloatArray, mu_view: FloatArray, azimuth: FloatArray) -> Reference:
    """Return XYZ per steradian of the clear sky by single scattering, (...) -> (..., 3); the sun above it has Y = 1.

    mu_sun, mu_view, azimuth  as for `plane_parallel_sky`; they broadcast

    The sun's spectrum is the daylight illuminant D65. Error: rounding, 1e-13 relative or so.
    """
    named = {"mu_sun": mu_sun, "mu_view": mu_view, "azimuth": azimuth}
    value, error = in_blocks(_sky, _BLOCK, *(as_float_array(*item) for item in named.items()))
    return Reference(value, error, "sum over the spectrum, single scattering, plane-parallel", SOURCE)


def _sky(mu_sun: np.ndarray, mu_view: np.ndarray, azimuth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    sky = plane_parallel_sky(
        air_optical_depth(WAVELENGTHS).value, mu_sun[..., None], mu_view[..., None], azimuth[..., None]
    )
    with np.errstate(over="ignore"):
        slack = 60 * (2 + 2 * 0.6 / np.maximum(mu_sun, mu_view))  # 48 EPS of the optical depth, which is below 0.6
    inherited, _ = _tristimulus(sky.error, np.zeros(slack.shape))
    value, error = _tristimulus(sky.value, slack)
    return value, error + inherited


def _tristimulus(spectrum: np.ndarray, eps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return XYZ of sunlight times `spectrum` (v, 421), each value of which is off by `eps` (v,) units of EPS, and its error."""
    import colour

    cmfs, sun, brightness = _observer()
    shape = cmfs.shape
    XYZ = colour.msds_to_XYZ(sun * spectrum, cmfs, method="Integration", k=1, shape=shape) / brightness
    rounding = 4 * len(WAVELENGTHS) + eps
    with np.errstate(invalid="ignore"):
        error = np.where(XYZ != 0, EPS * rounding[..., None] * np.abs(XYZ), 0.0)
    return XYZ, error


@cache
def _observer() -> tuple[Any, np.ndarray, float]:
    """Return the colour matching functions, the sun's spectrum (421,), and its Y in those units."""
    import colour

    shape = colour.SpectralShape(360, 780, 1)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    sun = colour.SDS_ILLUMINANTS["D65"].copy().align(shape).values
    Y = colour.msds_to_XYZ(sun[None], cmfs, method="Integration", k=1, shape=shape)[0, 1]
    return cmfs, sun, float(Y)
