"""PFM, the portable float map: three lines of text, then single precision from the lowest row upwards (Debevec)."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from fogproof.errors import InvalidInputError
from fogproof.images.formats import LARGEST, Channels, layers, too_large
from fogproof.input_files import open_regular, size_of
from fogproof.reports.files import write_output

HEADER = re.compile(rb"(P[Ff])\s+(\d{1,9})\s+(\d{1,9})\s+([-+]?[0-9.]{1,20}(?:[eE][-+]?\d{1,3})?)[ \t\r]*\n")


def read(path: Path) -> Channels:
    """Read a grey (Pf) or coloured (PF) map; the sign of its scale is the order of bytes, its size must be 1."""
    with open_regular(path, "the image") as file:
        head = HEADER.match(file.read(128))
        if head is None:
            raise InvalidInputError(f"{path}: does not begin like a PFM: PF or Pf, width, height, scale", str(path))
        channels, columns, rows = (3 if head[1] == b"PF" else 1), int(head[2]), int(head[3])
        count = columns * rows * channels
        if 4 * count > LARGEST:
            raise too_large(path, columns, rows, channels)
        rest = size_of(file) - head.end()
        if not count or rest != 4 * count:
            what = f"should hold {4 * count} bytes of pixels and has {rest}: it is truncated or broken"
            raise InvalidInputError(f"{path}: {what}", str(path))
        try:
            scale = float(head[4])
        except ValueError:
            scale = 0.0
        if scale == 0:
            raise InvalidInputError(
                f"{path}: the scale of a PFM is a number < 0 or > 0, its sign the byte order", str(path)
            )
        if abs(scale) != 1:
            what = f"its scale is {scale:g}, which some readers apply and others do not: multiply the pixels, and write 1 or -1"
            raise InvalidInputError(f"{path}: {what}", str(path))
        file.seek(head.end())
        array = np.frombuffer(file.read(rest), "<f4" if scale < 0 else ">f4").astype(np.float32)
    value = array.reshape((rows, columns, 3) if channels == 3 else (rows, columns))[::-1]
    return layers(value)


def write(path: Path, channels: Channels) -> None:
    """Write one channel, or R, G and B."""
    parts = list(channels.values())
    if len(parts) not in (1, 3):
        raise InvalidInputError(f"{path}: a PFM has one channel or three, not {len(parts)}", str(path))
    rows, columns = parts[0].shape
    array = np.stack(parts, axis=-1)[::-1].astype("<f4")
    head = f"P{'F' if len(parts) == 3 else 'f'}\n{columns} {rows}\n-1.0\n"
    write_output(path, head.encode() + array.tobytes())
