"""Signals that ask a run to stop: what has been reached is written first, and the exit code says which signal it was."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator
from types import FrameType
from typing import Any

_ASKING = ("SIGINT", "SIGTERM", "SIGHUP")


class Stopped(KeyboardInterrupt):
    """A signal has asked the run to stop; `code` is what a shell expects of such a process: 128 + the signal's number."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.code = 128 + number


def code_of(stop: BaseException) -> int:
    """Return the exit code after an interruption."""
    return stop.code if isinstance(stop, Stopped) else 128 + signal.SIGINT


@contextlib.contextmanager
def stoppable() -> Iterator[None]:
    """Turn the first signal that asks for an end into `Stopped`; a second one ends the process at once.

    A signal that the process was told to ignore, as `nohup` does, stays ignored.
    """
    before: dict[int, Any] = {}

    def stop(number: int, _frame: FrameType | None) -> None:
        for each in before:
            signal.signal(each, signal.SIG_DFL)
        raise Stopped(number)

    for name in _ASKING:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            before[number] = signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
