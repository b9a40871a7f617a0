"""The oracle for programs in any language: JSON requests in, reference values with error bounds out.

A request is an object with the key `quantity` and the arguments of that function of `fogproof.analytic`:

    {"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": "inf", "phase": {"kind": "rayleigh"}}

Numbers may be nested lists, which broadcast. Numbers that JSON lacks are the strings "inf", "-inf" and "nan".
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from fogproof import analytic
from fogproof.analytic.airlight import Method
from fogproof.contracts import Reference
from fogproof.errors import FogproofError, InvalidInputError, shorten
from fogproof.scene import Isotropic, Medium, PointLight, Ray
from fogproof.scene.arrays import FloatArray
from fogproof.scene.complex_numbers import ComplexNumber
from fogproof.scene.files import input_model, read_fields
from fogproof.scene.media import MEDIA, AnyMediumField
from fogproof.scene.phase_functions import PHASE_FUNCTIONS, PhaseFunctionField
from fogproof.validate import Channels

PROTOCOL = "fogproof/oracle/1"
_FORWARD = "mu is the forward cosine: propagation direction in . propagation direction out"


@dataclass(frozen=True)
class Quantity:
    """A question the oracle answers: its function, its arguments (type, or (type, default)), unit and convention."""

    function: Callable[..., Reference]
    arguments: dict[str, Any]
    unit: str
    convention: str


@cache
def quantities() -> dict[str, Quantity]:
    """Return every quantity by name."""
    scene = {"medium": AnyMediumField, "ray": Ray}
    airlight = {"sigma_t": FloatArray, "h": FloatArray, "a": FloatArray, "b": FloatArray}
    phase = {"phase": PhaseFunctionField}
    how = {"method": (Method, "asinh")}
    radiance = "W/(m^2 sr)"
    return {
        "optical_thickness": Quantity(analytic.optical_thickness, scene, "1", "integral of sigma_t along the ray"),
        "transmittance": Quantity(
            analytic.transmittance, scene, "1", "fraction of the radiance that arrives: exp(-optical thickness)"
        ),
        "free_path": Quantity(
            analytic.free_path,
            {**scene, "tau": FloatArray},
            "m",
            "distance at which the optical thickness is tau; inf where the ray ends or escapes before",
        ),
        "ambient_fog": Quantity(
            analytic.ambient_fog,
            {**scene, "ambient": (Channels, 0.0), "background": (Channels, 0.0)},
            radiance,
            "in-scattered radiance constant along the ray; emission is multiplied by sigma_a",
        ),
        "emitted_radiance": Quantity(
            analytic.emitted_radiance,
            {**scene, "times_sigma_a": (bool, True)},
            radiance,
            "times_sigma_a: the medium's emission is L_e and is multiplied by sigma_a; otherwise it is a power per volume",
        ),
        "white_furnace": Quantity(
            analytic.white_furnace,
            {**scene, "radiance": (Channels, 1.0)},
            radiance,
            "albedo 1 in uniform light: nothing changes",
        ),
        "thermal_furnace": Quantity(
            analytic.thermal_furnace,
            {**scene, "radiance": (Channels, 1.0)},
            radiance,
            "emission equal to the surrounding radiance: nothing changes",
        ),
        "single_scattering": Quantity(
            analytic.single_scattering,
            {**scene, "light": PointLight, **how},
            radiance,
            "airlight alone, without the background; the light's intensity is in W/sr; " + _FORWARD,
        ),
        "airlight_integral": Quantity(
            analytic.airlight_integral,
            {**airlight, "phase": (PhaseFunctionField, Isotropic()), **how},
            "1/m",
            "integral over t in [a, b] of exp(-sigma_t ((t - a) + r)) / r^2 4 pi f_p(-t/r), r^2 = t^2 + h^2",
        ),
        "airlight_table": Quantity(
            analytic.airlight_table,
            {**airlight, "phase": (PhaseFunctionField, Isotropic()), **how},
            "1/m",
            "airlight_integral on the grid of h, a and b, in this order of axes",
        ),
        "phase_pdf": Quantity(analytic.phase_pdf, {**phase, "mu": FloatArray}, "1/sr", _FORWARD),
        "phase_cdf": Quantity(
            analytic.phase_cdf, {**phase, "mu": FloatArray}, "1", "probability that the cosine is <= mu; " + _FORWARD
        ),
        "phase_quantile": Quantity(
            analytic.phase_quantile,
            {**phase, "xi": FloatArray},
            "1",
            "the cosine below which a share xi is scattered; " + _FORWARD,
        ),
        "phase_mean_cosine": Quantity(analytic.phase_mean_cosine, phase, "1", "g, the mean of mu; " + _FORWARD),
        "rayleigh_scattering_coefficient": Quantity(
            analytic.rayleigh_scattering_coefficient,
            {
                "diameter": FloatArray,
                "refractive_index": ComplexNumber,
                "number_density": FloatArray,
                "wavelength": FloatArray,
            },
            "1/m",
            "lengths in m, number density in 1/m^3, refractive index and wavelength as the medium sees them",
        ),
    }


def schema() -> dict[str, Any]:
    """Return the JSON Schema of requests, with those of answers and failures under `$defs`."""
    from pydantic.json_schema import models_json_schema

    models = {
        name: input_model({"quantity": Literal[name], "id": (Any, None), **known.arguments})
        for name, known in quantities().items()
    }
    _, document = models_json_schema(
        [(model, "validation") for model in models.values()], ref_template="#/$defs/{model}"
    )
    definitions = document["$defs"]
    for kind, cls in {**PHASE_FUNCTIONS, **MEDIA}.items():  # the key that tells the types of a union apart
        if cls.__name__ in definitions:
            definition = definitions[cls.__name__]
            definition["properties"]["kind"] = {"const": kind}
            if cls is not Medium:  # a medium without a kind is homogeneous
                definition["required"] = ["kind", *definition.get("required", [])]
    numbers = {
        "description": "a number, nested lists of numbers, or the strings inf, -inf and nan for numbers that JSON lacks"
    }
    text = {"type": "string"}
    definitions["answer"] = {
        "type": "object",
        "required": ["protocol", "quantity", "value", "error", "unit", "convention", "method", "source"],
        "properties": {
            "protocol": {"const": PROTOCOL},
            "id": {},
            "quantity": {"enum": list(models)},
            "value": numbers,
            "error": numbers,
            "unit": text,
            "convention": text,
            "method": text,
            "source": text,
        },
    }
    definitions["failure"] = {
        "type": "object",
        "required": ["protocol", "error"],
        "properties": {
            "protocol": {"const": PROTOCOL},
            "id": {},
            "error": {
                "type": "object",
                "required": ["code", "message", "path"],
                "properties": dict.fromkeys(("code", "message", "path"), text),
            },
        },
    }
    references = [{"$ref": f"#/$defs/{model.__name__}"} for model in models.values()]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": PROTOCOL,
        "oneOf": references,
        "$defs": definitions,
    }


def answer(request: Any) -> dict[str, Any]:
    """Answer one request; raises `FogproofError` for a bad one. The value is not yet JSON-ready where it is infinite."""
    if not isinstance(request, dict):
        raise InvalidInputError(f"request: must be a JSON object, got {shorten(request)}")
    if "quantity" not in request:
        raise InvalidInputError(f"request: quantity is missing; known are {', '.join(quantities())}", "quantity")
    name = request["quantity"]
    known = quantities().get(name) if isinstance(name, str) else None
    if known is None:
        raise InvalidInputError(
            f"request: quantity {shorten(name)} is not known; known are {', '.join(quantities())}", "quantity"
        )
    arguments = {key: value for key, value in request.items() if key not in ("quantity", "id")}
    result = known.function(**read_fields(known.arguments, arguments, "request"))
    return {
        "protocol": PROTOCOL,
        **({"id": request["id"]} if "id" in request else {}),
        "quantity": name,
        "value": result.value,
        "error": result.error,
        "unit": known.unit,
        "convention": known.convention,
        "method": result.method,
        "source": result.source,
    }


def answer_text(text: str) -> dict[str, Any]:
    """Answer a request given as JSON text: the answer, or `{"error": {"code", "message", "path"}}`."""
    request: Any = None
    try:
        try:
            request = json.loads(text)
        except (json.JSONDecodeError, RecursionError) as error:
            raise InvalidInputError(f"request is not valid JSON: {error}") from None
        return answer(request)
    except FogproofError as error:
        named = {"id": request["id"]} if isinstance(request, dict) and "id" in request else {}
        return {"protocol": PROTOCOL, **named, "error": error.to_dict()}
