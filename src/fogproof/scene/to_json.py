"""Scenes as JSON, every key written out: what programs of other people read without knowing defaults."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene.kinds import kinds_of

ROOMS = ("cameras", "lights", "media", "occluders", "phase", "shapes", "surfaces")


def to_json(thing: Any) -> Any:
    """Return a scene or a part of it as JSON-ready tables; infinity is the string "inf"."""
    if is_dataclass(thing) and not isinstance(thing, type):
        kind = _kinds().get(type(thing))
        table = {field.name: to_json(getattr(thing, field.name)) for field in fields(thing) if field.init}
        return table if kind is None else {"kind": kind, **table}
    if isinstance(thing, np.ndarray | np.generic):
        return to_json(thing.tolist())
    if isinstance(thing, list | tuple):
        return [to_json(item) for item in thing]
    if isinstance(thing, dict):
        return {str(key): to_json(value) for key, value in thing.items()}
    if isinstance(thing, float) and math.isinf(thing):
        return "inf" if thing > 0 else "-inf"
    if thing is None or isinstance(thing, bool | int | float | str):
        return thing
    raise UnsupportedError(f"a {type(thing).__name__} cannot be written as JSON", "scene")


@cache
def _kinds() -> dict[type, str]:
    return {cls: kind for room in ROOMS for kind, cls in _table(room).items()}


def _table(room: str) -> dict[str, type]:
    try:
        return kinds_of(f"fogproof.scene.{room}")
    except AttributeError:  # a room without kinds
        return {}
