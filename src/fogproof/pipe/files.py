"""Rows of numbers from files: `.npy`, `.csv`, and bare little-endian bytes (`.bin`)."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.lib import format as npy

from fogproof.errors import InvalidInputError, UnsupportedError, shorten
from fogproof.input_files import open_regular, size_of
from fogproof.pipe.blocks import DTYPES
from fogproof.pipe.number_lines import habit, numbers_of
from fogproof.text import beginning

_MOST = 2**30  # bytes that are read
_LONGEST_HEADER = 10_000  # of a .npy file
_NAMES = {"y": "x", "z": "x", "w": "x", "density": "pdf", "mu": "x", "cosine": "x", "t": "x"}
_QUOTED = re.compile(rb'^"([^"]*)"$')
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
        rows, names = _npy(path)
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


def _npy(path: Path) -> tuple[np.ndarray, tuple[str, ...]]:
    with open_regular(path, "the samples") as file:
        _require_size(file, path)
        try:
            version = npy.read_magic(file)
            length = int.from_bytes(file.read(2 if version == (1, 0) else 4), "little")
            if length > _LONGEST_HEADER:
                raise ValueError(f"its header has {length} bytes")
            file.seek(0)
            array = npy.read_array(file, allow_pickle=False)
            if left := size_of(file) - file.tell():
                raise ValueError(f"{left} bytes follow the array that its header tells of; write one array a file")
        except Exception as error:  # NumPy evaluates the header as a Python literal: anything may come of it
            said = beginning(str(error)) or "its header is broken"
            raise InvalidInputError(f"{path} is no .npy array: {said}", str(path)) from None
    names: tuple[str, ...] = ()
    if array.dtype.names and all(array.dtype[name].kind in "iuf" for name in array.dtype.names) and array.ndim == 1:
        names = tuple(_name(name.encode(), path) for name in array.dtype.names)
        array = np.stack([array[name] for name in array.dtype.names], axis=-1)
    if array.dtype.kind not in "iuf":
        raise InvalidInputError(f"{path} must hold numbers, got dtype {shorten(str(array.dtype))}", str(path))
    return array if array.dtype == np.float32 else array.astype(np.float64), names


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
    if text[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in text[:64]:
        raise InvalidInputError(f"{path} is not UTF-8 text; save it as UTF-8", str(path))
    every = [line for line in text.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n") if line.strip()]
    lines = [line for line in every if not line.startswith(b"#")]
    if not lines:
        raise InvalidInputError(f"{path} holds no rows", str(path))
    separator = b";" if b";" in lines[0] else next((mark for mark in (b",", b"\t") if mark in lines[0]), None)
    first = _cells(lines[0], separator)
    if any(byte in b"0123456789" for byte in first[0].lstrip()[:2]) or first[0].strip().lower() in (b"inf", b"nan"):
        body, names = lines, _remarked(every[0], separator, len(first))
    else:
        body, names = lines[1:], tuple(_name(cell, path) for cell in first)
    rows = np.empty((len(body), len(first)))
    for place, line in enumerate(body):
        try:
            rows[place] = numbers_of(_cells(line, separator), len(first))
        except ValueError:
            shown = f"row {place + 1} is {line[:60].decode('utf-8', 'replace')!r}"
            points = any(b"." in other for other in body)
            rule = f"not {len(first)} numbers{habit(line, len(first), separator, points)}"
            raise InvalidInputError(f"{path}: {shown}, {rule}", str(path)) from None
    return rows, names


def _cells(line: bytes, separator: bytes | None) -> list[bytes]:
    """Return the cells of a line, each without the quotes that some programs put around all of them.

    A quote without its pair stays, and is no part of a number: the cell goes on in the next line.
    """
    cells = line.split(separator)
    return [_QUOTED.sub(rb"\1", cell.strip()) for cell in cells] if b'"' in line else cells


def _remarked(line: bytes, separator: bytes | None, count: int) -> tuple[str, ...]:
    """Return the names of columns in a remark before the numbers, where NumPy's `savetxt` writes them; () if it has none."""
    words = [_bare_name(cell) for cell in line.lstrip(b"# ").split(separator)] if line.startswith(b"#") else []
    return tuple(words) if len(words) == count and set(words) <= set(_KNOWN) else ()


def _name(cell: bytes, path: Path) -> str:
    """Return the column's name: x1, y or "pdf [1/sr]" are read for what they are."""
    name = _bare_name(cell)
    if name not in _KNOWN:
        word = cell.decode("utf-8", "replace").strip()
        raise InvalidInputError(f"{path} has a column {shorten(word, 40)}; known are {', '.join(_KNOWN)}", str(path))
    return name


def _bare_name(cell: bytes) -> str:
    word = cell.decode("utf-8", "replace").strip().strip('"').lower().partition(" ")[0].partition("[")[0]
    bare = word.rstrip("0123456789_")
    return _NAMES.get(bare, bare)


def _require_size(file: object, path: Path) -> int:
    size = size_of(file)  # type: ignore[arg-type]
    if size > _MOST:
        raise UnsupportedError(f"{path} has {size} bytes; at most {_MOST} are read", str(path))
    return size
