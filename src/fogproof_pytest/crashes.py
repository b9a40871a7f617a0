"""What a worker of xdist had found when it ended: every verdict stands in a file that it and the session have open.

The file has no name any more when the first test begins, so that nobody can remove it, and nothing is left of it. Only pytest's own
is imported here.
"""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Callable
from typing import Any

import pytest

_PATH = "fogproof_journal"
_SESSIONS, _WORKERS = pytest.StashKey[dict[str, int]](), pytest.StashKey[int]()
"""Descriptors of these files: the session's by the name of the worker, a worker's own."""


def begin(node: Any) -> None:
    """Make the file of a worker that is to be started."""
    with contextlib.suppress(OSError):  # no place for one
        number, path = _file()
        opened = node.config.stash.setdefault(_SESSIONS, {})
        if not opened:
            node.config.add_cleanup(lambda: _close(opened))
        opened[node.gateway.id] = number
        node.workerinput[_PATH] = path


def open_own(config: pytest.Config) -> None:
    """Open the file that the session has made for this worker, if it is one; one on another machine finds none."""
    if path := getattr(config, "workerinput", {}).get(_PATH):
        with contextlib.suppress(OSError):
            number = config.stash[_WORKERS] = os.open(path, os.O_WRONLY | os.O_APPEND)
            config.add_cleanup(lambda: os.close(number))
            os.unlink(path)  # one in memory has no name


def keeper(config: pytest.Config) -> Callable[[str, dict[str, Any] | None, str], None]:
    """Return what writes down a verdict of a test, and why it fails that test or "", in a worker and in what it forks."""
    number = config.stash.get(_WORKERS, None)
    if number is None:
        return lambda *_: None

    def keep(*found: object) -> None:
        os.write(number, json.dumps(found).encode() + b"\n")

    return keep


def found(node: Any, test: str) -> list[tuple[Any, ...]]:
    """Return what a test had found in a worker: the test, a number, the verdict in plain data, why it fails the test or ""."""
    number = node.config.stash.get(_SESSIONS, {}).get(node.gateway.id)
    if number is None:
        return []
    os.lseek(number, 0, os.SEEK_SET)
    with os.fdopen(os.dup(number), "rb") as file:
        whole = [json.loads(line) for line in file if line.endswith(b"\n")]
    return [(of, place, verdict, why) for place, (of, verdict, why) in enumerate(w for w in whole if w[0] == test)]


def _close(opened: dict[str, int]) -> None:
    while opened:
        os.close(opened.popitem()[1])


def _file() -> tuple[int, str]:
    """Return a descriptor and a path of a new file, in memory where the system has that."""
    with contextlib.suppress(OSError, AttributeError):
        number = os.memfd_create("fogproof")
        path = f"/proc/{os.getpid()}/fd/{number}"
        if os.path.exists(path):
            return number, path
        os.close(number)
    return tempfile.mkstemp(prefix="fogproof-")
