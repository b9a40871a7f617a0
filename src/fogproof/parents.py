"""A parent of its own for each process in which other people's code runs, so that code that kills its parent harms nobody else.

The server of processes is the parent of all that it forks: without it nothing more could be started, and nobody would know whose
fault that was. A process that calls `stand_between` goes on in a child; what it was only waits, and ends as the child does. Whoever
has been killed may take some milliseconds to end: `confirm` asks for an answer, which a process that is being killed cannot give.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NoReturn

KILLED = "the subject killed the process that had started it (its parent, or that one's group); let it end what it started alone"
_PATIENCE = 10.0
"""Seconds that an answer may take: a subject may have stopped its parent, which harms nobody."""


@dataclass(frozen=True)
class _Parent:
    """Two pipes to the process that waits for this one; `pipe` is the device and inode of that for questions."""

    questions: int
    answers: int
    pipe: tuple[int, int]
    answered: threading.Semaphore = field(default_factory=lambda: threading.Semaphore(0))

    def watch(self, alone: Callable[[], object]) -> None:
        with contextlib.suppress(OSError):  # a subject may have closed it
            while os.read(self.answers, 1):
                self.answered.release()
            alone()
            os._exit(1)


_parent: _Parent | None = None


def stand_between(alone: Callable[[], object]) -> None:
    """Lead a session, and go on in a child of this process, which only waits for it.

    Called before there are threads. Where nothing can be forked, nobody stands between.

    alone  called in a thread when the parent has been killed, before this process ends
    """
    global _parent
    if not hasattr(os, "fork"):
        return
    with contextlib.suppress(OSError):  # signals to our parent's group are not for us, nor the subject's for that group
        os.setsid()
    try:
        asked, questions = os.pipe()
        answers, told = os.pipe()  # its writing end is the parent's alone: it closes when that ends
        child = os.fork()
    except OSError:
        return
    if child:
        os.close(questions)
        os.close(answers)
        _wait_for(child, asked, told)
    os.close(asked)
    os.close(told)
    _parent = _Parent(questions, answers, _identity(questions))
    try:
        threading.Thread(target=_parent.watch, args=(alone,), daemon=True).start()
    except RuntimeError:  # where no more threads may be started nothing watches
        _parent = None


def confirm() -> None:
    """Return if nobody has killed the process that waits for this one; end with it otherwise."""
    parent = _parent
    with contextlib.suppress(OSError):
        if parent is not None and _identity(parent.questions) == parent.pipe:  # the subject may have closed it
            with contextlib.suppress(BrokenPipeError):  # it has ended: so will we
                os.write(parent.questions, b"?")
            os.kill(os.getppid(), signal.SIGCONT)  # a subject may have stopped it: it would neither answer nor end
            parent.answered.acquire(timeout=_PATIENCE)


def _identity(descriptor: int) -> tuple[int, int]:
    found = os.fstat(descriptor)
    return found.st_dev, found.st_ino


def _wait_for(child: int, asked: int, told: int) -> NoReturn:
    code = 1
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        with contextlib.suppress(RuntimeError):  # where no more threads may be started nobody answers
            threading.Thread(target=_answer, args=(asked, told), daemon=True).start()
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if code < 0:
            signal.signal(-code, signal.SIG_DFL)
    except (OSError, ValueError):  # exit codes of children are not kept; SIGKILL needs no such thing
        pass
    finally:
        if code < 0:
            os.kill(os.getpid(), -code)
        os._exit(code)


def _answer(asked: int, told: int) -> None:
    with contextlib.suppress(OSError):
        while question := os.read(asked, 1):
            os.write(told, question)
