"""The three streams of the command line: whole writes, whatever a parent left them as, and a stdout that is ours alone."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from typing import TextIO


def take_streams(ours: bool) -> None:
    """Make the streams usable: those that were closed are opened, pipes wait, and stdout is kept for what commands say.

    ours  whether the process is the command line's, not that of a caller whose stdout must stay what it is
    """
    if sys.stderr is None:
        sys.stderr = _nowhere()
    if sys.stdout is None:
        sys.stdout = _unread()
    _let_wait()
    if ours and sys.stdout is sys.__stdout__ and isinstance(sys.stdout, io.TextIOWrapper):
        _keep_stdout(sys.stdout)


def leave_stdout(ours: bool) -> None:
    """Let what others still print, in threads or at Python's end, go to stderr: all has been said."""
    if ours and sys.stdout is not sys.__stdout__:
        sys.stdout = sys.stderr


def silence(stream: TextIO) -> None:
    """Let what a stream still holds go nowhere, and all that follows: Python would try again at its end, and complain."""
    with contextlib.suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _keep_stdout(out: io.TextIOWrapper) -> None:
    """Put a stdout of our own in the place of Python's, and stderr in the place of descriptor 1.

    Code of others that is loaded here, and every process that is started, writes to that descriptor: `print` is the least of it,
    there are `os.write(1, ...)`, printf in C, and shells. Its buffer writes all it is given: unbuffered (PYTHONUNBUFFERED), Python
    takes a part of it for the whole, without a word.
    """
    out.flush()
    raw = io.BufferedWriter(io.FileIO(os.dup(1), "wb"))
    sys.stdout = io.TextIOWrapper(raw, out.encoding, out.errors, line_buffering=True, write_through=True)
    os.dup2(2, 1)


def _let_wait() -> None:
    """Let reading and writing wait where a parent left its pipes non-blocking: Python would lose what is under way."""
    for number in range(3):
        with contextlib.suppress(OSError, AttributeError):  # one that is closed
            os.set_blocking(number, True)


def _nowhere() -> TextIO:
    """Return what stands for a stderr that was closed before the start; no file that is opened later takes its number."""
    opened = os.open(os.devnull, os.O_WRONLY)
    if opened != 2:  # stdin is closed, too
        os.dup2(opened, 2)
        os.close(opened)
    return open(2, "w", encoding="utf-8", closefd=False)


def _unread() -> TextIO:
    """Return what stands for a stdout that was closed before the start: a pipe that nobody reads. No file gets its number."""
    try:
        os.fstat(1)
    except OSError:
        os.dup2(2, 1)
    reading, writing = os.pipe()
    os.close(reading)
    return open(writing, "w", encoding="utf-8")
