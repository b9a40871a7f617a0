"""The command group; each command is imported when it is called, so that --help stays quick."""

from __future__ import annotations

import importlib
import os
import sys
from typing import Any

import click

from fogproof.errors import FogproofError

_COMMANDS = {
    "verify": "Check every sampler and estimator against its reference.",
    "list": "Show the cases of the catalogue.",
    "oracle": "Answer JSON requests with reference values and error bounds.",
    "golden": "Write reference values with error bounds for offline test suites.",
    "plan": "Say which terms a scene needs, and which methods serve it.",
    "study": "Measure speed against error, resumable, on one core or a cluster.",
    "report": "Make the page of a run again, or compare two runs.",
    "gallery": "Draw the theory's pictures: oracle's curves, estimators' samples.",
}


class _LazyGroup(click.Group):
    """A group whose commands live in modules of the same name."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in _COMMANDS:
            return None
        return importlib.import_module(f"fogproof.cli.{name}_command").command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(_COMMANDS.items()))


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="fogproof")
def cli() -> None:
    """Prove Monte Carlo volume estimators right or wrong."""


def main(arguments: list[str] | None = None) -> Any:
    """Run the command line; every error a user can cause ends in one sentence and exit code 2."""
    try:
        sys.exit(cli.main(arguments, standalone_mode=False))
    except FogproofError as error:
        click.echo(f"fogproof: {error}", err=True)
        sys.exit(2)
    except click.ClickException as error:
        error.show()
        sys.exit(2)
    except (click.Abort, KeyboardInterrupt):
        click.echo("fogproof: stopped", err=True)
        sys.exit(130)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(141)
