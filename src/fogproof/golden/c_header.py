"""Golden tables as a header for C, C89 too, and C++: one struct and one array a quantity, with the conventions in comments."""

from __future__ import annotations

import json
import math
import re
import textwrap
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from fogproof.golden.entries import Entry, Row, rows_of
from fogproof.quantities import Quantity

LONGEST = 4000
"""Characters of a string: ISO C promises 4095."""

HEAD = """\
/* Reference values of fogproof {version}: |value - truth| <= error, rounding counted.

   Each quantity has a struct and an array of them. Arguments that are numbers are members of their names, points and
   directions arrays of three; `arguments` holds all of them as JSON (empty if longer than {longest} characters), `index` the
   place in an answer of many numbers, channels or orders: 0 if there is but one. */
#ifndef FOGPROOF_GOLDEN_H
#define FOGPROOF_GOLDEN_H

#include <math.h>
#include <stddef.h>
"""


def to_c(entries: Sequence[Entry]) -> str:
    """Return a table as a C header."""
    by_quantity: dict[str, list[Entry]] = {}
    for entry in entries:
        by_quantity.setdefault(entry.quantity.name, []).append(entry)
    parts = [HEAD.format(version=version("fogproof"), longest=LONGEST)]
    parts += [_table(found[0].quantity, found) for found in by_quantity.values()]
    return "\n".join([*parts, "#endif\n"])


def _table(quantity: Quantity, entries: list[Entry]) -> str:
    """Return the comment, struct, array and length of one quantity."""
    rows = [row for entry in entries for row in rows_of(entry)]
    given = {path: mark for path, mark in quantity.arrays.items() if not mark.table and _given(rows, path)}
    members = [f"    double {_member(path)}{'[3]' if mark.axes else ''};" for path, mark in given.items()]
    name = f"fogproof_{quantity.name}"
    lines = [
        _comment(f"{quantity.name} [{quantity.unit}]: {quantity.convention}. Source: {quantity.source}."),
        f"struct {name} {{",
        *members,
        "    double value, error;",
        "    int index;",
        "    const char *arguments;",
        "};",
        f"static const struct {name} {name}_golden[] = {{",
    ]
    for row in rows:
        numbers = [_number(_value(quantity, row, path)) for path in given]
        text = json.dumps(row.arguments)
        shape = row.entry.value.shape[len(row.entry.value.shape) - len(row.index) :]
        flat = sum(i * math.prod(shape[k + 1 :]) for k, i in enumerate(row.index))
        cells = [*numbers, _number(row.value), _number(row.error), str(flat), _string(text)]
        lines.append(f"    {{{', '.join(cells)}}},")
    count = f"static const size_t {name}_count = sizeof({name}_golden) / sizeof({name}_golden[0]);"
    return "\n".join([*lines, "};", count, ""])


def _given(rows: list[Row], path: str) -> bool:
    return any(_found(row, path) is not None for row in rows)


def _found(row: Row, path: str) -> Any:
    outer, _, inner = path.partition(".")
    value = row.arguments.get(outer)
    return value.get(inner) if inner and isinstance(value, dict) else value


def _value(quantity: Quantity, row: Row, path: str) -> Any:
    """Return an argument of a row, its default where the request leaves it out."""
    found = _found(row, path)
    declared = quantity.arguments.get(path)
    if found is None:
        return declared[1] if isinstance(declared, tuple) and isinstance(declared[1], float) else "inf"
    return found


def _member(path: str) -> str:
    return path.replace(".", "_")


def _number(value: Any) -> str:
    if isinstance(value, list):
        return "{" + ", ".join(map(_number, value)) + "}"
    x = float(value)
    return repr(x) if math.isfinite(x) else "HUGE_VAL" if x > 0 else "-HUGE_VAL"


def _string(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("?", "\\?") if len(text) <= LONGEST else ""
    return f'"{escaped}"'


def _comment(text: str) -> str:
    plain = re.sub(r"\*/", "* /", text.replace("…", "...")).encode("ascii", "replace").decode()
    return "/* " + "\n   ".join(textwrap.wrap(plain, 110)) + " */"
