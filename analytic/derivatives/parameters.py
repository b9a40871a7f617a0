"""Parameters by name: "albedo", "medium.sigma_t", "medium.sigma_t[1,0,2]", "medium.phase.g".

What is read and replaced are the arguments of a quantity; things of the scene are frozen, so that replacing makes anew.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.media import Medium

PART = re.compile(r"([A-Za-z_]\w*)(?:\[(\d+(?:,\s*\d+)*)\])?")


@dataclass(frozen=True)
class Parameter:
    """A number inside the arguments of a quantity.

    name   as it was given
    path   fields to follow
    index  which entry of an array, () for all of it
    """

    name: str
    path: tuple[str, ...]
    index: tuple[int, ...] = ()

    def read(self, arguments: Mapping[str, Any]) -> np.ndarray:
        """Return the value, () or the array's shape where no entry is chosen."""
        thing: Any = arguments
        for step in self.path:
            thing = _field(thing, step, self.name)
        array = np.asarray(thing)
        if array.dtype.kind not in "fiu":
            raise InvalidValueError("wrt", "must name a number or an array of numbers", self.name)
        array = array.astype(float)
        if self.index:
            try:
                array = np.asarray(array[self.index])
            except IndexError:
                raise InvalidValueError("wrt", f"must lie within the shape {list(array.shape)}", self.name) from None
        return array

    def replaced(self, arguments: Mapping[str, Any], value: Any) -> dict[str, Any]:
        """Return the arguments with another value there; replaced things are made anew."""
        return dict(_with(arguments, self.path, self.index, value, self.name))

    def entries(self, arguments: Mapping[str, Any]) -> list[Parameter]:
        """Return a parameter for each entry of the array it names; itself where it is one number."""
        shape = self.read(arguments).shape
        return [Parameter(self.name, self.path, (*self.index, *map(int, index))) for index in np.ndindex(*shape)]


def parameter(name: str, arguments: Mapping[str, Any]) -> Parameter:
    """Return the parameter of that name; of a scene, "medium.g" means "scene.medium.g"."""
    if not isinstance(name, str) or not name:
        raise InvalidValueError("wrt", 'must be the name of a parameter, such as "albedo" or "medium.sigma_t"', name)
    parts = [PART.fullmatch(part) for part in re.split(r"\.(?![^\[]*\])", name)]
    if any(part is None for part in parts) or any(part[2] for part in parts[:-1] if part):
        raise InvalidValueError(
            "wrt", 'must be names joined by dots, the last perhaps with [i,j,k], as "medium.sigma_t[1]"', name
        )
    path = tuple(part[1] for part in parts if part)
    last = parts[-1]
    index = tuple(int(i) for i in last[2].split(",")) if last and last[2] else ()
    if path[0] not in arguments and "scene" in arguments:
        path = ("scene", *path)
    found = Parameter(name, path, index)
    found.read(arguments)
    return found


def _field(thing: Any, step: str, name: str) -> Any:
    known = list(thing) if isinstance(thing, Mapping) else _names(thing)
    if step not in known:
        rule = f"must name an argument or a field of one; {step!r} is none of {', '.join(known) or 'the fields of a number'}"
        raise InvalidValueError("wrt", rule, name)
    return thing[step] if isinstance(thing, Mapping) else getattr(thing, step)


def _names(thing: Any) -> list[str]:
    if not dataclasses.is_dataclass(thing) or isinstance(thing, type):
        return []
    derived = ["sigma_t", "albedo"] if isinstance(thing, Medium) else []
    return [field.name for field in dataclasses.fields(thing)] + derived


def _with(thing: Any, path: tuple[str, ...], index: tuple[int, ...], value: Any, name: str) -> Any:
    if not path:
        if not index:
            return value
        array = np.array(thing, dtype=float)
        array[index] = value
        return array
    inner = _with(_field(thing, path[0], name), path[1:], index, value, name)
    if isinstance(thing, Mapping):
        return {**thing, path[0]: inner}
    if isinstance(thing, Medium) and path[0] == "sigma_t":  # the albedo stays
        return dataclasses.replace(thing, sigma_a=inner * (1 - thing.albedo), sigma_s=inner * thing.albedo)
    if isinstance(thing, Medium) and path[0] == "albedo":  # the extinction stays
        return dataclasses.replace(thing, sigma_a=thing.sigma_t * (1 - inner), sigma_s=thing.sigma_t * inner)
    return dataclasses.replace(thing, **{path[0]: inner})
