"""The estimators a study can measure. To add one, write a class of `Method` and name it in `METHODS`; for one's own see `own`."""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated, Any

from fogproof.scene.kinds import ByKind
from fogproof.study.methods.airlight import MarchedSingleScattering, MixedSingleScattering, SingleScattering
from fogproof.study.methods.fog import AnalogFogMethod, CertainCollision
from fogproof.study.methods.method import Method
from fogproof.study.methods.own import Own
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
