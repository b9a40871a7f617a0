"""Which keys a table of a file may have, read from the JSON Schema of what is built from it: to tell what a wrong one resembles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any


def known_keys(schema: dict[str, Any], data: Any, way: Sequence[str]) -> list[str]:
    """Return the keys of the table at the end of a way through the data: keys of tables, and places in lists.

    schema  that of the whole, with its `$defs`
    """
    definitions = schema.get("$defs", {})
    parts = list(_choices(schema, data, definitions))
    for step in way:
        inner = data[int(step)] if isinstance(data, list) else data[step]
        found = []
        for part in parts:
            listed = isinstance(data, list)
            below = _item(part, int(step)) if listed else part.get("properties", {}).get(step)
            found += list(_choices(below, inner, definitions)) if isinstance(below, dict) else []
        parts, data = found, inner
    return list(dict.fromkeys(key for part in parts for key in part.get("properties", {})))


def _item(part: dict[str, Any], place: int) -> Any:
    first = part.get("prefixItems", [])
    return first[place] if place < len(first) else part.get("items")


def _choices(part: dict[str, Any], data: Any, definitions: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield what a part of the schema may stand for: of several kinds that of the data, or the default."""
    if "$ref" in part:
        yield from _choices(definitions[part["$ref"].rpartition("/")[2]], data, definitions)
    elif "kinds" in part:
        kind = data.get("kind", part["default_kind"]) if isinstance(data, dict) else None
        for name, choice in zip(part["kinds"], part["oneOf"], strict=True):
            if name == kind:
                yield from _choices(choice, data, definitions)
    elif "anyOf" in part or "oneOf" in part:
        for choice in [*part.get("anyOf", ()), *part.get("oneOf", ())]:
            yield from _choices(choice, data, definitions)
    else:
        yield part
