"""Planck's law: what a black body of a temperature glows with."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray
from fogproof.validate import as_float_array, require

PLANCK, LIGHT, BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23
"""h [J s], c [m/s] and k [J/K], exact since 2019."""

SECOND = PLANCK * LIGHT / BOLTZMANN
"""h c/k [m K]."""


@quantity(
    unit="W/(m^2 sr nm)",
    convention="spectral radiance per nanometre of wavelength in vacuum, unpolarised; SI constants of 2019",
    source="Planck 1900; BIPM 2019, The International System of Units",
    example={"temperature": [300, 1500, 6500], "wavelength": 5.5e-7},
)
def black_body_radiance(temperature: FloatArray, wavelength: FloatArray) -> Reference:
    """Return the spectral radiance of a black body, 2 h c^2/lambda^5/(exp(h c/(lambda k T)) - 1) [W/(m^2 sr nm)].

    temperature  (...) T [K], finite and >= 0; nothing glows at 0
    wavelength   (...) lambda [m], > 0; both broadcast

    Error: 32 eps relative and 4 eps for each factor e by which it is fainter than the law of Rayleigh and Jeans.
    Source: Planck 1900.
    """
    T, length = np.broadcast_arrays(
        as_float_array("temperature", temperature), as_float_array("wavelength", wavelength)
    )
    require("temperature", T, np.isfinite(T) & (T >= 0), "must be finite and >= 0 [K]")
    require("wavelength", length, np.isfinite(length) & (length > 0), "must be finite and > 0 [m]")
    value, x = planck(T, length)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        error = np.where(value > 0, (ELEMENTARY + 32 * EPS + 4 * EPS * np.minimum(x, 1600.0)) * value, 0.0) + 2 * TINY
    return Reference(value, error, "Planck's law", "Planck 1900")


def planck(T: np.ndarray, length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the radiance and h c/(lambda k T)."""
    with np.errstate(divide="ignore", over="ignore", invalid="ignore", under="ignore"):
        x = np.where(T > 0, SECOND / (length * np.maximum(T, 1e-300)), np.inf)
        half = np.exp(-0.5 * x)  # exp(-x) itself would be too small for a float where the radiance is not
        front = 2e-9 * LIGHT * BOLTZMANN * T / length**2 / length**2
        small = np.minimum(x, 700.0)
        value = np.where(x < 700, front * np.where(small > 0, small / np.expm1(small), 1.0), front * x * half * half)
    value = np.where(half > 0, value, 0.0)
    return np.where(T > 0, value, 0.0), x
