"""Rows of numbers as little-endian bytes, row after row, or as lines of comma-separated text."""

from __future__ import annotations

import contextlib
from typing import Literal

import numpy as np

from fogproof.pipe.number_lines import habit, numbers_of

Type = Literal["float64", "float32", "text"]
DTYPES: dict[str, str] = {"float64": "<f8", "float32": "<f4"}


def encoded(rows: np.ndarray, kind: Type) -> memoryview:
    """Return rows (n, k) as bytes; text has as many digits as it takes to be read back exactly."""
    if kind == "text":
        if not rows.shape[1]:
            return memoryview(b"")
        line = ",".join(["%r"] * rows.shape[1]) + "\n"
        numbers = np.asarray(rows, dtype=np.float64).ravel().tolist()
        return memoryview(((line * len(rows)) % tuple(numbers)).encode())
    return bytes_of(np.ascontiguousarray(rows, dtype=DTYPES[kind]))


def bytes_of(array: np.ndarray) -> memoryview:
    """Return the bytes of a contiguous array, without a copy."""
    return memoryview(array.reshape(-1).view(np.uint8).data)


def from_lines(lines: list[bytes], columns: int) -> np.ndarray:
    """Return lines of text as rows (n, columns), or raise `ValueError` with the place and what stands there."""
    whole = b",".join(lines)
    if b"_" not in whole and all(line.count(b",") == columns - 1 for line in lines):
        with contextlib.suppress(ValueError):  # which of them is told below
            return np.array(list(map(float, whole.split(b",")))).reshape(len(lines), columns)
    rows = np.empty((len(lines), columns))
    for place, line in enumerate(lines):
        try:
            rows[place] = numbers_of(line.split(b","), columns)
        except ValueError:
            shown = line[:80].decode("utf-8", "replace")
            fix = habit(line, columns, points=b"." in whole)
            due = f"{columns} numbers between commas" if columns > 1 else "a number"
            raise ValueError(f"row {place + 1} is {shown!r}, not {due}{fix}") from None
    return rows


def swapped(rows: np.ndarray) -> np.ndarray:
    """Return what the numbers are if their bytes come in the other order."""
    return rows.byteswap()
