"""Settings moved, turned, mirrored, scaled, brightened. What a field is, its name says: the scene uses one name for one thing."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from fogproof.errors import UnsupportedError

FIELDS = {
    "point": "position center centers point corner lower upper origin target start end",
    "direction": "direction normal axis up",
    "vector": "edge_u edge_v",
    "length": "radius thickness width widths boundaries detail length wall",
    "per_length": "sigma_a sigma_s sigma_t sigma_0 densities majorant",
    "rate": "rate",
    "gradient": "gradient",
    "power": "intensity",
    "brightness": "irradiance radiance emission ambient background",
    "": "albedo film purpose scattering interpolation fov fov_axis half_angle falloff_start exponent profile finish channels"
    " light_sampling deepest only integrator threads more copy",
}
"""What the fields are that carry a name; "" are those that neither place nor unit of length changes. Others are refused."""

PHASES = ("phase", "first", "second")
"""Of angles alone, unless one varies in space."""

WHAT = {name: what for what, names in FIELDS.items() for name in names.split()}

POWERS = {"point": 1, "vector": 1, "length": 1, "per_length": -1, "rate": -1, "gradient": -2, "power": 2}
"""Of the unit of length; of an intensity [W/sr] because the same irradiance at k times the distance takes k^2 of it."""

ORIENTED = ("point", "direction", "vector", "rate", "gradient")

Change = Callable[[str, np.ndarray], np.ndarray]
"""(what a field is, its value) -> what becomes of it."""

Setting = TypeVar("Setting")
"""A dataclass of dataclasses: what a renderer is asked for."""


def scaled(setting: Setting, factor: float) -> Setting:
    """Return the setting with all lengths times a factor and all coefficients over it: the same radiance."""
    return changed(setting, lambda what, value: value * float(factor) ** POWERS.get(what, 0))


def brightened(setting: Setting, factor: float) -> Setting:
    """Return the setting with everything that shines times a factor: as many times the radiance."""
    return changed(setting, lambda what, value: value * factor if what in ("power", "brightness") else value)


def translated(setting: Setting, by: tuple[float, float, float]) -> Setting:
    """Return the setting moved as a whole; layers move along their axis, and what counts from 0 starts elsewhere."""
    step = np.asarray(by)
    moved: Any = changed(setting, lambda what, value: value + step if what == "point" else value)
    medium: Any = moved.medium
    if hasattr(medium, "boundaries"):
        medium = dataclasses.replace(medium, boundaries=medium.boundaries + float(medium.axis @ step))
    elif hasattr(medium, "gradient"):
        medium = dataclasses.replace(medium, sigma_0=_plain(medium.sigma_0 - medium.gradient @ step))
    elif hasattr(medium, "rate"):
        medium = dataclasses.replace(medium, sigma_0=_plain(medium.sigma_0 * np.exp(-(medium.rate @ step))))
    result: Setting = moved.but(medium=medium)
    return result


def turned(setting: Setting) -> Setting:
    """Return the setting with its axes renamed, x to y to z to x, which is a proper rotation that keeps boxes boxes."""
    rotated: Any = changed(setting, lambda what, value: np.roll(value, 1, axis=-1) if what in ORIENTED else value)
    result: Setting = rotated.but(medium=_cells(rotated.medium, lambda cells: np.moveaxis(cells, 2, 0)))
    return result


def mirrored(setting: Setting) -> Setting:
    """Return the setting seen in a mirror across x = 0; what stands at the left of an image is then at the right."""
    sign = np.array([-1.0, 1.0, 1.0])
    other: Any = changed(setting, lambda what, value: value * sign if what in ORIENTED else value)
    light: Any = other.light
    if hasattr(light, "edge_u"):  # the side that shines is u x v's
        light = dataclasses.replace(light, edge_u=light.edge_v, edge_v=light.edge_u)
    result: Setting = other.but(medium=_cells(other.medium, lambda cells: cells[::-1]), light=light)
    return result


def changed(thing: Setting, change: Change) -> Setting:
    """Return a dataclass with its fields changed, and those of the dataclasses in it."""
    data: Any = thing
    changes: dict[str, Any] = {}
    for field in dataclasses.fields(data):
        value = getattr(data, field.name)
        if not field.init or value is None or (field.name in PHASES and not hasattr(value, "share")):
            continue
        if dataclasses.is_dataclass(value):
            if field.name != "film":
                changes[field.name] = changed(value, change)
        elif isinstance(value, tuple) and value and dataclasses.is_dataclass(value[0]):
            changes[field.name] = tuple(changed(one, change) for one in value)
        elif callable(value):
            raise UnsupportedError(f"{type(data).__name__} is a function of place, which cannot be moved", "medium")
        elif field.name not in WHAT and not _says_nothing(value):
            raise UnsupportedError(f"{type(data).__name__}.{field.name} cannot be moved with the scene", field.name)
        elif WHAT.get(field.name):
            changes[field.name] = _like(value, change(WHAT[field.name], np.asarray(value, dtype=float)))
    if "lower" in changes:
        low, high = np.asarray(changes["lower"]), np.asarray(changes["upper"])
        changes["lower"], changes["upper"] = (
            _like(data.lower, corner) for corner in (np.minimum(low, high), np.maximum(low, high))
        )
    result: Setting = dataclasses.replace(data, **changes)
    return result


def _says_nothing(value: Any) -> bool:
    return value == () or isinstance(value, str | bool)


def _like(value: Any, found: np.ndarray) -> Any:
    """Return an array as the type that a field had."""
    return tuple(found.tolist()) if isinstance(value, tuple) else _plain(found)


def _plain(found: np.ndarray) -> Any:
    return float(found) if np.ndim(found) == 0 else found


def _cells(medium: Any, rearrange: Callable[[np.ndarray], np.ndarray]) -> Any:
    """Return a medium with the voxels of its arrays put elsewhere."""
    if not (hasattr(medium, "lower") and hasattr(medium, "sigma_t")):
        return medium
    arrays = {name: np.asarray(getattr(medium, name)) for name in ("sigma_t", "albedo", "emission")}
    return dataclasses.replace(medium, **{name: rearrange(array) for name, array in arrays.items() if array.ndim >= 3})
