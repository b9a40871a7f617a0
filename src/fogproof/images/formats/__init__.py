"""File formats of images, one module a format, found by the suffix. Functions of a module:

read   (path) -> the channels of the file by name, each (rows, columns) as stored, row 0 the upper one
write  (path, channels) -> None; a format that has no names takes one channel, or R, G and B
"""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from fogproof.errors import InvalidInputError

SUFFIXES = {".exr": "exr", ".npy": "npy", ".pfm": "pfm"}
LARGEST = 1 << 30
"""Bytes of pixels in one file, at most."""

Channels = dict[str, np.ndarray]


def format_of(path: str | Path) -> ModuleType:
    """Return the module that reads and writes files of this suffix."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        what = f"{path}: images are read from {known}; their pixels are linear radiance"
        more = (
            ""
            if suffix not in (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp")
            else ("; 8-bit and tone-mapped pixels cannot be compared: write the linear image")
        )
        raise InvalidInputError(what + more, str(path))
    return importlib.import_module(f"fogproof.images.formats.{SUFFIXES[suffix]}")


def too_large(path: Any, columns: int, rows: int, channels: int) -> InvalidInputError:
    """Return the error for an image beyond the bound."""
    return InvalidInputError(
        f"{path}: claims {columns} x {rows} pixels of {channels} channels, more than {LARGEST} bytes", str(path)
    )


def layers(value: np.ndarray) -> Channels:
    """Return an image (rows, columns) or (rows, columns, channels) by the usual names of its channels."""
    if value.ndim == 2:
        return {"Y": value}
    names = {1: ["Y"], 3: ["R", "G", "B"]}.get(value.shape[2], [f"C{i}" for i in range(value.shape[2])])
    return {name: value[..., i] for i, name in enumerate(names)}
