"""`plan`: which terms of the volume rendering equation a scene needs, which solver and estimator serve it, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.scene import Scene


@dataclass(frozen=True)
class Term:
    """One term of the volume rendering equation, kept or dropped, and why."""

    name: str
    kept: bool
    why: str


@dataclass(frozen=True)
class Plan:
    """The terms of a scene, the oracle's function that solves it, and the estimator that serves it ("" if none is needed)."""

    terms: tuple[Term, ...]
    solver: str
    estimator: str
    why: str

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON-ready form."""
        terms = [{"name": term.name, "kept": term.kept, "why": term.why} for term in self.terms]
        return {"terms": terms, "solver": self.solver, "estimator": self.estimator, "why": self.why}

    def __str__(self) -> str:
        width = max(len(term.name) for term in self.terms)
        lines = [f"{'keep' if term.kept else 'drop'}  {term.name:{width}}  {term.why}" for term in self.terms]
        return "\n".join(
            [*lines, f"solver     {self.solver}", f"estimator  {self.estimator or 'none'}", f"           {self.why}"]
        )


def plan(scene: Scene) -> Plan:
    """Return the cheapest exact treatment of a scene."""
    medium = scene.medium
    absorbs, scatters = bool(np.any(medium.sigma_a)), bool(np.any(medium.sigma_s))
    empty = not (absorbs or scatters)
    background = bool(np.any(scene.background))
    reaches = bool(np.any(np.isfinite(scene.ray.length))) or not np.all(medium.sigma_t > 0)
    emits = bool(np.any(np.multiply(medium.sigma_a, medium.emission)))
    light = (
        scene.scattering == "single" and scene.light is not None and bool(np.any(scene.light.intensity)) and scatters
    )
    ambient = scene.scattering == "ambient" and bool(np.any(scene.ambient)) and scatters
    terms = (
        Term(
            "attenuation", not empty, "sigma_t = 0: T = 1" if empty else "homogeneous: T = exp(-sigma_t s), no tracking"
        ),
        Term("background", background and reaches, _background(background, reaches)),
        Term("emission", emits, "sigma_a L_e > 0" if emits else "sigma_a L_e = 0"),
        Term("in-scattering", light or ambient, _in_scattering(scene, scatters, light, ambient)),
        Term("colour", *_colour(scene)),
    )
    if light:
        return Plan(
            terms,
            "single_scattering",
            "EquiangularAirlight",
            "the airlight integral has no elementary form but converges fast after t = h sinh s; equiangular sampling cancels"
            " the light's 1/r^2",
        )
    if emits or ambient:
        return Plan(
            terms,
            "ambient_fog",
            "AnalogFog",
            "constant sources in a homogeneous medium: the closed lerp, no integral is left",
        )
    if not empty:
        return Plan(
            terms, "transmittance", "AnalogTransmittance", "nothing is gained along the ray: the background times T"
        )
    return Plan(terms, "the background itself", "", "an empty medium changes nothing: no random numbers at all")


def _background(background: bool, reaches: bool) -> str:
    if not background:
        return "its radiance is 0"
    return "attenuated by T" if reaches else "no ray that ends is given: T = 0"


def _in_scattering(scene: Scene, scatters: bool, light: bool, ambient: bool) -> str:
    if not scatters:
        return "sigma_s = 0"
    if scene.scattering == "none":
        return "scattering = 'none'"
    if light:
        return f"one bounce from the light, phase function {type(scene.medium.phase).__name__}"
    if ambient:
        return "constant in-scattered radiance: the phase function integrates to 1 and drops out"
    return "the light has intensity 0" if scene.scattering == "single" else "the ambient radiance is 0"


def _colour(scene: Scene) -> tuple[bool, str]:
    light = scene.light.intensity if scene.light else 0.0
    values = [scene.medium.sigma_a, scene.medium.sigma_s, scene.medium.emission, scene.ambient, scene.background, light]
    counts = {len(value) for value in values if isinstance(value, tuple)}
    if not counts:
        return False, "grey: one channel"
    return True, f"{counts.pop()} channels"
