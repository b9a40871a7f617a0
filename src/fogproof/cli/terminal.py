"""Writing to a terminal: whatever names and messages from outside hold, it cannot move the cursor, set titles or reorder text."""

from __future__ import annotations

import sys
from typing import BinaryIO

import click

from fogproof.errors import InvalidInputError
from fogproof.text import visible


def say(text: object = "", err: bool = False) -> None:
    """Print text with its control characters, bidirectional overrides and lone surrogates made visible; new lines stay."""
    click.echo(visible(str(text)), err=err)


def requests_on_stdin() -> BinaryIO:
    """Return stdin's bytes; an `InvalidInputError` if it is closed."""
    if sys.stdin is None:
        raise InvalidInputError("stdin is closed; give requests on it, or in a file")
    return sys.stdin.buffer
