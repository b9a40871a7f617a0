"""The console script: signals are heard before fogproof and NumPy are loaded, which takes a while.

A package of its own, because Python runs `fogproof/__init__.py` before any module of it.
"""

from __future__ import annotations

import os
import sys

from fogproof_command.startup import FAULT, end_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn


def main() -> None:
    """Run the command line; a signal before it listens, or after, ends the process with one word and the usual code."""
    try:
        leave_at_the_end()
        prepare()
        from fogproof.cli import main as command_line
    except (Exception, SystemExit) as error:  # a module may end the process with 0, which would be a verdict
        explain(error)
    else:
        command_line()


def leave_at_the_end() -> None:
    """Begin anew without PYTHONINSPECT: Python would stay where we end, and end with a code of its own."""
    if os.environ.pop("PYTHONINSPECT", "") and sys.flags.inspect and os.name == "posix":
        os.execv(sys.executable, sys.orig_argv)


def prepare() -> None:
    """Listen to signals while modules are loaded, hear how children end, and mind the system's limits."""
    import signal  # here, where a file in its place can be named

    asking = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU") if hasattr(signal, name)]
    for number in asking:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)
    if hasattr(signal, "pthread_sigmask"):  # a parent may have left them blocked, as threads do that start programs
        signal.pthread_sigmask(signal.SIG_UNBLOCK, asking)
    child = getattr(signal, "SIGCHLD", None)
    if child is not None and signal.getsignal(child) is signal.SIG_IGN:
        signal.signal(
            child, signal.SIG_DFL
        )  # or the system keeps no exit code of what we start, and Python takes it for 0
    mind_limits()


def explain(error: BaseException) -> NoReturn:
    """End with a sentence that says why modules could not be loaded, and its code."""
    what, code = end_of(error)
    own = "a fault of fogproof's own, please report it with the command: " if code == FAULT else ""
    try:
        os.write(2, f"fogproof: {own}{what}\n".encode("utf-8", "backslashreplace"))
    finally:
        os._exit(code)


def mind_limits() -> None:
    """Keep libraries from what they do not survive where the system limits memory or the size of files."""
    if _limited("RLIMIT_AS"):  # a thread of OpenBLAS reserves memory, and is waited for for ever where it cannot start
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if _limited("RLIMIT_FSIZE"):  # Python keeps bytecode that was cut short, and would fail by it for ever after
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"  # for the processes that we start


def _limited(name: str) -> bool:
    try:
        import resource
    except ImportError:  # not on Windows
        return False
    return resource.getrlimit(getattr(resource, name))[0] != resource.RLIM_INFINITY


def _stop(number: int, _frame: object) -> None:
    try:
        os.write(2, b"fogproof: stopped\n")
    finally:
        os._exit(128 + number)
