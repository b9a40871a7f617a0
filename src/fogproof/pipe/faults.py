"""What goes wrong with somebody's program, in words."""

from __future__ import annotations

import contextlib
import signal

from fogproof.errors import SubjectError
from fogproof.text import one_line

BROKEN = "broken protocol"
"""The class of a fault that is neither an end nor a silence."""

REFUSES = "reports an error"
"""The class of a line with an error: the program keeps the protocol and says itself what is wrong."""

HANGS, SHORT, BUFFERS = "hangs", "answers short", "does not flush"
"""The classes of a silence: nothing comes; it waits for us; its answer stands in a buffer of its own."""


class ProgramError(SubjectError):
    """The program died, hung, or broke the protocol; the message holds what it printed, `cause` is the class of the fault."""

    def __init__(self, message: str, cause: str) -> None:
        super().__init__(message, "--exec")
        self.cause = cause


def end_of(code: int) -> str:
    """Return in words how a process ended."""
    if code >= 0:
        return f"ended with exit code {code}"
    with contextlib.suppress(ValueError):
        return f"was killed by {signal.Signals(-code).name}"
    return f"was killed by signal {-code}"


def quoted(data: bytes) -> str:
    """Return the beginning of some bytes as people read it."""
    text = one_line(data[:80].decode("utf-8", "replace"))
    return f"{text!r}{'...' if len(data) > 80 else ''}"
