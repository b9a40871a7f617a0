"""Files that are there whole or not at all."""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from fogproof.errors import InvalidInputError

_LONGEST = 200
"""Bytes of a name that has room for more: most systems of files allow 255."""


def write_file(path: Path, content: str | bytes) -> Path:
    """Put `content` at `path` whole or not at all, making folders on the way; a fault is an `InvalidInputError`."""
    beside = path.with_name(begun(short_name(path.name), os.getpid()))
    missing = absent(path.parent)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            beside.write_bytes(content_bytes(content))
            os.replace(beside, path)
        finally:
            beside.unlink(missing_ok=True)
    except (OSError, ValueError) as error:
        remove_empty(missing)
        reason = _no_folder(path.parent) or getattr(error, "strerror", None) or error
        raise InvalidInputError(
            f"cannot write {path}: {reason}; choose a folder that can be written", str(path)
        ) from None
    return path


def content_bytes(content: str | bytes) -> bytes:
    """Return what a file holds; a lone surrogate, which no UTF-8 has, is a question mark."""
    return content if isinstance(content, bytes) else content.encode("utf-8", "replace")


def begun(name: str, process: int | str) -> str:
    """Return the name under which a process begins a file: hidden, and known as ours wherever it is left."""
    return f".{name}.{process}.fogproof"


def short_name(name: str) -> str:
    """Return a name, or what stands for one that is long."""
    raw = os.fsencode(name)
    return name if len(raw) <= _LONGEST else hashlib.blake2b(raw, digest_size=16).hexdigest()


def _no_folder(folder: Path) -> str:
    """Return in words which part of a folder's path is no folder, "" if none is."""
    with contextlib.suppress(OSError, ValueError):
        for place in (folder, *folder.parents):
            if place.is_symlink() and not place.exists():
                return f"{place} is a link that leads nowhere"
            if place.exists():
                return "" if place.is_dir() else f"{place} is a file, no folder"
    return ""


def absent(folder: Path) -> list[Path]:
    """Return which folders of a path are not there yet, the innermost first."""
    with contextlib.suppress(OSError, ValueError):
        return [place for place in (folder, *folder.parents) if not os.path.lexists(place)]
    return []


def remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders that nothing was written into, the innermost first."""
    for folder in folders:
        with contextlib.suppress(OSError, ValueError):
            folder.rmdir()
