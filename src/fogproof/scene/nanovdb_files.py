"""NanoVDB files: one grid of floats, written out densely over its bounding box. Plain and zipped files of version 32.

All numbers are little-endian. A file is a header, a description of each grid with its name, and the grids in that order:

    header       magic "NanoVDB0" or "NanoVDB2", u32 version, u16 grids, u16 codec (0 none, 1 zip: u64 bytes, then zlib)
    description  176 bytes: u64 size of the grid, at 136 u32 length of the name; then the name
    grid         at 384 f64 (3, 3) matrix and at 528 f64 (3,) offset from indices to the world, at 636 u32 type; at 672 the tree:
                 u64 offsets of leaves, lower, upper nodes and the root from there
    root         i32 (2, 3) bounding box, both ends in, at 24 u32 tiles, f32 background; from 64 on tiles of 32 bytes: u64 key,
                 i64 offset of a child or 0, u32 state, f32 value
    node         32^3 (upper) or 16^3 (lower) children: a mask of values at 32, one of children after it, and a table of 8 bytes:
                 f32 value or i64 offset of a child from the node
    leaf         8^3 f32 values at 96

Source: the layout as the headers of OpenVDB's NanoVDB document it (Museth 2021, NanoVDB, SIGGRAPH Talks).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fogproof.errors import InvalidInputError, UnsupportedError, shorten
from fogproof.input_files import open_regular, size_of
from fogproof.text import beginning

MAGIC = (b"NanoVDB0", b"NanoVDB2")
MAJOR = 32
CODECS = {0: "none", 1: "zip", 2: "Blosc"}
FLOAT = 1

VALUES = 2**27
"""The most values of a grid that is read: 1 GiB as float64."""

FREE, SPARSEST = 2**24, 32
"""So many values any file may stand for, a larger one so many for each of its bytes: a leaf full of values has a quarter of one a
byte, and a bounding box with less than a hundredth of it filled is no cloud but a damaged number."""

LARGEST = 2**32
"""The most bytes of a file that is read."""


class NodeLevel(NamedTuple):
    """A kind of node: log2 of its children along an axis, log2 of the voxels below each, where its table is, its size [bytes]."""

    log2: int
    below: int
    table: int
    size: int


UPPER, LOWER = NodeLevel(5, 7, 8256, 270400), NodeLevel(4, 3, 1088, 33856)
LEAF_TABLE, LEAF_SIZE = 96, 2144


class DenseGrid(NamedTuple):
    """Values (nx, ny, nz), indices of the first (3,), and the map from indices to the world: (3, 3) and (3,) [m]."""

    values: np.ndarray
    first: np.ndarray
    matrix: np.ndarray
    offset: np.ndarray


def read_nanovdb(path: Path, name: str | None = None) -> DenseGrid:
    """Return a grid of a NanoVDB file: the one of that name, or the first."""
    with open_regular(path, "the grid") as file:
        if size_of(file) > LARGEST:
            raise UnsupportedError(f"{path} has more than {LARGEST} bytes", str(path))
        data = file.read()
    try:
        return _dense(_Bytes(data), path, name)
    except (struct.error, IndexError, ValueError, zlib.error, OverflowError) as error:
        said = beginning(str(error))
        raise InvalidInputError(f"{path} is a broken or truncated NanoVDB file: {said}", str(path)) from None


class _Bytes:
    """Bytes that are read only where they are."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    def read(self, form: str, at: int) -> tuple[int | float, ...]:
        """Return numbers at a place, or say that it lies outside."""
        if at < 0 or at + struct.calcsize(form) > len(self.data):
            raise ValueError(f"it ends after {len(self.data)} bytes, and byte {at} is wanted")
        return struct.unpack_from(form, self.data, at)

    def whole(self, form: str, at: int) -> int:
        """Return one whole number."""
        return int(self.read(form, at)[0])

    def array(self, kind: str, count: int, at: int) -> np.ndarray:
        """Return an array at a place."""
        size = np.dtype(kind).itemsize * count
        if at < 0 or at + size > len(self.data):
            raise ValueError(f"it ends after {len(self.data)} bytes, and byte {at + size} is wanted")
        return np.frombuffer(self.data, kind, count, at)


def _dense(file: _Bytes, path: Path, name: str | None) -> DenseGrid:
    if file.data[:8] not in MAGIC:
        raise InvalidInputError(f"{path} is no NanoVDB file: it must begin with 'NanoVDB0' or 'NanoVDB2'", str(path))
    version, grids, codec = (int(x) for x in file.read("<IHH", 8))
    if version >> 21 != MAJOR:
        raise UnsupportedError(f"{path} has version {version >> 21} of NanoVDB; version {MAJOR} is read", str(path))
    if codec not in (0, 1):
        raise UnsupportedError(f"{path} is packed by {CODECS.get(codec, codec)}; 'none' and 'zip' are read", str(path))
    at, described = 16, []
    for _ in range(grids):
        length = file.whole("<I", at + 136)
        label = bytes(file.array("u1", length, at + 176)).split(b"\0")[0].decode("utf-8", "replace")
        described.append((label, at))
        at += 176 + length
    names = [label for label, _ in described]
    if not names or (name is not None and name not in names):
        raise InvalidInputError(f"{path} holds no grid {name!r}, but {shorten(names)}", str(path))
    chosen = names.index(name) if name is not None else 0
    for i, (_, where) in enumerate(described):
        size = file.whole("<Q", where)
        length = file.whole("<Q", at) if codec else size
        at += 8 if codec else 0
        if i == chosen:
            return _grid(_unpacked(file, at, length, size, codec), path)
        at += length
    raise AssertionError


def _unpacked(file: _Bytes, at: int, length: int, size: int, codec: int) -> _Bytes:
    packed = file.array("u1", length, at)
    if not codec:
        return _Bytes(packed.tobytes())
    if size > LARGEST:
        raise ValueError(f"its grid says it has {size} bytes")
    data = zlib.decompressobj().decompress(packed.tobytes(), size)
    if len(data) != size:
        raise ValueError(f"its grid has {len(data)} bytes and not {size}")
    return _Bytes(data)


def _grid(grid: _Bytes, path: Path) -> DenseGrid:
    """Return the values over the bounding box of what is active, which the root holds; descriptions may be left empty."""
    kind = grid.whole("<I", 636)
    if kind != FLOAT:
        raise UnsupportedError(f"{path} holds a grid of type {kind}; floats, type {FLOAT}, are read", str(path))
    root = 672 + grid.whole("<Q", 672 + 24)
    low, high = grid.array("<i4", 6, root).astype(np.int64).reshape(2, 3)
    shape = high - low + 1
    if np.any(shape < 1):
        raise InvalidInputError(
            f"{path} holds an empty grid: its bounding box is {low.tolist()} to {high.tolist()}", str(path)
        )
    if np.prod(shape.astype(float)) > VALUES:
        raise UnsupportedError(
            f"{path} says it holds {shape.tolist()}; more than {VALUES} values are not read", str(path)
        )
    if np.prod(shape.astype(float)) > FREE + SPARSEST * len(grid.data):
        raise UnsupportedError(
            f"{path} says it holds {shape.tolist()} in {len(grid.data)} bytes: almost all would be background; cut its"
            " bounding box",
            str(path),
        )
    matrix, offset = grid.array("<f8", 9, 384).reshape(3, 3), grid.array("<f8", 3, 528)
    tiles, background = grid.whole("<I", root + 24), float(grid.read("<f", root + 28)[0])
    values = np.full(tuple(shape), background)
    for k in range(tiles):
        key, child, _state, value = grid.read("<QqIf", root + 64 + 32 * k)
        parts = (
            np.array([int(key) >> 42, int(key) >> 21, int(key)]) & 0xFFFFF
        )  # 20 bits each, of numbers in 32 with a sign
        origin = (np.where(parts >= 1 << 19, parts - (1 << 20), parts) << 12).astype(np.int64)
        if child:
            for box, block in _blocks(grid, root + int(child), origin, UPPER, background):
                _write(values, low, box, block)
        else:
            _write(values, low, (origin, 4096), np.full((1, 1, 1), float(value)))
    return DenseGrid(values, low, matrix.astype(float), offset.astype(float))


Cube = tuple[np.ndarray, int]
"""Indices of the first voxel, and voxels along an axis."""


def _blocks(
    grid: _Bytes, node: int, origin: np.ndarray, level: NodeLevel, background: float
) -> Iterator[tuple[Cube, np.ndarray]]:
    """Yield cubes below a node that are not all background: (8, 8, 8) values of leaves, or (1, 1, 1) of a whole child."""
    count, side = 1 << 3 * level.log2, 1 << level.log2
    children = np.unpackbits(grid.array("u1", count // 8, node + 32 + count // 8), bitorder="little")
    offsets = grid.array("<i8", count, node + level.table)
    values = grid.array("<f4", 2 * count, node + level.table)[::2]
    for n in np.flatnonzero(children.astype(bool) | (values != background)).tolist():
        at = origin + (np.array([n // side**2, n // side % side, n % side]) << level.below)
        if not children[n]:
            yield (at, 1 << level.below), np.full((1, 1, 1), float(values[n]))
        elif level is UPPER:
            yield from _blocks(grid, node + int(offsets[n]), at, LOWER, background)
        else:
            leaf = grid.array("<f4", 512, node + int(offsets[n]) + LEAF_TABLE)
            yield (at, 8), leaf.reshape(8, 8, 8).astype(float)


def _write(values: np.ndarray, low: np.ndarray, cube: Cube, block: np.ndarray) -> None:
    """Write what lies in the bounding box."""
    origin, side = cube
    start = np.maximum(origin - low, 0)
    stop = np.minimum(origin - low + side, values.shape)
    if np.any(start >= stop):
        return
    place = tuple(slice(a, b) for a, b in zip(start, stop, strict=True))
    if block.size == 1:
        values[place] = block[0, 0, 0]
    else:
        inner = tuple(slice(a, b) for a, b in zip(start - (origin - low), stop - (origin - low), strict=True))
        values[place] = block[inner]
