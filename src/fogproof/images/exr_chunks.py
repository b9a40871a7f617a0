"""Where the pixels of an OpenEXR file end: what follows them no reader looks at, so it would be lost without a word.

Layout after the OpenEXR project's "File Layout" document: magic number, version, a header a part, a table of the places of all
chunks, the chunks. A chunk begins with its part's number where there are several; its line or the four numbers of its tile
follow, and its size.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import BinaryIO

_TILED, _PARTS = 0x200, 0x1000  # flags of the version
_LONGEST = 256  # bytes of a name, with its zero


def end_of_chunks(file: BinaryIO, tiled: Sequence[bool]) -> int | None:
    """Return where the last chunk ends, None where the table of chunks does not tell.

    tiled  whether each part is of tiles
    """
    file.seek(4)
    try:
        (version,) = _numbers(file, "<I")
        several = bool(version & _PARTS)
        for _ in tiled:
            _pass_header(file)
        if several:
            file.seek(1, 1)  # the empty header that ends them
        last = _last_chunk(file)
        file.seek(last)
        part = _numbers(file, "<i")[0] if several else 0
        file.seek(16 if tiled[part] else 4, 1)
        (size,) = _numbers(file, "<i")
        return file.tell() + int(size)
    except (struct.error, IndexError, ValueError):
        return None


def _numbers(file: BinaryIO, kind: str) -> tuple[int, ...]:
    return struct.unpack(kind, file.read(struct.calcsize(kind)))


def _name(file: BinaryIO) -> bytes:
    start = file.tell()
    name, zero, _ = file.read(_LONGEST).partition(b"\0")
    if not zero:
        raise ValueError("a name has no end")
    file.seek(start + len(name) + 1)
    return name


def _pass_header(file: BinaryIO) -> None:
    while _name(file):
        _name(file)  # its type
        (size,) = _numbers(file, "<i")
        if size < 0:
            raise ValueError("an attribute has a negative size")
        file.seek(size, 1)


def _last_chunk(file: BinaryIO) -> int:
    """Return the largest place in the table, which ends where the first chunk begins."""
    at = file.tell()
    first, last = 1 << 62, 0
    while at < first:
        (place,) = _numbers(file, "<Q")
        at += 8
        if place < at:
            raise ValueError("a chunk lies before its table")
        first, last = min(first, place), max(last, place)
    return last
