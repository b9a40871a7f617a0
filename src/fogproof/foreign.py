"""Loading code that others wrote: it may fail, but it may not end the program that reads it without a word."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
from collections.abc import Iterator
from typing import NoReturn

from fogproof.errors import is_stop


class EndedProcessError(Exception):
    """Code that was only to be loaded asked for the end of the process."""


_BESIDE: set[str] = set()


def import_from(folder: str) -> None:
    """Let modules beside other people's code be imported, before those that are installed, as Python does where a file is run."""
    if folder not in sys.path:
        _BESIDE.add(folder)
        sys.path.insert(0, folder)


def installed_path() -> list[str]:
    """Return where modules are looked for apart from what lies beside other people's code."""
    return [folder for folder in sys.path if folder not in _BESIDE]


@contextlib.contextmanager
def loading() -> Iterator[None]:
    """Turn every way in which Python code ends its process into `EndedProcessError`, while other people's code is loaded.

    `os._exit(0)` at the top of a file of cases would otherwise look like a run in which nothing was rejected. No bytecode is
    written beside such code: it would hide an edit within the same second that leaves the length of the file as it was.
    """

    ours = threading.get_ident()

    def ended(status: int) -> NoReturn:
        if threading.get_ident() != ours:  # our own watch ends a process whose parent is gone
            leave(status)
        raise EndedProcessError(f"the code ends the process, exit code {status}")

    leave, os._exit = os._exit, ended
    kept, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield
    except SystemExit as error:
        ended_by = EndedProcessError(f"the code ends the process, exit code {error.code or 0}")
        raise ended_by.with_traceback(error.__traceback__) from error
    except BaseException as error:
        if isinstance(error, Exception) or is_stop(error):
            raise
        ended_by = EndedProcessError(f"the code raises {type(error).__name__}, which would end the process")
        raise ended_by.with_traceback(error.__traceback__) from error
    finally:
        os._exit = leave
        sys.dont_write_bytecode = kept
