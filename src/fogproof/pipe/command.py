"""The command that starts somebody's program: words as a shell splits them, but no shell reads them."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence

from fogproof.errors import InvalidInputError


def words_of(command: str | Sequence[str]) -> list[str]:
    """Return the command and its arguments, or raise `InvalidInputError`."""
    try:
        words = shlex.split(command) if isinstance(command, str) else list(command)
    except ValueError as error:
        raise InvalidInputError(f"--exec is no command line: {error}, in {command!r}", "--exec") from None
    if not words or not words[0]:
        raise InvalidInputError("--exec is empty; give a program and its arguments", "--exec")
    return words


def cannot_start(name: str, error: OSError | ValueError) -> InvalidInputError:
    """Return what to say of a command that does not start."""
    reason = getattr(error, "strerror", None) or str(error)
    folder = "" if "/" in name else f", and a program in this folder is ./{name}"
    shell = f"; no shell reads the command{folder}" if not os.path.isabs(name) else ""
    return InvalidInputError(f"cannot start {name!r}: {reason}{shell}", "--exec")
