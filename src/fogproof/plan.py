"""`plan`: which terms of the volume rendering equation a scene needs, which solver and estimator serve it, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.capabilities import capabilities, emits, is_lit, is_too_far, scatters
from fogproof.scene import AnyMedium, Ray, Scene
from fogproof.scene.media import is_empty


@dataclass(frozen=True)
class Term:
    """One term of the volume rendering equation, kept or dropped, and why."""

    name: str
    kept: bool
    why: str


@dataclass(frozen=True)
class Plan:
    """The terms of a scene, the oracle's function that solves it, and the estimator that serves it ("" if none is needed).

    refused  why neither follows the scene, "" if they do; see `fogproof.capabilities`
    """

    terms: tuple[Term, ...]
    solver: str
    estimator: str
    why: str
    refused: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON-ready form."""
        terms = [{"name": term.name, "kept": term.kept, "why": term.why} for term in self.terms]
        return {"terms": terms, "solver": self.solver, "estimator": self.estimator, "why": self.why} | (
            {"refused": self.refused} if self.refused else {}
        )

    def __str__(self) -> str:
        width = max(len(term.name) for term in self.terms)
        lines = [f"{'keep' if term.kept else 'drop'}  {term.name:{width}}  {term.why}" for term in self.terms]
        solved = [
            f"solver     {self.solver or 'none'}",
            f"estimator  {self.estimator or 'none'}",
            f"           {self.why}",
        ]
        return "\n".join(lines + solved)


def plan(scene: Scene) -> Plan:
    """Return the cheapest exact or unbiased treatment of a scene, or what stands in its way."""
    medium, how = scene.medium, capabilities(scene)
    present, lit, glows = not is_empty(medium), is_lit(scene), emits(medium)
    ambient = scene.scattering == "ambient" and bool(np.any(scene.ambient)) and scatters(medium)
    background = bool(np.any(scene.background))
    terms = (
        Term("attenuation", present, _ATTENUATION[how.camera_rays] if present else "sigma_t = 0: T = 1"),
        Term("background", background, "attenuated by T" if background else "its radiance is 0"),
        Term("emission", glows, "sigma_a L_e > 0" if glows else "sigma_a L_e = 0"),
        Term("in-scattering", lit or ambient, _in_scattering(scene, lit, ambient)),
        Term("colour", *_colour(scene)),
    )
    through = _THROUGH[how.camera_rays]
    if how.refused:
        return Plan(terms, "", "", f"refused: {how.refused}", how.refused)
    if lit and how.placing == "equiangular":
        integral = (
            "the airlight integral has no elementary form but converges fast after t = h sinh s"
            if how.uniform and scene.light is not None and scene.light.delta
            else "nested adaptive quadrature, the transmittance of both legs by the medium's own rule"
        )
        why = f"{integral}; equiangular sampling about the light cancels its 1/r^2"
        return Plan(terms, "single_scattering", f"Airlight, placing 'equiangular'; {through}", why)
    if lit:
        why = "parallel light: no 1/r^2 is in the way, the event goes where the medium is"
        return Plan(terms, "single_scattering", f"Airlight, placing '{how.placing}'; {through}", why)
    if (glows or ambient) and how.sources == "collision":
        why = "sources that vary along the ray: a path that collides looks them up"
        return Plan(terms, "ambient_fog", "delta tracking to one collision", why)
    if glows or ambient:
        what = "the closed lerp, no integral is left" if how.uniform else "a lerp over the optical thickness"
        why = f"sources that are constant along the ray: {what}"
        return Plan(terms, "ambient_fog", f"the same lerp; {through}", why)
    if present:
        why = "nothing is gained along the ray: the background times T"
        return Plan(terms, "transmittance", f"background x T; {through}", why)
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


_ATTENUATION = {
    "closed": "the optical thickness has a closed form: no tracking",
    "cells": "cells: a sum over those crossed, exact in each",
    "ratio": "no closed form: tracking under a majorant",
}
_THROUGH = {"closed": "T in closed form", "cells": "T by regular tracking", "ratio": "T by ratio tracking"}
"""How `fogproof.scene_estimator` finds the transmittance."""


def _in_scattering(scene: Scene, light: bool, ambient: bool) -> str:
    if not scatters(scene.medium):
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
    return "no light arrives from infinitely far" if is_too_far(scene) else "the light is off"


def _colour(scene: Scene) -> tuple[bool, str]:
    return (True, f"{scene.channels} channels") if scene.channels else (False, "grey: one channel")
