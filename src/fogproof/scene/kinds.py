"""Kinds: where each side keeps what belongs to one kind of thing, and how files say which kind a table is.

A *room* is a package with one module a kind. The dataclass of a kind stands in `fogproof.scene.<room>.<kind>`, and the table
`KINDS` of `fogproof.scene.<room>` lists it. What the oracle and the estimators know of it stands in
`fogproof.analytic.<room>.<kind>` and `fogproof.estimators.<room>.<kind>`: same name, found here, never listed.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any


def module_of(thing: Any, room: str) -> ModuleType | None:
    """Return the module of a room that serves things of this kind, or None where the room has none.

    thing  an instance of a dataclass of the scene
    room   the package to look in, for example "fogproof.analytic.phase"

    That of `HenyeyGreenstein(0.5)` is `fogproof.analytic.phase.henyey_greenstein`.
    """
    return _imported(f"{room}.{type(thing).__module__.rpartition('.')[2]}")


def given(thing: Any, room: str, name: str) -> Any:
    """Return what the module of this kind gives under a name, or None: then the fallback of the room has to serve."""
    return getattr(module_of(thing, room), name, None)


@cache
def _imported(name: str) -> ModuleType | None:
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name == name:
            return None
        raise  # the module is there, and something it needs is not


def kinds_of(room: str) -> dict[str, type]:
    """Return the table `KINDS` of a room of the scene: the `kind` in files -> the dataclass."""
    kinds: dict[str, type] = importlib.import_module(room).KINDS
    return kinds


def name_kinds(schema: Any, definitions: dict[str, Any]) -> None:
    """Write the key `kind` into the definitions of a JSON Schema, wherever a union says which kinds its choices are."""
    for part in schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ():
        name_kinds(part, definitions)
    if isinstance(schema, dict) and "default_kind" in schema:
        default = schema.pop("default_kind")
        for kind, choice in zip(schema.pop("kinds"), schema["oneOf"], strict=True):
            definition = definitions[choice["$ref"].rpartition("/")[2]]
            definition.setdefault("properties", {})["kind"] = {"const": kind}
            required = definition.setdefault("required", [])
            if kind != default and "kind" not in required:
                required.insert(0, "kind")


@dataclass(frozen=True)
class ByKind:
    """Annotation that tells pydantic to choose the type by `kind`; pydantic is imported only when a file is read.

    types    kind -> type, or the room of the scene whose table is meant; it is read when the first file is, so that a
             kind may hold others of its room
    default  the kind of a table that has no key `kind`; None if it must have one
    """

    types: dict[str, type] | str
    default: str | None = None

    __hash__ = object.__hash__

    def __get_pydantic_core_schema__(self, _source: Any, handler: Any) -> Any:
        from pydantic_core import core_schema

        def without_kind(table: Any) -> Any:
            if not isinstance(table, dict):
                return table
            # Below here pydantic no longer sees JSON but Python, where its strict mode takes a list for no tuple.
            return {key: _as_tuple(value) for key, value in table.items() if key != "kind"}

        choices: dict[Any, Any] = {
            kind: core_schema.no_info_before_validator_function(without_kind, handler.generate_schema(cls))
            for kind, cls in self.table().items()
        }
        return core_schema.tagged_union_schema(choices, discriminator=self._kind if self.default else "kind")

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        # Which choice is which kind: a kind may hold others of its room, so its own description may not be there yet.
        return {**handler(schema), "kinds": list(self.table()), "default_kind": self.default}

    def table(self) -> dict[str, type]:
        """Return kind -> type."""
        return kinds_of(self.types) if isinstance(self.types, str) else self.types

    def _kind(self, table: Any) -> Any:
        return table.get("kind", self.default) if isinstance(table, dict) else self.default


def _as_tuple(value: Any) -> Any:
    return tuple(map(_as_tuple, value)) if isinstance(value, list) else value
