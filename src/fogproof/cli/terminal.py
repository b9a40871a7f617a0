"""Writing to a terminal: whatever names and messages from outside hold, it cannot move the cursor, set titles or reorder text."""

from __future__ import annotations

import click

from fogproof.text import visible


def say(text: object = "", err: bool = False) -> None:
    """Print text with its control characters, bidirectional overrides and lone surrogates made visible; new lines stay."""
    click.echo(visible(str(text)), err=err)
