"""Write the tables of docs/oracle.md from what the quantities declare and the scene's tables of kinds.

python tools/write_oracle_docs.py
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

from fogproof.quantities import quantities
from fogproof.scene.kinds import ByKind

FILE = Path(__file__).resolve().parent.parent / "docs" / "oracle.md"


def table_of_quantities() -> str:
    """Return a row a quantity: name, arguments (those in brackets may be left out), unit, convention and source."""
    rows = ["| quantity | arguments | unit | convention | source |", "|---|---|---|---|---|"]
    for name, quantity in quantities().items():
        arguments = ", ".join(
            f"[{argument}]" if isinstance(declared, tuple) else argument
            for argument, declared in quantity.arguments.items()
        )
        rows.append(f"| `{name}` | {arguments} | {quantity.unit} | {quantity.convention} | {quantity.source} |")
    return "\n".join(rows)


def table_of_kinds() -> str:
    """Return a row a kind of medium, phase function, light, shape and occluder, with its keys."""
    rows = ["| argument | `kind` | keys |", "|---|---|---|"]
    tables: dict[str, ByKind] = {}
    for quantity in quantities().values():
        for argument, declared in quantity.arguments.items():
            for mark in _marks(declared[0] if isinstance(declared, tuple) else declared):
                if argument not in tables or len(mark.table()) > len(tables[argument].table()):
                    tables[argument] = mark
    for argument, mark in sorted(tables.items()):
        for kind, cls in mark.table().items():
            fields = dataclasses.fields(cls)
            keys = ", ".join(field.name if _required(field) else f"[{field.name}]" for field in fields)
            unless = " (unless given)" if kind == mark.default else ""
            rows.append(f"| {argument} | `{kind}`{unless} | {keys} |")
    return "\n".join(rows)


def _required(field: Any) -> bool:
    return field.default is field.default_factory is dataclasses.MISSING


def _marks(kind: Any) -> Iterator[ByKind]:
    yield from (mark for mark in getattr(kind, "__metadata__", ()) if isinstance(mark, ByKind))
    for part in get_args(kind):
        yield from _marks(part)


def document(text: str) -> str:
    """Return the page with its tables made anew; the rest stays as it is."""
    for name, table in (("quantities", table_of_quantities()), ("kinds", table_of_kinds())):
        begin, end = f"<!-- {name}: written by tools/write_oracle_docs.py -->\n", f"<!-- end of {name} -->"
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = f"{before}{begin}\n{table}\n\n{end}{after}"
    return text


if __name__ == "__main__":
    FILE.write_text(document(FILE.read_text(encoding="utf-8")), encoding="utf-8")
