"""Golden tables as JSON, CSV and NumPy archives."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

import numpy as np

from fogproof.golden.entries import Entry, rows_of
from fogproof.oracle.answers import json_numbers

FORMAT = "fogproof/reference-values/1"
ABOUT = (
    "|value - truth| <= error, element by element; a number in a request stands for the float64 nearest to it; "
    "digits, where given, are proven"
)


def described(entries: Sequence[Entry]) -> dict[str, dict[str, str]]:
    """Return unit, convention and source of each quantity in a table."""
    known = {entry.quantity.name: entry.quantity for entry in entries}
    return {name: {"unit": q.unit, "convention": q.convention, "source": q.source} for name, q in known.items()}


def to_json_document(entries: Sequence[Entry]) -> str:
    """Return a table as one JSON document; infinite numbers are the strings "inf" and "-inf"."""
    values = [
        {
            "request": entry.request,
            "value": json_numbers(entry.value),
            "error": json_numbers(entry.error),
            "method": entry.method,
            "source": entry.source,
            **({"digits": entry.digits} if entry.digits else {}),
        }
        for entry in entries
    ]
    document = {"format": FORMAT, "fogproof": version("fogproof"), "about": ABOUT, "quantities": described(entries)}
    return json.dumps({**document, "values": values}, indent=1, allow_nan=False) + "\n"


def to_csv(entries: Sequence[Entry]) -> str:
    """Return a table as CSV, one row a number; `arguments` is JSON, and `index` the place in an answer of many numbers."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(
        ("quantity", "arguments", "index", "value", "error", "unit", "convention", "method", "source", "digits")
    )
    for entry in entries:
        known = entry.quantity
        for row in rows_of(entry):
            index = " ".join(map(str, row.index))
            numbers = (repr(row.value), repr(row.error))
            told = (known.unit, known.convention, entry.method, entry.source, entry.digits)
            table.writerow((known.name, json.dumps(row.arguments), index, *numbers, *told))
    return text.getvalue()


def to_npz(entries: Sequence[Entry]) -> bytes:
    """Return a table as a NumPy archive that loads without pickle.

    Of the k-th entry of a quantity `q` it holds `q_k_value` and `q_k_error`, the arrays it was asked for as `q_k_<argument>`, and
    `q_k_request`, the request as JSON; `about` is JSON with format, units and conventions.
    """
    about = {"format": FORMAT, "fogproof": version("fogproof"), "about": ABOUT, "quantities": described(entries)}
    arrays: dict[str, Any] = {"about": np.array(json.dumps(about))}
    counts: dict[str, int] = {}
    for entry in entries:
        name = entry.quantity.name
        k = counts[name] = counts.get(name, -1) + 1
        stem = f"{name}_{k}"
        arrays |= {f"{stem}_value": entry.value, f"{stem}_error": entry.error}
        arrays[f"{stem}_request"] = np.array(json.dumps(entry.request))
        for path in entry.quantity.arrays:
            outer, _, inner = path.partition(".")
            given = entry.request.get(outer)
            given = given.get(inner) if inner and isinstance(given, dict) else given
            if given is not None:
                arrays[f"{stem}_{path.replace('.', '_')}"] = np.vectorize(float, otypes=[float])(given)
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()
