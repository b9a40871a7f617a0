"""Unions in files: a table says which of several types it is by its key `kind`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class ByKind:
    """Annotation that tells pydantic to choose the type by `kind`; pydantic is imported only when a file is read.

    default  the kind of a table that has no key `kind`; None if it must have one
    """

    types: dict[str, type]
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
            for kind, cls in self.types.items()
        }
        return core_schema.tagged_union_schema(choices, discriminator=self._kind if self.default else "kind")

    def _kind(self, table: Any) -> Any:
        return table.get("kind", self.default) if isinstance(table, dict) else self.default


def _as_tuple(value: Any) -> Any:
    return tuple(map(_as_tuple, value)) if isinstance(value, list) else value
