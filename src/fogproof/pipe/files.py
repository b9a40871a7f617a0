"""Rows of numbers from files: `.npy`, `.csv`, and bare little-endian bytes (`.bin`)."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
from numpy.lib import format as npy

from fogproof.errors import InvalidInputError, UnsupportedError, shorten
from fogproof.input_files import open_regular, size_of
from fogproof.pipe.blocks import DTYPES

_MOST = 2**30  # bytes that are read
_LONGEST_HEADER = 10_000  # of a .npy file
_NAMES = {"y": "x", "z": "x", "w": "x", "density": "pdf", "mu": "x", "t": "x"}
_KNOWN = ("x", "pdf", "weight", "event", "valid", "value", "cost", "order", "stderr")


def read_rows(path: Path, columns: int, kind: Literal["float64", "float32"]) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the rows (n, k) of a file, and the names of the columns if it has any.

    columns  how many a file of bare bytes has; others say it themselves
    kind     of bare bytes
    """
    suffix = path.suffix.lower()
    names: tuple[str, ...] = ()
    if suffix == ".bin":
        rows = _bare(path, columns, kind)
    elif suffix == ".npy":
        rows = _npy(path)
    elif suffix in (".csv", ".txt"):
        rows, names = _csv(path)
    else:
        what = f"samples are not read from {suffix or 'a file without a suffix'}"
        raise UnsupportedError(f"{path}: {what}; known are .npy, .csv and .bin", "file")
    if rows.ndim == 1:
        rows = rows[:, None]
    if rows.ndim != 2 or 0 in rows.shape:
        raise InvalidInputError(f"{path} must hold rows of numbers (n, k), got shape {list(rows.shape)}", str(path))
    return rows, names


def _npy(path: Path) -> np.ndarray:
    with open_regular(path, "the samples") as file:
        _require_size(file, path)
        try:
            version = npy.read_magic(file)
            length = int.from_bytes(file.read(2 if version == (1, 0) else 4), "little")
            if length > _LONGEST_HEADER:
                raise ValueError(f"its header has {length} bytes")
            file.seek(0)
            array = npy.read_array(file, allow_pickle=False)
        except Exception as error:  # NumPy evaluates the header as a Python literal: anything may come of it
            said = str(error).partition("\n")[0][:80] or "its header is broken"
            raise InvalidInputError(f"{path} is no .npy array: {said}", str(path)) from None
    if array.dtype.kind not in "iuf" or array.dtype.itemsize > 8:
        raise InvalidInputError(f"{path} must hold numbers, got dtype {shorten(str(array.dtype))}", str(path))
    return array if array.dtype == np.float32 else array.astype(np.float64)


def _bare(path: Path, columns: int, kind: Literal["float64", "float32"]) -> np.ndarray:
    if columns < 1:
        raise InvalidInputError(f"{path}: bare bytes need columns = [...] in the spec", "columns")
    with open_regular(path, "the samples") as file:
        size = _require_size(file, path)
        width = columns * np.dtype(DTYPES[kind]).itemsize
        if size == 0 or size % width:
            rule = f"must hold a whole number of rows of {columns} {kind}, {width} bytes each"
            raise InvalidInputError(f"{path} {rule}, got {size} bytes", str(path))
        return np.frombuffer(file.read(size), DTYPES[kind]).reshape(-1, columns)


def _csv(path: Path) -> tuple[np.ndarray, tuple[str, ...]]:
    with open_regular(path, "the samples") as file:
        _require_size(file, path)
        text = file.read().removeprefix(b"\xef\xbb\xbf")
    lines = [line for line in text.replace(b"\r", b"").split(b"\n") if line.strip() and not line.startswith(b"#")]
    if not lines:
        raise InvalidInputError(f"{path} holds no rows", str(path))
    separator = b"," if b"," in lines[0] else b";" if b";" in lines[0] else b"\t" if b"\t" in lines[0] else None
    first = lines[0].split(separator)
    names = () if _number(first[0]) else tuple(_name(cell, path) for cell in first)
    body = lines[1:] if names else lines
    rows = np.empty((len(body), len(first)))
    for place, line in enumerate(body):
        cells = line.split(separator)
        try:
            if len(cells) != len(first):
                raise ValueError
            rows[place] = [float(cell) for cell in cells]
        except ValueError:
            shown = line[:60].decode("utf-8", "replace")
            where = f"row {place + 1} is {shown!r}"
            raise InvalidInputError(f"{path}: {where}, not {len(first)} numbers", str(path)) from None
    return rows, names


def _number(cell: bytes) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _name(cell: bytes, path: Path) -> str:
    """Return the column's name: x1, y or "pdf [1/sr]" are read for what they are."""
    word = cell.decode("utf-8", "replace").strip().strip('"').lower().partition(" ")[0].partition("[")[0]
    bare = word.rstrip("0123456789_")
    name = _NAMES.get(bare, bare)
    if name not in _KNOWN:
        raise InvalidInputError(f"{path} has a column {shorten(word, 40)}; known are {', '.join(_KNOWN)}", str(path))
    return name


def _require_size(file: object, path: Path) -> int:
    size = size_of(file)  # type: ignore[arg-type]
    if size > _MOST:
        raise UnsupportedError(f"{path} has {size} bytes; at most {_MOST} are read", str(path))
    return size
