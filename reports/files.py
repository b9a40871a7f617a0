"""Files that are there whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from fogproof.errors import InvalidInputError


def prepare_folder(folder: Path) -> None:
    """Make `folder` and see that it can be written: better to learn that before a run than after it."""
    probe = folder / f".probe.{os.getpid()}"
    write_file(probe, b"")
    probe.unlink(missing_ok=True)


def write_file(path: Path, content: str | bytes) -> Path:
    """Put `content` at `path` whole or not at all, making folders on the way; a fault is an `InvalidInputError`."""
    data = content if isinstance(content, bytes) else content.encode("utf-8")
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            beside.write_bytes(data)
            os.replace(beside, path)
        finally:
            beside.unlink(missing_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InvalidInputError(
            f"cannot write {path}: {reason}; choose a folder that can be written", str(path)
        ) from None
    return path
