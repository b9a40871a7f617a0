"""A rejection is told by the exit code, whatever cannot be written after it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from fogproof.cli.terminal import say
from fogproof.errors import FogproofError

REJECTED = 1


@contextlib.contextmanager
def writing_after(code: int) -> Iterator[None]:
    """Write what a run has come to, which ends with `code`: if that says that something was rejected, a fault is only told."""
    try:
        yield
    except FogproofError as error:
        if code != REJECTED:
            raise
        say(f"fogproof: {error}", err=True)
