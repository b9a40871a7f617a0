<<<<<<< HEAD
"""The estimators a study can measure: how each is made for a scene, and what the oracle knows of its variance.

A method is a frozen dataclass whose fields are its options in the study file, with

    quantity    what it estimates; a scene takes the methods of its own quantity
    title       in words
    axis        what the study's sample counts are to it: "samples" of a random estimator, "steps" of a march that is not
                random, or "nothing" for an exact one
    expected    "rejected" for one that is biased by construction, and `reason` says why
    make        (scene, count) -> an `Estimator`
    variance    scene -> the exact variance of one realisation as a `Reference`, or None where the oracle has none
    dimensions  uniforms a realisation if it is a pure function of them, which then can be Sobol points; else None

To add one, write such a class and name it in `METHODS`; an estimator of one's own needs neither, see `own`.
"""
=======
"""The estimators a study can measure. To add one, write a class of `Method` and name it in `METHODS`."""
>>>>>>> main

from __future__ import annotations

from dataclasses import fields
from typing import Annotated, Any

from fogproof.scene.kinds import ByKind
from fogproof.study.methods.airlight import MarchedSingleScattering, MixedSingleScattering, SingleScattering
from fogproof.study.methods.fog import AnalogFogMethod, CertainCollision
<<<<<<< HEAD
from fogproof.study.methods.own import Own
=======
from fogproof.study.methods.method import Method
>>>>>>> main
from fogproof.study.methods.paths import PathTracing
from fogproof.study.methods.transmittance import (
    Analog,
    Delta,
    MarchedTransmittanceMethod,
    Ratio,
    Regular,
    ResidualRatio,
)

METHODS: dict[str, type[Method]] = {
    "regular": Regular,
    "analog": Analog,
    "delta": Delta,
    "ratio": Ratio,
    "residual-ratio": ResidualRatio,
    "march": MarchedTransmittanceMethod,
    "analog-fog": AnalogFogMethod,
    "certain-collision": CertainCollision,
    "airlight": SingleScattering,
    "mis": MixedSingleScattering,
    "marched-airlight": MarchedSingleScattering,
    "path-tracing": PathTracing,
}
"""The `kind` of each method in study files."""

OWN = "module:Estimator"
"""The `kind` that a study's normalised text gives to an estimator of one's own."""

MethodField = Annotated[Any, ByKind({**METHODS, OWN: Own})]


def kind_of(method: Any) -> str:
    """Return the `kind` of a method."""
    if isinstance(method, Own):
        return method.source
    return next(kind for kind, cls in METHODS.items() if type(method) is cls)


def options_of(method: Any) -> dict[str, Any]:
    """Return the options of a method that are not the defaults."""
    if isinstance(method, Own):
        return method.options
    return {f.name: getattr(method, f.name) for f in fields(method) if getattr(method, f.name) != f.default}


def name_of(method: Any) -> str:
    """Return how a method is called in tables: its kind and whatever is special about it."""
    options = ", ".join(f"{key} = {value}" for key, value in options_of(method).items())
    return f"{kind_of(method)} ({options})" if options else kind_of(method)
