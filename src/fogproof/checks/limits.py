"""A time limit for subjects that may never return: the check runs in a process of its own, which can be ended."""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
import os
import sys
import threading
from collections.abc import Callable
from typing import TypeVar

from fogproof.errors import FogproofError, SubjectError, UnsupportedError
from fogproof.validate import number

Answer = TypeVar("Answer")


def within(seconds: float, check: Callable[[], Answer]) -> Answer:
    """Return check(), or raise `SubjectError` if it has not returned after so many seconds.

    The check runs in a forked copy of this process, so it may be any closure; what it returns must be picklable, as a `Verdict`
    is. A loop in compiled code that never looks at signals is ended all the same. Needs a system that can fork.
    """
    number("seconds", seconds, "must be > 0 [s]", 0, open_ends=True)
    if sys.platform == "win32" or "fork" not in multiprocessing.get_all_start_methods():
        raise UnsupportedError("a time limit needs a system that can fork: run the check in a process of your own")
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    child = context.Process(target=_answer, args=(check, theirs), daemon=True)
    child.start()
    theirs.close()
    try:
        if not ours.poll(seconds):
            raise SubjectError(f"the subject did not return within {seconds:g} s", "sample")
        try:
            good, answer = ours.recv()
        except EOFError:
            child.join()
            raise SubjectError(f"the subject ended the process, exit code {child.exitcode}", "sample") from None
    finally:
        child.kill()
        child.join()
        ours.close()
    if not good:
        raise SubjectError(*answer)
    return answer


def _answer(check: Callable[[], object], pipe: multiprocessing.connection.Connection) -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    try:
        pipe.send((True, check()))
    except FogproofError as error:
        pipe.send((False, (str(error), error.path)))
    except Exception as error:  # the parent must hear of it, whatever it is
        pipe.send((False, (f"{type(error).__name__}: {error}", "sample")))


def _end_with(sentinel: int) -> None:
    """End this process when its parent has ended: nobody would wait for the answer."""
    multiprocessing.connection.wait([sentinel])
    os._exit(1)
