"""The console script: signals are heard before fogproof and NumPy are loaded, which takes a while.

A package of its own, because Python runs `fogproof/__init__.py` before any module of it.
"""

import os
import signal


def main() -> None:
    """Run the command line; a signal before it listens, or after, ends the process with one word and the usual code."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)
    from fogproof.cli import main as command_line

    command_line()


def _stop(number: int, _frame: object) -> None:
    try:
        os.write(2, b"fogproof: stopped\n")
    finally:
        os._exit(128 + number)
