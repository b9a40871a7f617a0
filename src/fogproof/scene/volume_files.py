"""Voxel grids from files: NumPy's `.npy`, Mitsuba's binary `.vol`, version 3, NanoVDB's `.nvdb` and OpenVDB's `.vdb`.

`.npy` holds an array (nx, ny, nz) or (nx, ny, nz, channels), in the order x, y, z; its box has to be given. `.vol` holds its
box, and its values in the order z, y, x, channel:

    bytes  type     content
    0-2    char     "VOL"
    3      uint8    3, the version
    4-7    int32    encoding: 1 float32, 3 uint8 (0 … 255 mean 0 … 1)
    8-23   int32    nx, ny, nz, channels
    24-47  float32  xmin, ymin, zmin, xmax, ymax, zmax
    48-    values, little-endian

A `.nvdb` file is read directly (see `nanovdb_files`), a `.vdb` file by OpenVDB's own Python module where `openvdb` or
`pyopenvdb` can be imported. Both hold sparse trees, of which the bounding box is written out densely, and a map from indices to
the world: values stand at whole indices, in the middle of voxels. Where the map turns or shears, the grid comes as a
`TransformedMedium`.
"""

from __future__ import annotations

import importlib
import math
import os
import struct
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from fogproof.errors import InvalidInputError, InvalidValueError, UnsupportedError, shorten
from fogproof.input_files import open_regular, size_of
from fogproof.scene.media.transformed import TransformedMedium
from fogproof.scene.media.voxel_grid import VoxelGrid
from fogproof.scene.nanovdb_files import DenseGrid, read_nanovdb
from fogproof.text import beginning
from fogproof.validate import number

VALUES = 2**27
"""The most values of a grid that is read: 1 GiB as float64."""

LONGEST_HEADER = 10_000
"""The longest header of a `.npy` file [bytes]: NumPy evaluates no longer one."""

_HEADER = struct.Struct("<3sBi4i6f")
_ENCODINGS: dict[int, tuple[np.dtype[Any], float]] = {1: (np.dtype("<f4"), 1.0), 3: (np.dtype("u1"), 1 / 255)}


def read_voxel_grid(
    path: str | Path,
    *,
    scale: float = 1.0,
    lower: Any = None,
    upper: Any = None,
    name: str | None = None,
    **more: Any,
) -> VoxelGrid | TransformedMedium:
    """Read the extinction of a voxel grid from a `.npy`, `.vol`, `.nvdb` or `.vdb` file.

    scale         factor from the file's values to sigma_t [1/m]
    lower, upper  (3,) corners of the box [m]; they override those of the file
    name          of a grid in a `.nvdb` or `.vdb` file, for example "density"; the first unless given
    more          further fields of `VoxelGrid`: interpolation, albedo, phase, emission

    Whatever is wrong with the file is a `FogproofError` that names it.
    """
    path = Path(path)
    readers = {".npy": _read_npy, ".vol": _read_vol}
    sparse = {".nvdb": read_nanovdb, ".vdb": _read_openvdb}
    suffix = path.suffix.lower()
    if suffix not in {**readers, **sparse}:
        known = "grids are read from .npy, .vol, .nvdb and .vdb files"
        raise UnsupportedError(f"{path}: {known}, got {path.suffix or 'no suffix'!r}", "path")
    number("scale", scale, "must be finite and >= 0", 0)
    values: np.ndarray
    stored: tuple[Any, Any]
    if suffix in sparse:
        found = sparse[suffix](path, name)
        if lower is None and upper is None:
            return _placed(found, scale, path, more)
        values, stored = found.values, (None, None)
    else:
        values, stored = readers[suffix](path)
    corners = [given if given is not None else stored for given, stored in zip((lower, upper), stored, strict=True)]
    for name, corner in zip(("lower", "upper"), corners, strict=True):
        if corner is None:
            raise InvalidValueError(name, "must be given: a .npy file has no box", None, f"{name}=(x, y, z) in metres")
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite then is refused by name
        values = values * scale
    try:
        return VoxelGrid(values, corners[0], corners[1], **more)
    except InvalidValueError as error:
        raise error.inside("the grid", str(path)) from None


def _placed(grid: DenseGrid, scale: float, path: Path, more: dict[str, Any]) -> VoxelGrid | TransformedMedium:
    """Return a sparse file's grid where its map puts it."""
    with np.errstate(over="ignore", invalid="ignore"):
        values = grid.values * scale
    low = grid.first - 0.5
    try:
        diagonal = np.diag(grid.matrix)
        if np.array_equal(grid.matrix, np.diag(diagonal)) and np.all(diagonal > 0):
            corners = (diagonal * low + grid.offset, diagonal * (low + values.shape) + grid.offset)
            return VoxelGrid(values, *corners, **more)
        matrix = np.concatenate([grid.matrix, grid.offset[:, None]], axis=1)
        return TransformedMedium(VoxelGrid(values, low, low + values.shape, **more), matrix)
    except InvalidValueError as error:
        raise error.inside("the grid", str(path)) from None


def _read_openvdb(path: Path, name: str | None) -> DenseGrid:
    """Return a grid of an OpenVDB file by OpenVDB's own module."""
    vdb = next((found for module in ("openvdb", "pyopenvdb") if (found := _imported(module))), None)
    if vdb is None:
        fix = "install OpenVDB's Python module, or convert the file to .nvdb"
        raise UnsupportedError(f"{path}: .vdb files are read where 'openvdb' can be imported; {fix}", "path")
    with open_regular(path, "the grid"):
        pass  # whatever is wrong with the path is said in our words
    try:
        names = [grid.name for grid in vdb.readAllGridMetadata(str(path))]
        grid = vdb.read(str(path), name if name is not None else names[0])
    except Exception as error:  # a module from outside raises what it likes
        raise InvalidInputError(f"cannot read the grid {path}: {shorten(str(error))}", str(path)) from None
    low, high = (np.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
    shape = high - low + 1
    if np.any(shape < 1) or np.prod(shape.astype(float)) > VALUES:
        raise UnsupportedError(f"{path} holds {shape.tolist()} values; 1 to {VALUES} are read", str(path))
    dense = np.zeros(tuple(shape), np.float32)
    grid.copyToArray(dense, ijk=tuple(low.tolist()))
    zero = np.array(grid.transform.indexToWorld((0, 0, 0)))
    matrix = np.stack([np.array(grid.transform.indexToWorld(tuple(axis))) - zero for axis in np.eye(3)], axis=1)
    return DenseGrid(dense.astype(float), low, matrix, zero)


def _imported(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError:
        return None


def _read_npy(path: Path) -> tuple[np.ndarray, tuple[None, None]]:
    with open_regular(path, "the grid") as file:
        try:
            version = npy.read_magic(file)
            header = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}.get(version)
            if header is None:
                raise ValueError(f"version {version[0]}.{version[1]} of the format is not read")
            _require_short_header(file, 2 if version == (1, 0) else 4)
            shape, by_columns, kind = header(file)
        except Exception as error:  # NumPy evaluates the header as a Python literal: anything may come of it
            said = beginning(str(error)) or "its header is broken"
            raise InvalidInputError(f"{path} is no .npy array: {said}", str(path)) from None
        if kind.kind not in "iuf" or kind.itemsize > 8:
            raise InvalidInputError(f"{path} must hold an array of numbers, got dtype {shorten(str(kind))}", str(path))
        shape = tuple(int(n) for n in shape)  # a header may say True
        values = _values(file, path, kind, shape)
    return values.reshape(shape, order="F" if by_columns else "C").astype(np.float64), (None, None)


def _require_short_header(file: BufferedReader, digits: int) -> None:
    """Refuse a header that would be read whole before anybody asks how long it is; its length is `digits` bytes ahead."""
    length = int.from_bytes(file.read(digits), "little")
    file.seek(-min(digits, file.tell()), os.SEEK_CUR)
    if length > LONGEST_HEADER:
        raise ValueError(f"its header has {length} bytes")


def _values(file: BufferedReader, path: Path, kind: np.dtype[Any], shape: tuple[int, ...]) -> np.ndarray:
    """Return the rest of the file as values, (n,), if it is as long as its header says."""
    count = math.prod(shape)  # exact, whatever the header says
    if len(shape) not in (3, 4) or min(shape) < 1:
        rule = "must be a grid (nx, ny, nz) or (nx, ny, nz, channels) with at least one voxel"
        raise InvalidInputError(f"{path} {rule}, got {shorten(list(shape))}", str(path))
    left = size_of(file) - file.tell()
    if count > VALUES:
        raise UnsupportedError(
            f"{path} says it holds {shorten(list(shape))}; more than {VALUES} values are not read", str(path)
        )
    if left != count * kind.itemsize:
        wanted = f"must have {count * kind.itemsize} bytes of values after its header, got {left}"
        raise InvalidInputError(f"{path} {wanted}", str(path))
    try:
        data = file.read(left)
    except OSError as error:
        raise InvalidInputError(f"cannot read the grid {path}: {error.strerror or error}", str(path)) from None
    if len(data) != left:
        raise InvalidInputError(f"cannot read the grid {path}: it changed while it was read", str(path))
    return np.frombuffer(data, kind)


def _read_vol(path: Path) -> tuple[np.ndarray, tuple[tuple[float, ...], tuple[float, ...]]]:
    with open_regular(path, "the grid") as file:
        header = file.read(_HEADER.size)
        if len(header) < _HEADER.size or header[:3] != b"VOL":
            raise InvalidInputError(
                f"{path} is no .vol file: it must begin with 'VOL' and a header of {_HEADER.size} bytes", str(path)
            )
        _, version, encoding, nx, ny, nz, channels, *box = _HEADER.unpack(header)
        if version != 3:
            raise UnsupportedError(f"{path} has version {version} of the .vol format; version 3 is read", str(path))
        if encoding not in _ENCODINGS:
            known = "1 (float32) and 3 (uint8) are"
            raise UnsupportedError(f"{path} has encoding {encoding}; {known} read", str(path))
        if min(nx, ny, nz, channels) < 1:
            size = f"{nx} x {ny} x {nz} voxels of {channels} channels"
            raise InvalidInputError(f"{path} holds an empty grid: {size}", str(path))
        kind, unit = _ENCODINGS[encoding]
        values = _values(file, path, kind, (nz, ny, nx, channels)).reshape(nz, ny, nx, channels)
    values = values.transpose(2, 1, 0, 3).astype(np.float64) * unit
    return values[..., 0] if channels == 1 else values, (tuple(box[:3]), tuple(box[3:]))
