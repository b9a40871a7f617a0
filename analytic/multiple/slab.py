"""The slab that scatters many times: what it reflects, transmits and, where it glows, emits.

By reciprocity the share of a beam of cosine mu0 that is reflected (transmitted), in whatever direction, is the radiance
seen at mu0 when a sky of radiance 1 covers the same (the other) side. Isotropic scattering is solved to rounding, other
phase functions by their Legendre moments.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.isotropic_modes import isotropic_modes
from fogproof.analytic.multiple.legendre_modes import legendre_modes
from fogproof.analytic.multiple.scattering_arguments import checked_albedo, checked_cosine, checked_length
from fogproof.analytic.multiple.slab_modes import SOURCE
from fogproof.analytic.multiple.slab_solution import Leaving, leaving_slab, nodes_inside
from fogproof.analytic.phase.functions import phase_legendre_moments
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase import Isotropic, PhaseFunction, PhaseFunctionField
from fogproof.validate import number

METHOD = "discrete ordinates"

FINE, COARSE = 20, 16
"""Half the number of nodes of a solution, and of the one it is compared with."""

ROUNDING = 64 * EPS
"""What rounding adds to the error: isotropic scattering."""

LEGENDRE_ROUNDING = 2e-12
"""The same where moments are used: the smallest 1/k^2 are lost in the rounding of the largest."""

FAINT = 1e-30
"""Albedo below which nothing scatters that could be seen."""

MOST_NODES = 128
NEGLIGIBLE = 1e-8
"""Legendre moment below which the moments of a phase function are cut off, unless MOST_NODES come first."""


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

    It is also the radiance at mu0 under a uniform sky of radiance 1 on the same side. The error is estimated from a
    coarser solution: about 1e-14 for isotropic scattering, below 1e-10 for Henyey-Greenstein with |g| <= 0.85.
    Source: Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes et al. 1988.
    """
    return _directional(albedo, tau, mu0, phase, refractive_index, lambda leaving: leaving.reflected)


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
    return _directional(albedo, tau, mu0, phase, refractive_index, lambda leaving: leaving.transmitted)


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
    return _directional(
        albedo, tau, mu0, phase, refractive_index, lambda leaving: 1 - (leaving.reflected + leaving.transmitted)
    )


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
    return _diffuse(albedo, tau, phase, refractive_index, lambda leaving: leaving.diffuse_reflected)


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
    return _diffuse(albedo, tau, phase, refractive_index, lambda leaving: leaving.diffuse_transmitted)


class _Settings(NamedTuple):
    phase: PhaseFunction
    refractive_index: float


def _directional(albedo: Any, tau: Any, mu0: Any, phase: Any, index: Any, pick: Any) -> Reference:
    arrays = np.broadcast_arrays(checked_albedo(albedo), checked_length("tau", tau), checked_cosine("mu0", mu0))
    settings = _checked(phase, index)
    c, b, mu = (x.ravel() for x in arrays)
    value, error = np.empty(c.shape), np.empty(c.shape)
    for one_c, one_b in set(zip(c.tolist(), b.tolist(), strict=True)):
        here = (c == one_c) & (b == one_b)
        value[here], error[here] = _compare(one_c, one_b, mu[here], settings, pick)
    return Reference(value.reshape(arrays[0].shape), error.reshape(arrays[0].shape), METHOD, SOURCE)


def _diffuse(albedo: Any, tau: Any, phase: Any, index: Any, pick: Any) -> Reference:
    arrays = np.broadcast_arrays(checked_albedo(albedo), checked_length("tau", tau))
    settings = _checked(phase, index)
    pairs = zip(arrays[0].ravel().tolist(), arrays[1].ravel().tolist(), strict=True)
    found = [_compare(c, b, np.ones(1), settings, pick) for c, b in pairs]
    value, error = (np.array(column).reshape(arrays[0].shape) for column in zip(*found, strict=True))
    return Reference(value, error, METHOD, SOURCE)


def _checked(phase: Any, index: Any) -> _Settings:
    phase = Isotropic() if phase is None else phase
    if not isinstance(phase, PhaseFunction):
        raise InvalidValueError("phase", "must be a phase function", phase, "for example HenyeyGreenstein(0.5)")
    index = number("refractive_index", index, "must be finite and >= 1", 1)
    if index > 1 and not isinstance(phase, Isotropic):
        raise UnsupportedError(
            "a slab with a refractive index is solved for isotropic scattering only", "refractive_index"
        )
    return _Settings(phase, index)


def _compare(c: float, tau: float, mu0: np.ndarray, settings: _Settings, pick: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return what is asked for, and its error from a coarser solution."""
    phase, index = settings
    if isinstance(phase, Isotropic):
        fine, coarse = (pick(_solve(c, tau, mu0, None, index, n)) for n in (FINE, COARSE))
        return fine, np.abs(fine - coarse) + ROUNDING
    moments = phase_legendre_moments(phase, 2 * MOST_NODES)
    chi = moments.value
    n = int(np.clip(1 + np.flatnonzero(np.abs(chi) > NEGLIGIBLE)[-1] // 2, FINE, MOST_NODES))
    m = (3 * n) // 4
    finer, coarser = (_solve(c, tau, mu0, chi[: 2 * size], index, size) for size in (n, m))
    fine, coarse = pick(finer), pick(coarser)
    # Cutting the moments off at l costs about those beyond, ten times which is taken to bound the share of the error left.
    first, second = np.max(np.abs(chi[2 * n :])), np.max(np.abs(chi[2 * m : 2 * n]))
    left = 10 * first / second if second > 0 else 1.0
    # A phase function off by delta f changes each collision by its integral, at most the root of the sum (Parseval).
    change = np.sqrt((2 * np.arange(2 * n) + 1) @ moments.error[: 2 * n] ** 2)
    kept = min(np.min(finer.reflected + finer.transmitted), finer.diffuse_reflected + finer.diffuse_transmitted)
    collisions = min(c * max(1 - kept, 0.0) / (1 - c) if c < 1 else np.inf, 2 * (1 + tau) ** 2)
    return fine, np.abs(fine - coarse) * np.clip(left, 0.1, 1) + LEGENDRE_ROUNDING + change * collisions


def _solve(c: float, tau: float, mu0: np.ndarray, chi: np.ndarray | None, index: float, n: int) -> Leaving:
    nodes = nodes_inside(min(tau, 10 * float(np.min(mu0))), n, index)
    with np.errstate(under="ignore", over="ignore", divide="ignore"):
        modes = None
        if c > FAINT and tau > 0:
            mu, w = nodes.mu, nodes.w
            modes = isotropic_modes(c, 1 - c, mu, w) if chi is None else legendre_modes(c, 1 - c, chi, mu, w)
        return leaving_slab(modes, nodes, tau, mu0, index)
