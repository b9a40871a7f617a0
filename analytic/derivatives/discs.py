"""Why a quantity is bounded for complex parameters: the arguments that make a derivative's error a bound.

Light adds up: every quantity here is an integral, or a sum over scattering orders of integrals, of non-negative terms. Where
a parameter enters each term by powers and decaying exponentials alone, the modulus at a complex parameter is at most the
same quantity at real ones, which the oracle knows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from fogproof.analytic.derivatives.from_values import Disc
from fogproof.analytic.derivatives.parameters import Parameter
from fogproof.analytic.media.coefficients import ROOM
from fogproof.analytic.multiple.slab_by_doubling import is_isotropic
from fogproof.analytic.phase.kinds import ROOM as PHASES
from fogproof.contracts import Reference
from fogproof.scene.kinds import given
from fogproof.scene.phase import Isotropic

Quantity = Callable[..., Reference]

ALONG_A_RAY = (
    "transmittance",
    "ambient_fog",
    "emitted_radiance",
    "single_scattering",
    "radiance",
    "radiance_by_quadrature",
    "radiance_by_ode",
)
"""Each term has at most one coefficient before an exponential of the others."""

LENGTHS = ("tau", "radius", "length")
"""Sizes in mean free paths, which stand beside an albedo."""

SHARES = (
    "slab_reflectance",
    "slab_transmittance",
    "slab_diffuse_reflectance",
    "slab_diffuse_transmittance",
    "ball_albedo",
    "ball_radiance",
    "ball_source",
)
"""At most 1 + c/(1 - c P), where P bounds the chance that what scatters isotropically collides again."""

ALONG_A_LINE = ("sigma_t", "sigma_a", "sigma_s")

HALVINGS = 12
"""How often a disc is halved: what decays fast is better looked at closely."""


def discs(name: str, quantity: Quantity, arguments: Mapping[str, Any], wanted: Parameter) -> list[Iterator[Disc]]:
    """Return discs about the parameter's value in which the quantity is bounded, a series of smaller ones for each argument."""
    value = float(wanted.read(arguments))
    last = wanted.path[-1]
    if name in ALONG_A_RAY and _is_linear(arguments, wanted) and value > 0:
        return [_of_a_coefficient(quantity, arguments, wanted, value)]
    most_near = given(_owner(arguments, wanted), PHASES, "most_near")
    if name in ALONG_A_RAY and most_near is not None:
        return [_of_a_phase_function(quantity, arguments, wanted, most_near)]
    if "albedo" not in arguments or len(wanted.path) > 1:
        return []
    if last == "albedo":
        return [_of_an_albedo(name, quantity, arguments, value), _of_an_albedo_beyond_one(name, arguments, value)]
    if last in LENGTHS and value > 0:
        return [
            _of_a_size(name, quantity, arguments, wanted, value),
            _of_a_size_that_lets_out(name, arguments, value),
        ]
    return []


def _of_a_coefficient(
    quantity: Quantity, arguments: Mapping[str, Any], wanted: Parameter, value: float
) -> Iterator[Disc]:
    """For z within R of a coefficient s: |exp(-z l)| <= exp(-(s - R) l), and the one before it is |z| <= s + R."""
    for halving in range(1, HALVINGS):
        radius = value * 0.5**halving
        less = quantity(**wanted.replaced(arguments, value - radius))
        yield Disc(radius, (value + radius) / (value - radius) * (np.abs(less.value) + less.error))


def _of_a_phase_function(
    quantity: Quantity, arguments: Mapping[str, Any], wanted: Parameter, most_near: Callable[..., float]
) -> Iterator[Disc]:
    """What scatters once is at most what isotropic scattering gives, times the largest 4 pi |f|."""
    phase = _owner(arguments, wanted)
    alike = quantity(**Parameter(wanted.name, wanted.path[:-1]).replaced(arguments, Isotropic()))
    for halving in range(1, HALVINGS):
        radius = 0.5**halving
        most = most_near(phase, wanted.path[-1], radius)
        if np.isfinite(most):
            yield Disc(radius, most * (np.abs(alike.value) + alike.error))


def _of_an_albedo(name: str, quantity: Quantity, arguments: Mapping[str, Any], value: float) -> Iterator[Disc]:
    """A power series in the albedo with non-negative coefficients is largest on the real axis."""
    if value < 1 and name != "slab_emissivity":
        most = quantity(**{**arguments, "albedo": 1.0})
        yield Disc(1 - value, np.abs(most.value) + most.error, below=value)
        for halving in range(1, HALVINGS):
            radius = (1 - value) * 0.5**halving
            most = quantity(**{**arguments, "albedo": value + radius})
            yield Disc(radius, np.abs(most.value) + most.error, below=value)
    elif value < 1:
        yield Disc(1 - value, np.asarray(3.0), below=value)  # 1 - R - T


def _of_an_albedo_beyond_one(name: str, arguments: Mapping[str, Any], value: float) -> Iterator[Disc]:
    chance = collides_again(name, arguments)
    if chance is not None:
        widest = 1 / max(chance(0.0), 1e-3) - value
        yield from (
            disc._replace(below=value, above=1 - value)
            for disc in _beyond(lambda radius: (value + radius, chance(0.0)), widest)
        )


def _of_a_size(
    name: str, quantity: Quantity, arguments: Mapping[str, Any], wanted: Parameter, value: float
) -> Iterator[Disc]:
    """A size b is sigma_t where lengths are 1: orders n go as (c z)^n times exponentials of -z l."""
    albedo = np.asarray(arguments["albedo"], dtype=float)
    most_albedo = float(np.max(albedo, initial=0.0))
    largest = value * (1 - most_albedo) / (1 + most_albedo)
    if largest > 0 and name != "slab_emissivity":
        for halving in range(HALVINGS):
            radius = min(largest, 0.5 * value) * 0.5**halving
            grown = np.minimum(albedo * (value + radius) / (value - radius), 1.0)
            less = quantity(**{**arguments, "albedo": grown, wanted.path[0]: value - radius})
            yield Disc(radius, np.abs(less.value) + less.error)
    elif largest > 0:
        yield Disc(min(largest, 0.5 * value), np.asarray(3.0))


def _of_a_size_that_lets_out(name: str, arguments: Mapping[str, Any], value: float) -> Iterator[Disc]:
    most_albedo = float(np.max(arguments["albedo"], initial=0.0))
    chance = collides_again(name, arguments)
    if chance is not None:
        yield from _beyond(
            lambda radius: (most_albedo * (value + radius) / (value - radius), chance(radius)), 0.5 * value
        )


def _beyond(at: Callable[[float], tuple[float, float]], widest: float) -> Iterator[Disc]:
    """Return discs in which c P < 1 although c may exceed 1: a body that lets light out loses more than it gains."""
    for shrinking in range(1, 24):
        radius = widest * 0.6**shrinking
        albedo, chance = at(radius)
        if albedo * chance < 1:
            yield Disc(radius, np.asarray(1 + albedo / (1 - albedo * chance)))


def collides_again(name: str, arguments: Mapping[str, Any]) -> Callable[[float], float] | None:
    """Return (how much smaller the body is) -> the chance at most that what scatters isotropically collides again.

    It is largest in the middle: 1 - E_2(tau/2) in a slab, 1 - exp(-R) in a ball.
    """
    from scipy.special import expn

    if name not in SHARES or arguments.get("refractive_index", 1.0) != 1:
        return None
    if not is_isotropic(arguments.get("phase") or Isotropic()):
        return None
    if "tau" in arguments:
        thickness = float(np.max(arguments["tau"]))
        return lambda smaller: float(1 - expn(2, max(thickness - smaller, 0.0) / 2)) * (1 + 1e-12)
    size = float(np.max(arguments["radius"]))
    return lambda smaller: float(-np.expm1(-max(size - smaller, 0.0))) * (1 + 1e-12)


def _is_linear(arguments: Mapping[str, Any], wanted: Parameter) -> bool:
    if wanted.path[-1] not in ALONG_A_LINE:
        return False
    medium = _owner(arguments, wanted)
    return wanted.path[-1] in (given(medium, ROOM, "LINEAR_IN") or ())


def _owner(arguments: Mapping[str, Any], wanted: Parameter) -> Any:
    """Return the thing that has the parameter as a field."""
    thing: Any = arguments
    for step in wanted.path[:-1]:
        thing = thing[step] if isinstance(thing, Mapping) else getattr(thing, step)
    return thing
