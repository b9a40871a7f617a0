"""Files that are there whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from fogproof.errors import InvalidInputError


def prepare_folder(folder: Path, page: str = "index.html", record: str = "results.json", force: bool = False) -> None:
    """Make `folder` and see that it can be written, and that no page of somebody else's is replaced.

    A page is ours if the record it was made from stands beside it. Better to learn all that before a run than after it.

    force  replace whatever page is there
    """
    if (folder / page).exists() and not (folder / record).exists() and not force:
        what = f"{folder / page} was not written by fogproof, for no {record} stands beside it"
        raise InvalidInputError(f"{what}; choose another folder, or add --force to replace it", str(folder / page))
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
