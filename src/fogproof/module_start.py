"""What `python -m fogproof` does before anything else is loaded: it becomes what the console script is.

Python searches the folder one stands in first, and a file there may bear the name of any module. What fails all the same, because
of a file in PYTHONPATH, ends in a sentence: Python runs `fogproof/__init__.py`, which loads NumPy, before our command line listens.
"""

from __future__ import annotations

import importlib
import os
import sys


def begin() -> None:
    """Leave the folder one stands in out of the search, unless it holds fogproof itself; hear signals; explain failures."""
    if sys.orig_argv[-len(sys.argv)] not in ("fogproof", "-mfogproof"):  # somebody else's module, which loads us
        return
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    if not sys.flags.safe_path and os.path.realpath(sys.path[0]) != os.path.realpath(home):
        del sys.path[0]
    from fogproof_command import explain, prepare

    sys.excepthook = lambda kind, error, trace: explain(error)
    try:
        prepare()
        importlib.import_module("fogproof.domains")  # NumPy; a module that ends the process would end it without a word
        importlib.import_module("fogproof.cli")
    except (Exception, SystemExit) as error:
        explain(error)


if sys.argv[:1] == ["-m"]:  # while Python looks for the module; by the command line alone
    begin()
