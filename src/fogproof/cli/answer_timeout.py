"""The option --timeout of commands that ask the oracle."""

from __future__ import annotations

from collections.abc import Callable

import click

from fogproof.cli.values import SECONDS_OR_NONE
from fogproof.oracle.limits import Limits


def answer_timeout(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command the option: seconds for each answer, 0 for no limit."""
    told = "Seconds for one answer, 0 for no limit."
    option = click.option("--timeout", type=SECONDS_OR_NONE, default=Limits.seconds, show_default=True, help=told)
    return option(command)
