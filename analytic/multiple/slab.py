"""The slab that scatters many times: what it reflects, transmits and, where it glows, emits.

By reciprocity the share of a beam of cosine mu0 that is reflected (transmitted), in whatever direction, is the radiance
seen at mu0 when a sky of radiance 1 covers the same (the other) side. Isotropic scattering is solved by its modes, other
phase functions by doubling.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.scattering_arguments import (
    checked_albedo,
    checked_cosine,
    checked_length,
    checked_phase,
)
from fogproof.analytic.multiple.slab_by_doubling import doubled_values, is_isotropic
from fogproof.analytic.multiple.slab_by_modes import SOURCE, Quantity, isotropic_values
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase import PhaseFunctionField
from fogproof.validate import number

METHOD = "discrete ordinates"


@quantity(
    unit="1",
    convention="share of a beam of cosine mu0 to the normal, all directions and orders of scattering; tau is the optical thickness",
    source="Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988",
    example={"albedo": [0.5, 0.9, 1], "tau": 1, "mu0": 0.5},
)
def slab_reflectance(
    albedo: FloatArray,
    tau: FloatArray,
    mu0: FloatArray,
    phase: PhaseFunctionField | None = None,
    refractive_index: float = 1.0,
) -> Reference:
    """Return the share of a beam that a slab reflects, over all directions and orders of scattering.

    albedo            (...) single-scattering albedo in [0, 1]
    tau               (...) optical thickness >= 0
    mu0               (...) cosine of the beam to the normal, outside, in (0, 1]; all three broadcast
    phase             phase function, isotropic unless given
    refractive_index  >= 1 of the medium, smooth boundaries; only with isotropic scattering

    It is also the radiance at mu0 under a uniform sky of radiance 1 on the same side. The error is relative, whatever the
    thickness and the albedo: below 1e-12 for isotropic scattering, below 1e-10 for Henyey-Greenstein with |g| <= 0.95 unless
    the slab is thin and seen at grazing angles, 1e-4 for 0.99. It is the difference to a solution with three quarters of the
    nodes and moments, which for falling moments is far above the error of the finer one; where they do not fall, three times the
    largest difference to any coarser solution. That is measured and not proven.
    Source: Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes et al. 1988.
    """
    return _values(albedo, tau, mu0, phase, refractive_index, "reflected")


@quantity(
    unit="1",
    convention="share of a beam of cosine mu0 to the normal, scattered or not; tau is the optical thickness",
    source="Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988",
    example={"albedo": [0.5, 0.9, 1], "tau": 1, "mu0": 0.5},
)
def slab_transmittance(
    albedo: FloatArray,
    tau: FloatArray,
    mu0: FloatArray,
    phase: PhaseFunctionField | None = None,
    refractive_index: float = 1.0,
) -> Reference:
    """Return the share of a beam that passes a slab, scattered or not; arguments and error as in `slab_reflectance`.

    It is also the radiance at mu0 above a uniform sky of radiance 1 on the other side.
    """
    return _values(albedo, tau, mu0, phase, refractive_index, "transmitted")


@quantity(
    unit="1",
    convention="radiance at cosine mu0 where L_e = 1, cold surroundings; also the share absorbed of a beam",
    source="Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988",
    example={"albedo": [0.5, 0.9, 1], "tau": 1, "mu0": 0.5},
)
def slab_emissivity(
    albedo: FloatArray,
    tau: FloatArray,
    mu0: FloatArray,
    phase: PhaseFunctionField | None = None,
    refractive_index: float = 1.0,
) -> Reference:
    """Return the radiance at cosine mu0 of a slab that emits L_e = 1 in cold surroundings; also the share absorbed of a beam.

    It is 1 - reflectance - transmittance (Kirchhoff); arguments and error as in `slab_reflectance`. L_e is outside the
    refractive index, as everywhere here.
    """
    return _values(albedo, tau, mu0, phase, refractive_index, "absorbed")


@quantity(
    unit="1",
    convention="share of diffuse light, the same from all directions of one side; tau is the optical thickness",
    source="Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988",
    example={"albedo": [0.5, 0.9, 1], "tau": 1},
)
def slab_diffuse_reflectance(
    albedo: FloatArray, tau: FloatArray, phase: PhaseFunctionField | None = None, refractive_index: float = 1.0
) -> Reference:
    """Return the share of diffuse light that a slab reflects; arguments and error as in `slab_reflectance`."""
    return _values(albedo, tau, None, phase, refractive_index, "reflected")


@quantity(
    unit="1",
    convention="share of diffuse light, the same from all directions of one side; tau is the optical thickness",
    source="Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988",
    example={"albedo": [0.5, 0.9, 1], "tau": 1},
)
def slab_diffuse_transmittance(
    albedo: FloatArray, tau: FloatArray, phase: PhaseFunctionField | None = None, refractive_index: float = 1.0
) -> Reference:
    """Return the share of diffuse light that passes a slab; arguments and error as in `slab_reflectance`."""
    return _values(albedo, tau, None, phase, refractive_index, "transmitted")


def _values(albedo: Any, tau: Any, mu0: Any, phase: Any, index: Any, wanted: Quantity) -> Reference:
    """Return the values for every albedo, thickness and cosine; mu0 = None means diffuse light."""
    beam = [] if mu0 is None else [checked_cosine("mu0", mu0)]
    arrays = np.broadcast_arrays(checked_albedo(albedo), checked_length("tau", tau), *beam)
    phase = checked_phase(phase)
    index = number("refractive_index", index, "must lie in [1, 100]", 1, 100)
    shape = arrays[0].shape
    c, b, *cosines = (x.ravel() for x in arrays)
    mu = cosines[0] if cosines else None
    if is_isotropic(phase):
        value, error = isotropic_values(c, b, mu, index, wanted)
    elif index > 1:
        raise UnsupportedError(
            "a slab with a refractive index is solved for isotropic scattering only", "refractive_index"
        )
    else:
        value, error = doubled_values(c, b, mu, phase, wanted)
    return Reference(value.reshape(shape), error.reshape(shape), METHOD, SOURCE)
