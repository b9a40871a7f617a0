"""Layers of different media over a ground that reflects: what they send where, after all orders of scattering.

The slab of `slab` with more than one layer, each with its albedo and phase function, and what lies below. Beams and views are
given by cosines to the normal; the source is far above, the surroundings are black.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.layer_stacks import Fluxes, fluxes, more_than_once, once
from fogproof.analytic.multiple.layered_problem import collisions, problem_of, settled
from fogproof.analytic.multiple.scattering_arguments import checked_cosine
from fogproof.analytic.multiple.slab_by_doubling import LEVELS, MOMENTS
from fogproof.analytic.multiple.slab_directions import Beams, Side
from fogproof.contracts import Reference
from fogproof.scene.arrays import FloatArray
from fogproof.scene.grounds import GroundField
from fogproof.scene.slab_layers import SlabLayer
from fogproof.validate import as_float_array, number, require

METHOD = "adding and doubling"
SOURCE = "van de Hulst 1980, Multiple Light Scattering, section 4.3; de Haan, Bosma & Hovenier 1987"

ROUNDING = 256 * EPS
"""What rounding adds to the error, relative, and 4 eps for each factor e below 1."""

TWO = [
    {"tau": 0.5, "albedo": 0.99, "phase": {"kind": "henyey-greenstein", "g": 0.5}},
    {"tau": 1, "albedo": 0.7, "phase": {"kind": "rayleigh"}},
]
SNOW = {"kind": "lambert", "albedo": 0.8}
"""Parts of the examples."""


@quantity(
    unit="1",
    convention="share of a beam of cosine mu0 to the normal that leaves upwards; the uppermost layer first; surroundings black",
    source=SOURCE,
    example={"layers": TWO, "mu0": [0.2, 0.5, 1], "ground": SNOW},
)
def layered_reflectance(layers: tuple[SlabLayer, ...], mu0: FloatArray, ground: GroundField | None = None) -> Reference:
    """Return the share of a beam that layers over a ground send back, over all directions and orders of scattering.

    layers  1 to 100 layers, each of one optical thickness, albedo and phase function; the uppermost first
    mu0     (...) cosine of the beam to the normal, in (0, 1]
    ground  what lies below and reflects; black unless given

    It is also the radiance at mu0 under a uniform sky of radiance 1. The error is the difference to a solution with three quarters
    of the nodes and moments: below 1e-10, relative, for Henyey-Greenstein with |g| <= 0.95 unless layers are thin and seen at
    grazing angles. Where a phase function is more peaked, it is three times the largest difference to any coarser solution. That
    is measured and not proven.
    Source: van de Hulst 1980, section 4.3; de Haan, Bosma & Hovenier 1987.
    """
    return _fluxes(layers, mu0, ground, lambda found: found.reflected)


@quantity(
    unit="1",
    convention="irradiance at the bottom per irradiance of the top, straight and scattered light, the ground's included",
    source=SOURCE,
    example={"layers": TWO, "mu0": [0.2, 0.5, 1], "ground": SNOW},
)
def layered_transmittance(
    layers: tuple[SlabLayer, ...], mu0: FloatArray, ground: GroundField | None = None
) -> Reference:
    """Return the irradiance of the ground per irradiance of the uppermost layer; arguments and error as in `layered_reflectance`.

    Light that the ground reflects and that comes back counts again each time, so over a bright ground it may exceed 1.
    """
    return _fluxes(layers, mu0, ground, lambda found: found.transmitted, passed=True)


@quantity(
    unit="W/(m^2 sr)",
    convention="radiance upwards at cosine mu of layers and a ground that glow, all orders of scattering; surroundings cold",
    source=SOURCE,
    example={"layers": [{**TWO[0], "emission": 1}, TWO[1]], "mu": [0.2, 1], "ground": SNOW, "ground_emission": 2},
)
def layered_emission(
    layers: tuple[SlabLayer, ...], mu: FloatArray, ground: GroundField | None = None, ground_emission: float = 0.0
) -> Reference:
    """Return the radiance of layers and a ground that glow [W/(m^2 sr)], seen from above at cosine mu.

    layers           as in `layered_reflectance`; each glows with its own emission L_e, of which 1 - albedo counts
    mu               (...) cosine of the view to the normal, in (0, 1]
    ground           as there; without one there is nothing below
    ground_emission  L_e of the ground [W/(m^2 sr)], of which 1 - its directional reflectance counts

    With every L_e = 1 it is 1 - reflectance over a ground (Kirchhoff). Error: as there.
    """
    rule = "must be finite and >= 0 [W/(m^2 sr)]"
    return _fluxes(
        layers, mu, ground, lambda found: found.emitted, "mu", number("ground_emission", ground_emission, rule, 0)
    )


@quantity(
    unit="1/sr",
    convention="radiance per irradiance of the surface; cosines to the normal; azimuth between the ways on, 0 straight ahead",
    source=SOURCE,
    example={"layers": TWO, "mu0": 0.5, "mu": [0.2, 1], "azimuth": [0, 1], "ground": SNOW},
)
def layered_brdf(
    layers: tuple[SlabLayer, ...],
    mu0: FloatArray,
    mu: FloatArray,
    azimuth: FloatArray,
    ground: GroundField | None = None,
) -> Reference:
    """Return the reflectance distribution of layers over a ground [1/sr]: radiance at any angle per irradiance.

    layers   as in `layered_reflectance`
    mu0, mu  (...) cosines of the beam and of the view to the normal, in (0, 1]
    azimuth  (...) between the horizontal directions of travel before and after [rad]; 0 goes on ahead; all three broadcast
    ground   as there

    What met something once comes from phase functions and BRDF themselves, the rest is a Fourier series in azimuth by adding
    and doubling. The error is the difference to a solution with three quarters of the nodes, and as there for peaked phase
    functions: about 1e-10 relative for Henyey-Greenstein with |g| <= 0.8.
    Source: de Haan, Bosma & Hovenier 1987; Nakajima & Tanaka 1988.
    """
    return _directional(layers, mu0, mu, azimuth, ground, "reflected")


@quantity(
    unit="1/sr",
    convention="scattered radiance at the bottom per irradiance above, without the beam; cosines to the normal; azimuth 0 ahead",
    source=SOURCE,
    example={"layers": TWO, "mu0": 0.5, "mu": [0.2, 1], "azimuth": [0, 1], "ground": SNOW},
)
def layered_btdf(
    layers: tuple[SlabLayer, ...],
    mu0: FloatArray,
    mu: FloatArray,
    azimuth: FloatArray,
    ground: GroundField | None = None,
) -> Reference:
    """Return the distribution of scattered light at the ground [1/sr]; arguments and error as in `layered_brdf`.

    What passes straight through is not part of it; what the ground has reflected and the layers send back is.
    """
    return _directional(layers, mu0, mu, azimuth, ground, "transmitted")


def _fluxes(
    layers: Any,
    mu0: Any,
    ground: Any,
    wanted: Callable[[Fluxes], np.ndarray],
    name: str = "mu0",
    ground_emission: float = 0.0,
    passed: bool = False,
) -> Reference:
    problem = problem_of(layers, ground, ground_emission, None)
    cosines = checked_cosine(name, mu0)
    flat = cosines.ravel()
    if not flat.size:
        return Reference(np.zeros(cosines.shape), np.zeros(cosines.shape), METHOD, SOURCE)
    data, below, left_out = problem.layers, problem.below, problem.left_out
    depth, brightest = collisions(data), max([1.0, ground_emission, *(one.emission for one in data)])

    def rounding(n: int, value: np.ndarray) -> np.ndarray:
        smaller = np.abs(np.log(np.clip(value, TINY, 1)))
        doubt = float(problem.change[MOMENTS * n])
        lost = brightest * np.minimum(doubt * depth + left_out * 2 / flat, 1.0)
        if passed:  # what passes deep layers changes with phase functions in relative terms
            lost = np.minimum(lost, doubt * 10 * (depth + smaller) * value + left_out * 2 / flat)
        return (ROUNDING + 4 * EPS * smaller) * value + lost

    with np.errstate(under="ignore", over="ignore"):
        value, error = settled(lambda n: wanted(fluxes(data, below, flat, n)), rounding, problem)
    return Reference(value.reshape(cosines.shape), error.reshape(cosines.shape), METHOD, SOURCE)


def _directional(layers: Any, mu0: Any, mu: Any, azimuth: Any, ground: Any, side: Side) -> Reference:
    problem = problem_of(layers, ground, 0.0, LEVELS)
    data, below, left_out = problem.layers, problem.below, problem.left_out
    angle = as_float_array("azimuth", azimuth)
    require("azimuth", angle, np.isfinite(angle), "must be finite [rad]")
    arrays = np.broadcast_arrays(checked_cosine("mu0", mu0), checked_cosine("mu", mu), angle)
    shape, beams = arrays[0].shape, Beams(*(x.ravel() for x in arrays))
    if not beams.mu.size:
        return Reference(np.zeros(shape), np.zeros(shape), METHOD, SOURCE)
    first: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def solve(n: int) -> np.ndarray:
        first[n] = once(data, below, beams, side, n)
        return first[n][0] + more_than_once(data, below, beams, side, n, first[n][0])

    def rounding(n: int, value: np.ndarray) -> np.ndarray:
        single, its_error = first[n]
        more = np.abs(value - single)
        grazes = np.minimum(beams.mu0, beams.mu) < 1e-13 * min(1.0, *(one.tau for one in data))
        doubt = float(problem.change[MOMENTS * n]) * collisions(data) + np.where(grazes, 64 * 1e-13, 0.0)
        lost = left_out / (beams.mu0 * beams.mu)
        return its_error + (ROUNDING + 1e-12) * (single + more) + doubt * more + lost

    with np.errstate(under="ignore", over="ignore"):
        value, error = settled(solve, rounding, problem)
    return Reference(value.reshape(shape), error.reshape(shape), METHOD, SOURCE)
