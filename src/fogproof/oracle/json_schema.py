"""The JSON Schema of the oracle's requests, answers and failures, made from what the quantities declare."""

from __future__ import annotations

from typing import Any, Literal

from fogproof.oracle.answers import PROTOCOL
from fogproof.quantities import quantities
from fogproof.scene.files import input_model
from fogproof.scene.kinds import name_kinds


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
    name_kinds(document, definitions)
    for name, known in quantities().items():
        request = definitions[models[name].__name__]
        request["description"] = f"{known.summary} [{known.unit}] {known.convention}. Source: {known.source}."
        request["examples"] = [{"quantity": name, **known.example}]
        for argument, meaning in known.meanings.items():
            request["properties"][argument]["description"] = meaning
    numbers = {
        "description": "a number, nested lists of numbers, or the strings inf and -inf for numbers that JSON lacks"
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
