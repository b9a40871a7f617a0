"""The scattering coefficient of particles much smaller than the wavelength."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.complex_numbers import ComplexNumber
from fogproof.validate import as_float_array, require


@quantity(
    unit="1/m",
    convention="lengths in m, number density in 1/m^3, refractive index and wavelength as the medium sees them",
    source="Rayleigh 1871; Bohren & Huffman 1983, eq. 5.8",
    example={"diameter": 3e-10, "refractive_index": [1.5, 0.1], "number_density": 2.5e25, "wavelength": [4e-7, 7e-7]},
)
def rayleigh_scattering_coefficient(
    diameter: FloatArray, refractive_index: ComplexNumber, number_density: FloatArray, wavelength: FloatArray
) -> Reference:
    """Return beta_s = rho (2 pi^5/3) (d^6/lambda^4) |(eta^2 - 1)/(eta^2 + 2)|^2 [1/m].

    diameter          (...) d of the spheres [m]
    refractive_index  (...) eta of the spheres relative to the medium, real or complex
    number_density    (...) rho [1/m^3]
    wavelength        (...) lambda in the medium [m]

    The arguments broadcast. The formula is the first term of the Lorenz-Mie series in x = pi d/lambda, from which that
    series departs by O(x^2); the error, 40 eps, counts rounding only. The formula has a pole at
    eta = i sqrt(2), the resonance of a metal sphere. Source: Rayleigh 1871; Bohren & Huffman 1983, eq. 5.8.
    """
    d, rho, lam = (
        as_float_array(name, value)
        for name, value in (("diameter", diameter), ("number_density", number_density), ("wavelength", wavelength))
    )
    eta = _complex_array("refractive_index", refractive_index)
    require("diameter", d, np.isfinite(d) & (d >= 0), "must be finite and >= 0 [m]")
    require("number_density", rho, np.isfinite(rho) & (rho >= 0), "must be finite and >= 0 [1/m^3]")
    require("wavelength", lam, np.isfinite(lam) & (lam > 0), "must be finite and > 0 [m]")
    # |eta^2 - 1|/|eta^2 + 2| factor by factor: neither cancels at eta = 1 or at the resonance eta = i sqrt(2), none overflows.
    first = np.abs(eta - 1) / np.abs(_minus_i_root_two(eta))
    second = np.abs(eta + 1) / np.abs(_minus_i_root_two(eta.conj()))
    with np.errstate(under="ignore"):
        value = (2 * np.pi**5 / 3) * (d / lam) ** 4 * d**2 * (first * second) ** 2 * rho
        error = 40 * EPS * value + TINY * (1 + rho)
    return Reference(np.asarray(value), np.asarray(error), "closed form", "Bohren & Huffman 1983, eq. 5.8")


def _minus_i_root_two(eta: np.ndarray) -> np.ndarray:
    """Return eta - i sqrt(2), with sqrt(2) to twice the digits of a float."""
    return eta.real + 1j * ((eta.imag - 1.4142135623730951) + 9.667293313452913e-17)


def _complex_array(name: str, value: Any) -> np.ndarray:
    array = np.asarray(value)
    if array.dtype.kind not in "iufc":
        raise InvalidValueError(name, "must be a number or an array of numbers", value)
    array = array.astype(np.complex128)
    if not np.isfinite(array).all():
        raise InvalidValueError(name, "must be finite", value)
    return array
