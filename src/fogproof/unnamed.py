"""Files without a name, for what forked processes tell: nobody can remove them, and nothing is left of them."""

from __future__ import annotations

import contextlib
import os
import tempfile


def unnamed_file() -> int | None:
    """Return the descriptor of a new one, in memory where the system has that; None where nothing forks or there is no place."""
    if not hasattr(os, "fork"):
        return None
    with contextlib.suppress(OSError, AttributeError):
        return os.memfd_create("fogproof")
    with contextlib.suppress(OSError), tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())
    return None
