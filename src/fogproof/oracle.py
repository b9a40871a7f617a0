"""The oracle for programs in any language: JSON requests in, reference values with error bounds out.

A request is an object with the key `quantity` and the arguments of that function of `fogproof.analytic`:

    {"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": "inf", "phase": {"kind": "rayleigh"}}

Numbers may be nested lists, which broadcast. Numbers that JSON lacks are the strings "inf", "-inf" and "nan".
"""

from __future__ import annotations

import json
from typing import Any, Literal

from fogproof.errors import FogproofError, InvalidInputError, UnsupportedError, shorten
from fogproof.quantities import quantities
from fogproof.scene import Medium
from fogproof.scene.files import input_model, read_fields
from fogproof.scene.lights import KINDS as LIGHTS
from fogproof.scene.lights import PointLight
from fogproof.scene.media import MEDIA
from fogproof.scene.occluders import KINDS as OCCLUDERS
from fogproof.scene.phase import KINDS as PHASE_FUNCTIONS
from fogproof.scene.shapes import KINDS as SHAPES

PROTOCOL = "fogproof/oracle/1"


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
    for kind, cls in {
        **PHASE_FUNCTIONS,
        **MEDIA,
        **LIGHTS,
        **OCCLUDERS,
        **SHAPES,
    }.items():  # the key that tells the types of a union apart
        if cls.__name__ in definitions:
            definition = definitions[cls.__name__]
            definition["properties"]["kind"] = {"const": kind}
            if cls not in (Medium, PointLight):  # without a kind a medium is homogeneous, and a light a point
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


def answer(request: Any, rigorous: bool = False) -> dict[str, Any]:
    """Answer one request; raises `FogproofError` for a bad one. The value is not yet JSON-ready where it is infinite.

    rigorous  answer with an enclosure proven by ball arithmetic, whatever the request says
    """
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
    if rigorous:
        if "rigorous" not in known.arguments:
            proven = [name for name, quantity in quantities().items() if "rigorous" in quantity.arguments]
            raise UnsupportedError(f"{name} has no proven enclosure; {', '.join(proven)} have", "quantity")
        arguments["rigorous"] = True
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


def answer_text(text: str, rigorous: bool = False) -> dict[str, Any]:
    """Answer a request given as JSON text: the answer, or `{"error": {"code", "message", "path"}}`."""
    request: Any = None
    try:
        try:
            request = json.loads(text)
        except (json.JSONDecodeError, RecursionError) as error:
            raise InvalidInputError(f"request is not valid JSON: {error}") from None
        return answer(request, rigorous)
    except FogproofError as error:
        named = {"id": request["id"]} if isinstance(request, dict) and "id" in request else {}
        return {"protocol": PROTOCOL, **named, "error": error.to_dict()}
