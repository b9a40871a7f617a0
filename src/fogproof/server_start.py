"""What the server of processes does first (`servers`): leave our session, put its environment right, load what takes long."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys

from fogproof.servers import OURS, PRELOAD


def begin(modules: list[str]) -> None:
    """Begin a server. A module that cannot be loaded is for those to find who need it."""
    sys.excepthook = lambda kind, error, trace: None  # whoever asked says it: that too many files are open, say
    with contextlib.suppress(OSError, AttributeError):  # it leads one already; a system without sessions
        os.setsid()
    with contextlib.suppress(OSError):
        os.dup2(2, 1)  # what other people's code prints, in whatever way, is no part of an answer
    if os.environ.get("PYTHONSAFEPATH") == OURS:
        del os.environ["PYTHONSAFEPATH"]
    for module in modules:
        with contextlib.suppress(Exception, SystemExit):
            importlib.import_module(module)


if PRELOAD in os.environ:  # by the server alone
    begin(os.environ.pop(PRELOAD).split(","))
