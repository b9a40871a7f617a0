"""What every command does that writes into a folder: nobody's files are replaced, and no other run writes there meanwhile."""

from __future__ import annotations

from pathlib import Path

import click

FORCE = click.option("--force", is_flag=True, help="Replace files in the folder that fogproof did not write.")
"""The option; `reports.prepare_folder` is the rule behind it."""


def take(folder: Path, names: tuple[str, ...], force: bool | None = None) -> None:
    """Make `folder`, see that files of these names may be written there, and keep it from other commands until this one ends.

    A command that ends before it has written anything leaves no folder behind.
    """
    from fogproof.reports.files import locked, prepare_folder
    from fogproof.whole_files import absent, remove_empty

    context = click.get_current_context()
    missing = absent(folder)
    context.call_on_close(lambda: remove_empty(missing))
    prepare_folder(folder, names, force)
    context.with_resource(locked(folder))
