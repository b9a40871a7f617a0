"""Scenes and requests from TOML and JSON: pydantic checks the structure, the dataclasses check the values.

`inf` is a TOML number; JSON has none, so the strings "inf" and "-inf" stand for it there.
"""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.errors import FogproofError, InvalidInputError, InvalidValueError, shorten
from fogproof.input_files import parse_json, read_text, read_toml
from fogproof.scene.image_scenes import ImageScene
from fogproof.scene.known_keys import known_keys
from fogproof.scene.scenes import Scene


def read_scene(path: str | Path) -> Scene:
    """Read a scene from a TOML file. Every fault is a `FogproofError` that names the file and the key."""
    scene: Scene = read_fields({"scene": Scene}, {"scene": _table(Path(path))}, str(path))["scene"]
    return scene


def read_image_scene(path: str | Path) -> ImageScene:
    """Read a scene with a camera from a TOML or JSON file. Every fault is a `FogproofError` that names the file and the key."""
    table = _table(Path(path))
    if "camera" not in table:
        fix = "add a [camera] table: kind, origin, target, film = { width, height }"
        raise InvalidInputError(f"{path}: camera is missing; {fix}", "camera")
    scene: ImageScene = read_fields({"scene": ImageScene}, {"scene": table}, str(path))["scene"]
    return scene


def read_image_scenes(paths: Iterable[str | Path]) -> list[ImageScene]:
    """Read scenes with cameras; the faults of all files are told in one `InvalidInputError`, before anything is done with one."""
    scenes, faults = [], []
    for path in paths:
        try:
            scenes.append(read_image_scene(path))
        except FogproofError as error:
            faults.append(str(error))
    if faults:
        raise InvalidInputError("\n".join(faults), "scene")
    return scenes


def _table(path: Path) -> dict[str, Any]:
    if path.suffix == ".json":
        try:
            table = parse_json(read_text(path, "the scene file"))
        except (ValueError, RecursionError) as error:
            raise InvalidInputError(f"{path} is not valid JSON: {error}", str(path)) from None
        if not isinstance(table, dict):
            raise InvalidInputError(f"{path}: must be a table of keys, got {shorten(table)}", str(path))
        return table
    table = read_toml(path, "the scene file")
    if isinstance(table.get("scenes"), list):
        raise InvalidInputError(f"{path} is a study, not a scene: `fogproof study {path} -o DIR` runs it", "scenes")
    return table


def read_fields(types: dict[str, Any], data: Any, origin: str) -> dict[str, Any]:
    """Return `data` with each key built as its type in `types`; all keys of plain types are required.

    types   name -> a type, or (type, default)
    data    a mapping from a JSON or TOML parser
    origin  where it came from, for messages
    """
    import pydantic

    if not isinstance(data, dict):
        raise InvalidInputError(f"{origin}: must be a table of keys, got {shorten(data)}")
    try:
        with np.errstate(all="ignore"):  # a length that overflows is judged as the infinity that it is
            model = input_model(types).model_validate_json(json.dumps(_with_infinities(data)))
    except pydantic.ValidationError as error:
        raise _complaint(error, data, origin, types) from None
    return {name: getattr(model, name) for name in types}


def input_model(types: dict[str, Any]) -> Any:
    """Return the pydantic model of an object with these keys; see `read_fields`."""
    return _model(tuple(types.items()))


@cache
def _model(types: tuple[tuple[str, Any], ...]) -> Any:
    import pydantic

    fields: dict[str, Any] = {name: kind if isinstance(kind, tuple) else (kind, ...) for name, kind in types}
    name = "".join(
        str(part).title().replace("_", "") for part in getattr(fields.get("quantity", ("",))[0], "__args__", ("Input",))
    )
    return pydantic.create_model(name, __config__=pydantic.ConfigDict(extra="forbid", strict=True), **fields)


@cache
def _schema(types: tuple[tuple[str, Any], ...]) -> dict[str, Any]:
    schema: dict[str, Any] = _model(types).model_json_schema()
    return schema


def _with_infinities(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _with_infinities(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_with_infinities(item) for item in value]
    return {"inf": math.inf, "-inf": -math.inf}.get(value, value) if isinstance(value, str) else value


_UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")
_RULES = {
    "tuple_type": "must be a list",
    "list_type": "must be a list",
    "int_type": "must be a whole number",
    "float_type": "must be a number",
    "string_type": "must be a text",
    "bool_type": "must be true or false",
}


def _complaint(error: Any, data: Any, origin: str, types: dict[str, Any]) -> InvalidInputError | InvalidValueError:
    """Turn pydantic's report into one sentence; the first fault is told, the others are counted."""
    faults = {_place(fault, data): fault for fault in reversed(error.errors())}
    place, fault = min(reversed(faults.items()), key=lambda item: item[1]["type"] not in _UNKNOWN)
    others = [other for other in reversed(faults) if other != place]
    beside = place.rpartition(".")[0]
    absent = [other for other in others if other.rpartition(".")[0] == beside and "missing" in faults[other]["type"]]
    if fault["type"] in _UNKNOWN and absent:  # what is missing beside a key that nobody knows is what was meant
        others = [other for other in others if other not in absent]
        more = f", and {', '.join(absent)} {'is' if len(absent) == 1 else 'are'} missing"
    elif "missing" in fault["type"] and absent:
        others = [other for other in others if other not in absent]
        more = f", {', '.join(absent)} too"
    else:
        meant = _meant(place, data, types) if fault["type"] in _UNKNOWN else ""
        more = f"; did you mean {meant}?" if meant else ""
    more += f" (and {len(others)} more)" if others else ""
    cause = fault.get("ctx", {}).get("error")
    if isinstance(cause, InvalidValueError):
        return cause.inside(place, origin)
    reasons = {
        "extra_forbidden": "is not a known key",
        "unexpected_keyword_argument": "is not a known key",
        "missing": "is missing",
        "missing_argument": "is missing",
        "union_tag_not_found": "needs a key 'kind'",
    }
    if fault["type"] == "union_tag_invalid":
        reason = f"has kind {shorten(fault['ctx']['tag'])}; known are {fault['ctx']['expected_tags']}"
    else:
        rule = _RULES.get(fault["type"], _lower(fault["msg"]).replace("input should be", "must be", 1))
        reason = reasons.get(fault["type"], f"{rule}, got {shorten(fault['input'])}")
    return InvalidInputError(f"{origin}: {place} {reason}{more}", place)


def _meant(place: str, data: Any, types: dict[str, Any]) -> str:
    """Return the key of the same table that an unknown one resembles, "" if none does."""
    *way, wrong = place.split(".")
    try:
        keys = known_keys(_schema(tuple(types.items())), data, way) if way else list(types)
    except (KeyError, ValueError, IndexError):  # a key with a dot in it
        return ""
    return next(iter(difflib.get_close_matches(wrong, keys, 1)), "")


def _place(fault: Any, data: Any) -> str:
    """Return the path of a fault as the user wrote it, without the names of types that pydantic puts in between."""
    parts: list[str] = []
    absent_key = fault["type"].startswith("missing")
    for step, part in enumerate(fault["loc"]):
        present = part in data if isinstance(data, dict) else isinstance(data, list) and part in range(len(data))
        if present:
            data = data[part]
        elif not (absent_key and step == len(fault["loc"]) - 1):
            continue
        parts.append(str(part))
    return ".".join(parts)


def _lower(text: str) -> str:
    return text[:1].lower() + text[1:]
