"""NumPy's .npy: a header in Python's syntax, then the bytes. Objects are refused: reading them would run code."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import numpy as np

from fogproof.errors import InvalidInputError
from fogproof.images.formats import LARGEST, Channels, layers, too_large
from fogproof.input_files import open_regular, size_of
from fogproof.reports.files import write_output


def read(path: Path) -> Channels:
    """Read an array (rows, columns) or (rows, columns, channels)."""
    with open_regular(path, "the image") as file:
        try:
            version = np.lib.format.read_magic(file)
            header = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                shape, fortran, kind = header[version](file)
        except Exception as error:  # the parser of Python's syntax raises whatever a broken header makes it
            raise InvalidInputError(f"{path}: is not a NumPy array file: {error}", str(path)) from None
        if kind.hasobject or kind.kind not in "fiub":
            raise InvalidInputError(f"{path}: holds {kind}, an image is of numbers", str(path))
        if len(shape) not in (2, 3) or 0 in shape:
            what = f"has shape {list(shape)}, an image is (rows, columns) or (rows, columns, channels)"
            raise InvalidInputError(f"{path}: {what}", str(path))
        count = 1
        for length in shape:
            count *= int(length)
        if count * kind.itemsize > LARGEST:
            raise too_large(path, shape[1], shape[0], shape[2] if len(shape) == 3 else 1)
        rest = size_of(file) - file.tell()
        if rest != count * kind.itemsize:
            what = f"should hold {count * kind.itemsize} bytes of pixels and has {rest}: it is truncated or broken"
            raise InvalidInputError(f"{path}: {what}", str(path))
        array = np.frombuffer(file.read(rest), kind)
    return layers(array.reshape(shape, order="F" if fortran else "C"))


def write(path: Path, channels: Channels) -> None:
    """Write the channels as (rows, columns), or (rows, columns, channels) in their order."""
    parts = list(channels.values())
    content = io.BytesIO()
    np.save(content, parts[0] if len(parts) == 1 else np.stack(parts, axis=-1), allow_pickle=False)
    write_output(path, content.getvalue())
