"""`plan`: which terms of the volume rendering equation a scene needs, which solver and estimator serve it, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.scene import (
    AnisotropicMedium,
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    Scene,
    VoxelGrid,
)
from fogproof.scene.lights import strength


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
        solved = [f"solver     {self.solver}", f"estimator  {self.estimator or 'none'}", f"           {self.why}"]
        return "\n".join(lines + solved)


def plan(scene: Scene) -> Plan:
    """Return the cheapest exact or unbiased treatment of a scene."""
    medium = scene.medium
    tracking = _TRACKING[type(medium)]
    empty = not _present(medium)
    scatters, absorbs = not empty and _any(_scattering(medium)), not empty and _any(_absorption(medium))
    emits = absorbs and _any(medium.emission)
    background = _any(scene.background)
    light = scene.scattering == "single" and scene.light is not None and _any(strength(scene.light)) and scatters
    light = light and not _too_far(scene)
    ambient = scene.scattering == "ambient" and _any(scene.ambient) and scatters
    terms = (
        Term("attenuation", not empty, "sigma_t = 0: T = 1" if empty else tracking),
        Term("background", background, "attenuated by T" if background else "its radiance is 0"),
        Term("emission", emits, "sigma_a L_e > 0" if emits else "sigma_a L_e = 0"),
        Term("in-scattering", light or ambient, _in_scattering(scene, scatters, light, ambient)),
        Term("colour", *_colour(scene)),
    )
    homogeneous = isinstance(medium, Medium)
    if light and scene.light is not None and not scene.light.distant:
        integral = (
            "the airlight integral has no elementary form but converges fast after t = h sinh s"
            if homogeneous and scene.light.delta
            else "nested adaptive quadrature, the transmittance of both legs by the medium's own rule"
        )
        why = f"{integral}; equiangular sampling about the light cancels its 1/r^2"
        return Plan(terms, "single_scattering", f"Airlight, placing 'equiangular'; {_THROUGH[type(medium)]}", why)
    if light:
        why = "parallel light: no 1/r^2 is in the way, the event goes where the medium is"
        return Plan(terms, "single_scattering", f"Airlight, placed in the medium; {_THROUGH[type(medium)]}", why)
    if emits or ambient:
        varying = isinstance(medium, Procedural) and (callable(medium.albedo) or callable(medium.emission))
        if varying:
            why = "sources that vary along the ray: a path that collides looks them up"
            return Plan(terms, "radiance_by_quadrature", "delta tracking to one collision", why)
        what = (
            "the closed lerp, no integral is left" if homogeneous else "a lerp over the optical thickness, cell by cell"
        )
        why = f"sources that are constant along the ray: {what}"
        return Plan(terms, "ambient_fog", f"the same lerp; {_THROUGH[type(medium)]}", why)
    if not empty:
        why = "nothing is gained along the ray: the background times T"
        return Plan(terms, "transmittance", f"background x T; {_THROUGH[type(medium)]}", why)
    return Plan(terms, "the background itself", "", "an empty medium changes nothing: no random numbers at all")


def scene_of(subject: Any) -> Scene | None:
    """Return the scene that an estimator or sampler is about; None if it is about none (a phase function, say)."""
    medium, ray = (getattr(subject, name, None) for name in ("medium", "ray"))
    if not isinstance(medium, AnyMedium) or not isinstance(ray, Ray):
        return None
    light = getattr(subject, "light", None)
    ambient = getattr(subject, "ambient", 0.0)
    return Scene(
        medium,
        ray,
        "single" if light is not None else "ambient" if np.any(ambient) else "none",
        light,
        getattr(subject, "occluders", ()),
        ambient,
        getattr(subject, "background", 0.0),
    )


_TRACKING: dict[type, str] = {
    Medium: "homogeneous: T = exp(-sigma_t s), no tracking",
    AnisotropicMedium: "constant along each ray: T = exp(-sigma_t(w) s), no tracking",
    LinearMedium: "linear extinction: closed form, no tracking",
    ExponentialMedium: "exponential extinction: closed form, no tracking",
    OpenGLFog: "a function of the distance from the eye: closed form, no tracking",
    PiecewiseConstantMedium: "layers: a sum over their boundaries",
    VoxelGrid: "voxels: a sum over the crossed cells, exact in each",
    Procedural: "a user's function: tracking under its majorant",
}
_CLOSED = "T in closed form"
_THROUGH: dict[type, str] = {
    Medium: _CLOSED,
    AnisotropicMedium: _CLOSED,
    LinearMedium: _CLOSED,
    ExponentialMedium: _CLOSED,
    OpenGLFog: _CLOSED,
    PiecewiseConstantMedium: "T layer by layer",
    VoxelGrid: "T by regular tracking",
    Procedural: "T by ratio tracking",
}
"""How `fogproof.scene_estimator` finds the transmittance."""


def _any(value: Any) -> bool:
    """Return whether a coefficient is anywhere above 0; a function is taken to be."""
    return callable(value) or bool(np.any(value))


def _present(medium: AnyMedium) -> bool:
    match medium:
        case Medium() | PiecewiseConstantMedium() | VoxelGrid():
            return bool(np.any(medium.sigma_t))
        case LinearMedium():
            return bool(np.any(np.greater(medium.sigma_0, 0))) or bool(np.any(medium.gradient))
        case ExponentialMedium():
            return bool(np.any(medium.sigma_0))
        case AnisotropicMedium():
            return bool(np.any(medium.sigma)) and bool(np.any(medium.S))
        case OpenGLFog(mode="linear"):
            return True
        case OpenGLFog():
            return bool(medium.density)
    return True


def _too_far(scene: Scene) -> bool:
    """Return whether light from infinitely far would have to cross an endless medium."""
    return scene.light is not None and scene.light.distant and isinstance(scene.medium, Medium)


def _scattering(medium: AnyMedium) -> Any:
    return medium.sigma_s if isinstance(medium, Medium) else medium.albedo


def _absorption(medium: AnyMedium) -> Any:
    if isinstance(medium, Medium):
        return medium.sigma_a
    return medium.albedo if callable(medium.albedo) else np.subtract(1.0, medium.albedo)


def _in_scattering(scene: Scene, scatters: bool, light: bool, ambient: bool) -> str:
    if not scatters:
        return "sigma_s = 0"
    if scene.scattering == "none":
        return "scattering = 'none'"
    if light:
        shadows = f", shadows of {len(scene.occluders)} occluders" if scene.occluders else ""
        return f"one bounce from the {type(scene.light).__name__}, phase function {type(scene.medium.phase).__name__}{shadows}"
    if ambient:
        return "constant in-scattered radiance: the phase function integrates to 1 and drops out"
    if scene.scattering == "ambient":
        return "the ambient radiance is 0"
    return "no light arrives from infinitely far" if _too_far(scene) else "the light is off"


def _colour(scene: Scene) -> tuple[bool, str]:
    return (True, f"{scene.channels} channels") if scene.channels else (False, "grey: one channel")
