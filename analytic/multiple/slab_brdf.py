"""Where a slab sends what it reflects and transmits; for isotropic scattering by the X and Y functions.

Lit by a uniform sky on one side only, a slab absorbs E(mu) = 1 - R - T of what comes from mu, and F = 1 - R + T. Both are X and
Y in disguise: X - Y = E(mu)/E(0) and X + Y = F(mu)/F(0), and at grazing angles the radiance that leaves is the source at
the surface. As nothing is absorbed any more, E(mu)/E(0) tends to a limit, which is computed as one: all of E is of the
order of the smallest k^2.
Source: Chandrasekhar 1960, Radiative Transfer, chapter 8 and section 62.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.half_space import half_space_brdf
from fogproof.analytic.multiple.isotropic_modes import isotropic_modes
from fogproof.analytic.multiple.scattering_arguments import (
    DEEPEST,
    checked_albedo,
    checked_azimuth,
    checked_cosine,
    checked_length,
    checked_phase,
    seen_at,
)
from fogproof.analytic.multiple.slab_by_doubling import is_isotropic
from fogproof.analytic.multiple.slab_directions import Beams, Side, directional_in_parts
from fogproof.analytic.multiple.slab_modes import Modes, amplitudes, quadrature, scattered
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase import PhaseFunctionField

METHOD = "discrete ordinates"
SOURCE = "Chandrasekhar 1960, Radiative Transfer, chapter 8"

FINE, COARSE = 20, 16
"""Half the number of nodes of a solution, and of the one it is compared with."""

RELATIVE_ROUNDING = 1e-13

DEEP, FADED = 1e3, 60.0
"""Thickness beyond which, and times k, a slab is taken for an endless one."""

HOPF = 0.71044608959876307
"""q(infinity), the extrapolated end of an atmosphere that absorbs nothing."""

MANY = 0.5
"""Albedo from which on the mode of the smallest k is taken out of E."""


@quantity(
    unit="1/sr",
    convention="radiance per irradiance of the surface; cosines to the normal; azimuth between the ways on, 0 straight ahead",
    source="Chandrasekhar 1960, Radiative Transfer, section 62; de Haan, Bosma & Hovenier 1987",
    example={"albedo": 0.9, "tau": 1, "mu0": 0.5, "mu": [0.2, 0.5, 1]},
)
def slab_brdf(
    albedo: FloatArray,
    tau: FloatArray,
    mu0: FloatArray,
    mu: FloatArray,
    phase: PhaseFunctionField | None = None,
    azimuth: FloatArray | None = None,
) -> Reference:
    """Return the reflectance distribution of a slab [1/sr]: radiance at any angle per irradiance, all orders of scattering.

    albedo   (...) in [0, 1]
    tau      (...) optical thickness >= 0
    mu0, mu  (...) cosines of the beam and of the view to the normal, in (0, 1]
    phase    phase function, isotropic unless given
    azimuth  (...) between the horizontal directions of travel before and after [rad]; 0 goes on ahead. It may be left out for
             isotropic scattering only; all five broadcast

    For isotropic scattering it is c (X(mu0) X(mu) - Y(mu0) Y(mu))/(4 pi (mu0 + mu)), with an error of about 1e-13, relative,
    and 4 eps tau where tau is large but too little is absorbed for the slab to look endless. For other phase functions light
    scattered once comes from the phase function itself, the rest by doubling.
    Errors are estimated from coarser solutions.
    Source: Chandrasekhar 1960, Radiative Transfer, section 62; de Haan, Bosma & Hovenier 1987; Nakajima & Tanaka 1988.
    """
    return _kernel(albedo, tau, mu0, mu, phase, azimuth, "reflected")


@quantity(
    unit="1/sr",
    convention="scattered radiance below per irradiance above; cosines to the normal; azimuth 0 straight ahead; without the beam",
    source="de Haan, Bosma & Hovenier 1987",
    example={"albedo": 0.9, "tau": 1, "mu0": 0.5, "mu": [0.2, 0.5, 1]},
)
def slab_btdf(
    albedo: FloatArray,
    tau: FloatArray,
    mu0: FloatArray,
    mu: FloatArray,
    phase: PhaseFunctionField | None = None,
    azimuth: FloatArray | None = None,
) -> Reference:
    """Return the distribution of what a slab transmits scattered [1/sr]; arguments as in `slab_brdf`.

    What passes straight through, exp(-tau/mu0) of the beam in its own direction, is not part of it.
    """
    return _kernel(albedo, tau, mu0, mu, phase, azimuth, "transmitted")


def _kernel(albedo: Any, tau: Any, mu0: Any, mu: Any, phase: Any, azimuth: Any, side: Side) -> Reference:
    phase = checked_phase(phase)
    isotropic = is_isotropic(phase)
    angle = checked_azimuth(azimuth, isotropic)
    checked = checked_albedo(albedo), checked_length("tau", tau), checked_cosine("mu0", mu0), checked_cosine("mu", mu)
    arrays = np.broadcast_arrays(*checked, angle)
    c, b, ins, outs, turn = (x.ravel() for x in arrays)
    deeper, b = np.maximum(b / DEEPEST, 1.0), np.minimum(b, DEEPEST)
    value, error = np.zeros(c.shape), np.zeros(c.shape)
    with np.errstate(under="ignore", over="ignore", divide="ignore"):
        for one_c, one_b in set(zip(c.tolist(), b.tolist(), strict=True)):
            here = np.flatnonzero((c == one_c) & (b == one_b))
            if one_c == 0 or one_b == 0:
                continue
            if isotropic and side == "reflected" and _is_deep(one_c, one_b):
                value[here], error[here] = _deep_brdf(one_c, one_b, ins[here], outs[here])
                continue
            if isotropic and side == "reflected":
                fine, coarse = (_brdf(one_c, one_b, ins[here], outs[here], n) for n in (FINE, COARSE))
                value[here] = fine
                error[here] = np.abs(fine - coarse) + (RELATIVE_ROUNDING + 4 * EPS * one_b) * fine + TINY
                continue
            beams = Beams(ins[here], outs[here], turn[here])
            value[here], error[here] = directional_in_parts(one_c, one_b, beams, phase, side)
    if side == "transmitted":  # what passes is nothing, or if nothing is absorbed as 1/tau
        value, error = value / deeper, error / deeper + TINY * (deeper > 1)
    return Reference(value.reshape(arrays[0].shape), error.reshape(arrays[0].shape), METHOD, SOURCE)


def _is_deep(c: float, tau: float) -> bool:
    """Return whether a slab reflects as an endless one, but for what passes it where nothing is absorbed.

    The slowest mode falls like exp(-k tau) with k^2 >= 1 - c, and there and back again.
    """
    return tau > DEEP and (c == 1 or math.sqrt(1 - c) * tau > FADED)


def _deep_brdf(c: float, tau: float, mu0: np.ndarray, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the half space's BRDF, less the BTDF H(mu0) H(mu)/(4 pi (tau + 2 q)) at albedo 1; q is Hopf's constant.

    Source: van de Hulst 1980, Multiple Light Scattering, sections 5.2 and 14.1.
    """
    found = half_space_brdf(c, mu0, mu)
    if c < 1:
        return found.value, found.error
    passed = found.value * (mu0 + mu) / (tau + 2 * HOPF)  # c H H/(4 pi (mu0 + mu)) is the half space's
    return found.value - passed, found.error * (1 + 2 / tau) + 4 * EPS * found.value + TINY


def _brdf(c: float, tau: float, mu0: np.ndarray, mu: np.ndarray, n: int) -> np.ndarray:
    both, where = np.unique(seen_at(np.concatenate([mu0, mu]), tau), return_inverse=True)
    nodes = quadrature(min(tau, 10 * float(np.min(both))), n)
    modes = isotropic_modes(max(c, EPS**2), 1 - c, *nodes)
    difference, total = _difference(modes, c, tau, both), _total(modes, tau, both)
    (d0, d), (t0, t) = np.split(difference[where], 2), np.split(total[where], 2)
    return c * (d0 * t + t0 * d) / (8 * np.pi * (mu0 + mu))


def _total(modes: Modes, tau: float, mu: np.ndarray) -> np.ndarray:
    """Return X + Y."""
    half = tau / 2
    amplitude = amplitudes(modes, half, "odd", np.full(len(modes.mu), 0.5))
    grazing = np.tanh(modes.k * half) / np.where(modes.k > 0, modes.k, 1.0) + np.where(modes.k > 0, 0.0, half)
    f = 1 + np.exp(-tau / mu) - 2 * scattered(modes, half, "odd", amplitude, mu)
    return f / (1 - grazing @ amplitude)


def _difference(modes: Modes, c: float, tau: float, mu: np.ndarray) -> np.ndarray:
    """Return X - Y."""
    half = tau / 2
    if c < MANY:
        amplitude = amplitudes(modes, half, "even", np.full(len(modes.mu), 0.5))
        e = -np.expm1(-tau / mu) - 2 * scattered(modes, half, "even", amplitude, mu)
        return e / (1 - np.sum(amplitude))
    # The amplitudes are those of the smallest k alone plus k^2 times these; E is k^2 times what follows.
    k = modes.k[-1]
    t = np.tanh(k * half) / k if k * half > 1e-8 else half

    def part(x: np.ndarray) -> np.ndarray:
        return x / ((1 - k * x) * (1 + k * x))

    amplitude = amplitudes(modes, half, "even", part(modes.mu) * (modes.mu + t))
    through = np.exp(-tau / mu)
    e = part(mu) * (t * (1 + through) - mu * (1 - through)) + scattered(modes, half, "even", amplitude, mu)
    return e / (np.sum(amplitude) / 2)
