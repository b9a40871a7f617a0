"""Path lengths for nothing: their law is how a quantity changes with absorption.

Absorption s more per metre takes exp(-s l) of light that has gone l metres, whatever it met on the way. So a quantity in
which sigma_a is raised by s is the Laplace transform of the law of l, weighed as the quantity weighs it; the first
derivatives at s = 0 are moments. Lengths inside the medium count, from where light enters it or starts in it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import quantity as declared
from fogproof.analytic.derivatives.discs import HALVINGS, LENGTHS, collides_again
from fogproof.analytic.derivatives.from_values import Disc
from fogproof.analytic.derivatives.gradient import PROVEN, least_error, named
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import Medium, Scene
from fogproof.scene.arrays import AxisArray
from fogproof.validate import as_float_array, require

LENGTHS_COUNT = "lengths inside the medium, in mean free paths where the quantity's lengths are, else in metres"
HALF_SPACE = {"quantity": "half_space_reflectance", "albedo": 0.9, "mu0": 0.5}
"""Of the declarations and their examples."""

SOURCE = "Feynman-Kac; Ivanov & Gutshabash 1974, on the duration of random walks of light"


@declared(
    unit="that of the quantity",
    convention=f"every path is weighed by exp(-s l); {LENGTHS_COUNT}",
    source=SOURCE,
    example={"of": HALF_SPACE, "s": [0, 0.1, 1]},
    of=True,
)
def path_length_transform(quantity: str | Callable[..., Reference], s: AxisArray, **arguments: Any) -> Reference:
    """Return the quantity with every path of length l inside the medium weighed by exp(-s l).

    quantity   a function of `fogproof.analytic` or its name: one with an albedo (slab, half space, ball, rod), or one along
               rays through a homogeneous medium
    s          (k,) or one number: >= 0, or negative as long as no more is lost to absorption than there is.
               Per mean free path where lengths are in mean free paths, else [1/m]
    arguments  of the quantity

    Shape: the quantity's, and behind it that of s. At s = 0 it is the quantity itself, and over that the transform of the law
    of l. A time gate or a transient renderer with speed v estimates it by the mean of w exp(-s v t).

    >>> from fogproof import analytic
    >>> late = analytic.path_length_transform("half_space_reflectance", [0, 0.1], albedo=1.0, mu0=0.5)
    >>> late.value.round(4).tolist()
    [1.0, 0.5256]
    """
    name, function = named(quantity)
    rates = as_float_array("s", s)
    lowest = -_least_absorption(name, arguments)
    require(
        "s", rates, (rates >= lowest) & np.isfinite(rates), f"must be finite and >= {lowest:.9g}, minus the absorption"
    )
    found = [_weighed(name, function, arguments, float(rate)) for rate in (rates.ravel() if rates.size else (0.0,))]
    value, error = (np.stack([getattr(x, what) for x in found], axis=-1) for what in ("value", "error"))
    end = value.shape[:-1] + rates.shape
    return Reference(
        value[..., : rates.size].reshape(end), error[..., : rates.size].reshape(end), found[0].method, SOURCE
    )


@declared(
    unit="m, or mean free paths",
    convention=LENGTHS_COUNT,
    source=SOURCE,
    example={"of": HALF_SPACE},
    of=True,
)
def path_length_mean(quantity: str | Callable[..., Reference], **arguments: Any) -> Reference:
    """Return the mean length inside the medium of the paths that a quantity counts; arguments as `path_length_transform`.

    In mean free paths or [m]. It is refused where it is infinite, as for a half space that absorbs nothing.

    >>> from fogproof import analytic
    >>> mean = analytic.path_length_mean("slab_diffuse_reflectance", albedo=0.9, tau=1.0)
    >>> (mean.value.round(6).tolist(), bool(mean.error < 1e-9))
    (1.671027, True)
    """
    whole, slope = _moments(*named(quantity), arguments, 1)
    return _quotient(slope, whole)


@declared(
    unit="m^2, or mean free paths^2",
    convention=LENGTHS_COUNT,
    source=SOURCE,
    example={"of": HALF_SPACE},
    of=True,
)
def path_length_variance(quantity: str | Callable[..., Reference], **arguments: Any) -> Reference:
    """Return the variance of the length inside the medium of the paths that a quantity counts, see `path_length_mean`."""
    whole, slope, bend = _moments(*named(quantity), arguments, 2)
    mean, square = _quotient(slope, whole), _quotient(bend, whole)
    value = square.value - mean.value**2
    error = square.error + (2 * np.abs(mean.value) + mean.error) * mean.error + 4 * EPS * square.value
    return Reference(value, error, PROVEN, SOURCE)


def _moments(name: str, function: Callable[..., Reference], arguments: Mapping[str, Any], most: int) -> list[Reference]:
    """Return the quantity times the moments 0 … most of the length."""

    def at(s: float) -> Reference:
        return _weighed(name, function, arguments, s)

    found = [at(0.0)]
    for order in range(1, most + 1):
        best = least_error(at, 0.0, _discs(name, function, arguments), order)
        if best is None:
            raise UnsupportedError(
                f"the mean path length of {name} is infinite, or nothing bounds it, where nothing is absorbed; "
                "path_length_transform answers for every s > 0",
                "albedo",
            )
        found.append(Reference((-1) ** order * best[0], best[1], PROVEN, SOURCE))
    return found


def _quotient(top: Reference, bottom: Reference) -> Reference:
    with np.errstate(invalid="ignore", divide="ignore"):
        value = top.value / bottom.value
        error = (top.error + np.abs(value) * bottom.error) / np.maximum(bottom.value - bottom.error, 0) + EPS * np.abs(
            value
        )
    if not np.all(bottom.value > bottom.error):
        raise UnsupportedError("no light follows such paths, which therefore have no mean length", "quantity")
    return Reference(value, error, PROVEN, SOURCE)


def _weighed(name: str, function: Callable[..., Reference], arguments: Mapping[str, Any], s: float) -> Reference:
    """Return the quantity with sigma_a raised by s."""
    if s == 0:
        return function(**arguments)
    if "albedo" not in arguments:
        return function(**_along_rays(name, arguments, s))
    albedo = np.asarray(arguments["albedo"], dtype=float)
    changed = {"albedo": np.minimum(albedo / (1 + s), 1.0)}
    changed |= {size: np.asarray(arguments[size], dtype=float) * (1 + s) for size in LENGTHS if size in arguments}
    found = function(**{**arguments, **changed})
    # Albedo and size are rounded. A power series with terms >= 0 is convex: its slope is at most that of the chord to 1.
    white = function(**{**arguments, **changed, "albedo": np.ones_like(albedo)})
    chord = np.abs(white.value - found.value) / np.maximum(1 - changed["albedo"], EPS)
    error = found.error + 4 * EPS * (changed["albedo"] * chord + np.abs(found.value) + np.abs(white.value))
    if name == "slab_emissivity":  # light starts inside: what is emitted stays the same
        scale = (1 - albedo) / (1 + s - albedo)
        return Reference(found.value * scale, error * scale * (1 + 8 * EPS), found.method, found.source)
    return Reference(found.value, error, found.method, found.source)


def _along_rays(name: str, arguments: Mapping[str, Any], s: float) -> dict[str, Any]:
    """Return the arguments with a medium that absorbs s more and emits the same."""
    scene = arguments.get("scene")
    medium = scene.medium if isinstance(scene, Scene) else arguments.get("medium")
    if not isinstance(medium, Medium):
        raise UnsupportedError(
            f"path lengths need a quantity with an albedo, or along rays through a homogeneous Medium; {name} has "
            f"{type(medium).__name__ if medium is not None else 'neither'}",
            "quantity",
        )
    raised = np.add(medium.sigma_a, s)
    emitted = np.multiply(medium.emission, medium.sigma_a)
    emission = np.divide(emitted, raised, out=np.zeros_like(emitted), where=raised > 0)
    changed = dataclasses.replace(medium, sigma_a=raised, emission=emission)  # type: ignore[arg-type]
    if isinstance(scene, Scene):
        return {**arguments, "scene": dataclasses.replace(scene, medium=changed)}
    return {**arguments, "medium": changed}


def _least_absorption(name: str, arguments: Mapping[str, Any]) -> float:
    if "albedo" in arguments:
        return 1 - float(np.max(np.asarray(arguments["albedo"], dtype=float), initial=0.0))
    scene = arguments.get("scene")
    medium = scene.medium if isinstance(scene, Scene) else arguments.get("medium")
    return float(np.min(medium.sigma_a)) if isinstance(medium, Medium) else 0.0


def _discs(name: str, function: Callable[..., Reference], arguments: Mapping[str, Any]) -> list[Iterator[Disc]]:
    """Return discs about s = 0: |exp(-z l)| <= exp(R l), so that the transform is bounded by itself at -R."""
    absorbed = _least_absorption(name, arguments)

    def less_absorption() -> Iterator[Disc]:
        for halving in range(HALVINGS if absorbed > 0 else 0):
            radius = min(absorbed, 0.9) * 0.5**halving if "albedo" in arguments else absorbed * 0.5**halving
            most = _weighed(name, function, arguments, -radius)
            yield Disc(radius, np.abs(most.value) + most.error, below=radius)

    def lets_out() -> Iterator[Disc]:
        chance = collides_again(name, arguments)
        if chance is None:
            return
        albedo = float(np.max(np.asarray(arguments["albedo"], dtype=float), initial=0.0))
        size = float(np.max(arguments["tau"] if "tau" in arguments else arguments["radius"]))
        for shrinking in range(1, 24):
            radius = 0.6**shrinking
            raised, again = albedo / (1 - radius), chance(size * radius)
            if raised * again < 1:
                yield Disc(radius, np.asarray(1 + raised / (1 - raised * again)), below=absorbed)

    return [less_absorption(), lets_out()]
