"""Settings moved, turned and scaled. What a field is, its name says: the scene uses one name for one thing."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.relations.setting import PathSetting
from fogproof.scene import Ray

POINTS = frozenset({"position", "center", "centers", "point", "corner", "lower", "upper"})
DIRECTIONS = frozenset({"direction", "normal", "axis"})
VECTORS = frozenset({"edge_u", "edge_v"})
LENGTHS = frozenset({"radius", "thickness", "width", "widths", "boundaries", "detail"})
PER_LENGTH = frozenset({"sigma_a", "sigma_s", "sigma_t", "densities", "majorant"})
POWERS = frozenset({"intensity"})
"""[W/sr]: the same irradiance at k times the distance takes k^2 of it."""

Change = Callable[[str, np.ndarray], np.ndarray]
"""(what a field is: "point", "direction", "vector", "length", "per_length" or "power", its value) -> what becomes of it."""


def scaled(setting: PathSetting, factor: float) -> PathSetting:
    """Return the setting with all lengths times a factor and all coefficients over it: the same radiance."""

    def change(what: str, value: np.ndarray) -> np.ndarray:
        power = {"point": 1, "vector": 1, "length": 1, "per_length": -1, "power": 2}.get(what, 0)
        return np.asarray(value * float(factor) ** power)

    return _changed(setting, change)


def translated(setting: PathSetting, by: tuple[float, float, float]) -> PathSetting:
    """Return the setting moved as a whole; layers move along their axis."""
    step = np.asarray(by)

    def change(what: str, value: np.ndarray) -> np.ndarray:
        return value + step if what == "point" else value

    moved = _changed(setting, change)
    medium: Any = moved.medium
    if hasattr(medium, "boundaries"):
        medium = dataclasses.replace(medium, boundaries=medium.boundaries + float(medium.axis @ step))
    return moved.but(medium=medium)


def turned(setting: PathSetting) -> PathSetting:
    """Return the setting with its axes renamed, x to y to z to x, which is a proper rotation that keeps boxes boxes."""

    def change(what: str, value: np.ndarray) -> np.ndarray:
        return np.roll(value, 1, axis=-1) if what in ("point", "direction", "vector") else value

    rotated = _changed(setting, change)
    medium: Any = rotated.medium
    if hasattr(medium, "lower") and hasattr(medium, "sigma_t"):
        arrays = {
            name: np.moveaxis(array, 2, 0)
            for name in ("sigma_t", "albedo", "emission")
            if (array := np.asarray(getattr(medium, name))).ndim >= 3
        }
        medium = dataclasses.replace(medium, **arrays)
    return rotated.but(medium=medium)


def _changed(setting: PathSetting, change: Change) -> PathSetting:
    ray = Ray(
        change("point", setting.ray.origin),
        change("direction", setting.ray.direction),
        change("length", setting.ray.length),
    )
    parts = {name: _part(getattr(setting, name), change) for name in ("medium", "shape", "light", "surface")}
    majorant = None if setting.majorant is None else float(change("per_length", np.asarray(setting.majorant)))
    return setting.but(ray=ray, majorant=majorant, **parts)


def _part(thing: Any, change: Change) -> Any:
    if thing is None or not dataclasses.is_dataclass(thing) or isinstance(thing, type):
        return thing
    changes: dict[str, Any] = {}
    for field in dataclasses.fields(thing):
        if field.name == "phase":
            continue  # of angles alone
        value = getattr(thing, field.name)
        if callable(value):
            raise UnsupportedError(f"{type(thing).__name__} is a function of place, which cannot be moved", "medium")
        what = _what(field.name)
        if dataclasses.is_dataclass(value):
            changes[field.name] = _part(value, change)
        elif what:
            found = change(what, np.asarray(value, dtype=float))
            changes[field.name] = (
                tuple(found.tolist()) if isinstance(value, tuple) else float(found) if found.ndim == 0 else found
            )
    return dataclasses.replace(thing, **changes)


def _what(name: str) -> str:
    names = {
        "point": POINTS,
        "direction": DIRECTIONS,
        "vector": VECTORS,
        "length": LENGTHS,
        "per_length": PER_LENGTH,
        "power": POWERS,
    }
    return next((what for what, those in names.items() if name in those), "")
