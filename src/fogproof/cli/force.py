"""What every command does that writes into a folder: nobody's files are replaced, and no other run writes there meanwhile."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import click

from fogproof.errors import InvalidInputError

FORCE = click.option("--force", is_flag=True, help="Replace files in the folder that fogproof did not write.")
"""The option; `reports.prepare_folder` is the rule behind it."""


def take(folder: Path, names: tuple[str, ...], force: bool) -> None:
    """Make `folder`, see that files of these names may be written there, and keep it from other commands until this one ends.

    The lock is the folder's own: no file is left, and a process that is killed holds it no more. Systems of files without locks
    have none.
    """
    from fogproof.reports.files import prepare_folder

    prepare_folder(folder, names, force)
    try:
        import fcntl
    except ImportError:  # Windows
        return
    with contextlib.suppress(OSError):
        opened = os.open(folder, os.O_RDONLY)
        click.get_current_context().call_on_close(lambda: os.close(opened))
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            what = f"another run of fogproof writes into {folder}; wait for its end, or choose another folder"
            raise InvalidInputError(what, str(folder)) from None
