"""Files of JSON that runs add to, a table a line: what a kill or a full disk cuts short is the last line, and it alone is lost."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path
from typing import Any

from fogproof.errors import InvalidInputError


def add_line(path: Path, record: Any) -> None:
    """Add a table, whole or not at all, in the place of a last line that is not whole; a fault is an `InvalidInputError`."""
    line = json.dumps(record).encode() + b"\n"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a+b") as file:
            file.seek(0)
            content = file.read()
            end = len(content) - len(_cut_short(content))
            file.truncate(end)
            try:
                file.write(line if content[:end].endswith(b"\n") or not end else b"\n" + line)
                file.flush()
            except OSError:
                with contextlib.suppress(OSError):
                    os.truncate(path, end)
                raise
    except OSError as error:
        raise InvalidInputError(f"cannot write {path}: {error.strerror or error}", str(path)) from None


def whole_lines(text: str) -> list[str]:
    """Return the lines without one that was cut short, and without the bytes of zero that a power failure may leave."""
    whole = text[: len(text) - len(_cut_short(text.encode()).decode())]
    return [line for held in whole.splitlines() if (line := held.strip("\0"))]


def _cut_short(content: bytes) -> bytes:
    """Return what a last line has got of a table, if it has no end; anything else is not ours to drop."""
    last = content[content.rfind(b"\n") + 1 :]
    if not last.startswith(b"{"):
        return b""
    try:
        json.loads(last)
    except (ValueError, RecursionError):
        return last
    return b""
