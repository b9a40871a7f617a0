"""Voxel grids from files: NumPy's `.npy`, and Mitsuba's binary `.vol`, version 3.

`.npy` holds an array (nx, ny, nz) or (nx, ny, nz, channels), in the order x, y, z; its box has to be given. `.vol` holds its
box, and its values in the order z, y, x, channel:

    bytes  type     content
    0-2    char     "VOL"
    3      uint8    3, the version
    4-7    int32    encoding: 1 float32, 3 uint8 (0 … 255 mean 0 … 1)
    8-23   int32    nx, ny, nz, channels
    24-47  float32  xmin, ymin, zmin, xmax, ymax, zmax
    48-    values, little-endian

OpenVDB stores sparse trees, which a dense grid has no use for: write the active bounding box as `.npy`, with OpenVDB's own Python
module, and give the box in world coordinates,

    import numpy as np, openvdb           # "import pyopenvdb as openvdb" before version 11
    grid = openvdb.read("smoke.vdb", "density")
    low, high = grid.evalActiveVoxelBoundingBox()
    dense = np.zeros([b - a + 1 for a, b in zip(low, high)], dtype=np.float32)
    grid.copyToArray(dense, ijk=low)
    np.save("smoke.npy", dense)
    half = 0.5                            # values stand at the centres of voxels
    print(grid.transform.indexToWorld([a - half for a in low]), grid.transform.indexToWorld([b + half for b in high]))

which is right for transforms without rotation or shear.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.errors import InvalidInputError, InvalidValueError, UnsupportedError
from fogproof.scene.media.voxel_grid import VoxelGrid
from fogproof.validate import number

_HEADER = struct.Struct("<3sBi4i6f")
_ENCODINGS: dict[int, tuple[np.dtype[Any], float]] = {1: (np.dtype("<f4"), 1.0), 3: (np.dtype("u1"), 1 / 255)}


def read_voxel_grid(
    path: str | Path, *, scale: float = 1.0, lower: Any = None, upper: Any = None, **more: Any
) -> VoxelGrid:
    """Read the extinction of a voxel grid from a `.npy` or `.vol` file.

    scale         factor from the file's values to sigma_t [1/m]
    lower, upper  (3,) corners of the box [m]; they override those of a `.vol` file
    more          further fields of `VoxelGrid`: interpolation, albedo, phase, emission

    Whatever is wrong with the file is a `FogproofError` that names it.
    """
    path = Path(path)
    readers = {".npy": _read_npy, ".vol": _read_vol}
    if path.suffix.lower() not in readers:
        raise UnsupportedError(
            f"{path}: grids are read from .npy and .vol files, got {path.suffix or 'no suffix'!r}", "path"
        )
    number("scale", scale, "must be finite and >= 0", 0)
    try:
        values, box = readers[path.suffix.lower()](path)
    except OSError as error:
        raise InvalidInputError(f"cannot read the grid {path}: {error.strerror or error}", str(path)) from None
    corners = [given if given is not None else stored for given, stored in zip((lower, upper), box, strict=True)]
    for name, corner in zip(("lower", "upper"), corners, strict=True):
        if corner is None:
            raise InvalidValueError(name, "must be given: a .npy file has no box", None, f"{name}=(x, y, z) in metres")
    try:
        return VoxelGrid(values * scale, corners[0], corners[1], **more)
    except InvalidValueError as error:
        raise error.inside("the grid", str(path)) from None


def _read_npy(path: Path) -> tuple[np.ndarray, tuple[None, None]]:
    try:
        values = np.load(path, allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise InvalidInputError(f"{path} is no .npy array: {error}", str(path)) from None
    if not isinstance(values, np.ndarray) or values.dtype.kind not in "iuf":
        raise InvalidInputError(f"{path} must hold an array of numbers", str(path))
    return values.astype(np.float64), (None, None)


def _read_vol(path: Path) -> tuple[np.ndarray, tuple[tuple[float, ...], tuple[float, ...]]]:
    data = path.read_bytes()
    if len(data) < _HEADER.size or data[:3] != b"VOL":
        raise InvalidInputError(
            f"{path} is no .vol file: it must begin with 'VOL' and a header of {_HEADER.size} bytes", str(path)
        )
    _, version, encoding, nx, ny, nz, channels, *box = _HEADER.unpack_from(data)
    if version != 3:
        raise UnsupportedError(f"{path} has version {version} of the .vol format; version 3 is read", str(path))
    if encoding not in _ENCODINGS:
        known = "1 (float32) and 3 (uint8) are"
        raise UnsupportedError(f"{path} has encoding {encoding}; {known} read", str(path))
    if min(nx, ny, nz, channels) < 1:
        size = f"{nx} x {ny} x {nz} voxels of {channels} channels"
        raise InvalidInputError(f"{path} holds an empty grid: {size}", str(path))
    kind, unit = _ENCODINGS[encoding]
    wanted = nx * ny * nz * channels * kind.itemsize
    if len(data) - _HEADER.size != wanted:
        got = len(data) - _HEADER.size
        raise InvalidInputError(f"{path} must have {wanted} bytes of values after its header, got {got}", str(path))
    values = np.frombuffer(data, kind, offset=_HEADER.size).reshape(nz, ny, nx, channels).transpose(2, 1, 0, 3)
    values = values.astype(np.float64) * unit
    return values[..., 0] if channels == 1 else values, (tuple(box[:3]), tuple(box[3:]))
