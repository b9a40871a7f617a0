"""Writing to a terminal: whatever names and messages from outside hold, it cannot move the cursor, set titles or reorder text."""

from __future__ import annotations

import contextlib
import math
import os
import sys
import time
from collections.abc import Iterator
from typing import BinaryIO

import click

from fogproof.cli.streams import silence
from fogproof.doing import heard_by
from fogproof.errors import InvalidInputError
from fogproof.text import one_line, visible

FAULT = 70
"""Exit code after a fault of our own."""
BAD_INPUT = 2
"""The exit code for usage, bad input, and no room, memory or permission."""


UNREAD = 141
"""The exit code where nobody reads stdout: 128 + SIGPIPE, as a shell tells it."""

_CODE = "fogproof.code"
_NARROW = 80  # columns of a terminal that does not say
_SHOWN = 0.2  # seconds that a line stands at least


def say(text: object = "", err: bool = False) -> None:
    """Print text with its control characters, bidirectional overrides and lone surrogates made visible; new lines stay.

    A stream that takes no more ends nothing, so that no verdict is lost with a row: the command goes on to its end, and
    `code_of_stdout` tells what stands in the place of 0.
    """
    try:
        click.echo(visible(str(text)), err=err)
    except OSError as error:
        if err:
            silence(sys.stderr)
            return
        context = click.get_current_context(silent=True)
        if context is None:
            raise
        silence(sys.stdout)
        unread = isinstance(error, BrokenPipeError)
        context.meta[_CODE] = UNREAD if unread else BAD_INPUT
        if not unread:
            say(f"fogproof: cannot write to stdout: {error.strerror or error}", err=True)


@contextlib.contextmanager
def what_is_done() -> Iterator[None]:
    """Show on one line of stderr what is being done, where that is a terminal, and clear the line at the end."""
    if not sys.stderr.isatty():
        yield
        return
    shown = -math.inf

    def show(what: str) -> None:
        nonlocal shown
        if time.monotonic() - shown >= _SHOWN:
            shown = time.monotonic()
            _draw(one_line(what)[: _columns() - 1])

    try:
        with heard_by(show):
            yield
    finally:
        _draw("")


def _columns() -> int:
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or _NARROW
    except OSError:
        return _NARROW


def _draw(line: str) -> None:
    with contextlib.suppress(OSError):
        sys.stderr.write(f"\r\x1b[K{line}")
        sys.stderr.flush()


def code_of_stdout(context: click.Context) -> int:
    """Return the exit code for a stdout that took no more while the command went on, 0 if all was well."""
    return int(context.meta.get(_CODE, 0))


def requests_on_stdin() -> BinaryIO:
    """Return stdin's bytes; an `InvalidInputError` if it is closed."""
    if sys.stdin is None:
        raise InvalidInputError("stdin is closed; give requests on it, or in a file")
    return sys.stdin.buffer
