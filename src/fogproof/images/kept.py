"""What a scene's folder keeps of its render: the row, and checksums by which each of its files is known to be what was written."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogproof.images.formats import LARGEST
from fogproof.whole_files import write_file

RECORD = "row.json"
IMAGES = ("image.exr", "image.exr.npy")
"""What a renderer writes: one of these."""
_OUTCOMES = ("not rejected", "rejected", "inconclusive", "not rendered")  # what went wrong may go well now


@dataclass(frozen=True)
class Kept:
    """A row of an earlier run.

    image    the render, None if it is not what it was
    changed  whether any file is missing or another than was written
    """

    row: Mapping[str, Any]
    image: Path | None
    changed: bool


def begin(place: Path, key: str) -> None:
    """Note that a row is under way before anything else is written: wherever the run is stopped, the folder is known as ours."""
    write_file(place / RECORD, json.dumps({"format": "fogproof-row-2", "key": key, "state": "unfinished"}, indent=1))


def keep(place: Path, key: str, row: Mapping[str, Any], names: Iterable[str]) -> None:
    """Keep a row, with the checksums of those files of these names that are there."""
    files = {name: digest for name in names if name != RECORD and (digest := digest_of(place / name))}
    told = {"key": key, "row": row, "files": files}
    record = {"format": "fogproof-row-2", "state": "finished", **told, "digest": _digest_of(told)}
    write_file(place / RECORD, json.dumps(record, indent=1))


def kept(place: Path, key: str) -> Kept | None:
    """Return the row that was kept under a key, None if there is none, or if it is not what was written."""
    try:
        record = json.loads((place / RECORD).read_bytes())
        told = {name: record[name] for name in ("key", "row", "files")}
        if record["digest"] != _digest_of(told) or told["key"] != key or told["row"]["outcome"] not in _OUTCOMES:
            return None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    whole = {name for name, digest in told["files"].items() if digest_of(place / name) == digest}
    image = next((place / name for name in IMAGES if name in whole), None)
    return Kept(told["row"], image, len(whole) < len(told["files"]))


def digest_of(path: Path) -> str:
    """Return the checksum of a file, "" if there is none that can be read, or it is larger than any image of ours."""
    try:
        if not path.is_file() or path.stat().st_size > 2 * LARGEST:
            return ""
        with path.open("rb") as file:
            return hashlib.file_digest(file, "blake2b").hexdigest()[:32]
    except OSError:
        return ""


def _digest_of(told: Mapping[str, Any]) -> str:
    return hashlib.blake2b(json.dumps(told, sort_keys=True).encode(), digest_size=16).hexdigest()
