"""Signals that ask a run to stop: what has been reached is written first, and the exit code says which signal it was.

The command line listens from its start to its end (`stoppable`). A command's long loop stands in `interruptible`: a signal ends the
loop, and one that comes later, while the page is written, waits until that is done.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType
from typing import Any

from fogproof.errors import Stopped, stop_behind

_ASKING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU")
_REPEATED = getattr(signal, "SIGXCPU", 0)
"""The signal that the system sends again every second, and nobody means more by it."""
PATIENCE = 1.0
"""Seconds after the first signal during which others are taken for the same; a later one ends the process at once."""


def code_of(stop: BaseException) -> int:
    """Return the exit code after an interruption."""
    return stop.code if isinstance(stop, Stopped) else 128 + signal.SIGINT


@dataclass
class Listening:
    """What has been heard so far: the first signal's number or 0, when [s], and whether it waits for what is being written."""

    number: int = 0
    at: float = 0.0
    held: bool = False

    def hear(self, number: int, _frame: FrameType | None) -> None:
        """Raise `Stopped` for the first signal; one that comes soon after belongs to it, a later one ends the process."""
        if not self.number:
            self.number, self.at = number, time.monotonic()
            if not self.held:
                raise Stopped(number)
        elif number != _REPEATED and time.monotonic() - self.at > PATIENCE:
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)

    hear.raises_stopped = True  # type: ignore[attr-defined]  # what `is_stop` asks of a handler

    @property
    def code(self) -> int:
        """The exit code that the signal asks for, 0 if there was none."""
        return 128 + self.number if self.number else 0


_now = Listening()


@contextlib.contextmanager
def stoppable() -> Iterator[Listening]:
    """Turn the first signal that asks for an end into `Stopped`.

    A signal that the process was told to ignore, as `nohup` does, stays ignored.
    """
    global _now
    listening, outside = Listening(), _now
    before: dict[int, Any] = {}
    _now = listening
    here = threading.current_thread() is threading.main_thread()  # no other thread may ask for signals
    for name in _ASKING:
        number = getattr(signal, name, None) if here else None
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            before[number] = signal.signal(number, listening.hear)
    try:
        yield listening
    finally:
        _now = outside
        for number, handler in before.items():
            signal.signal(number, handler)


@dataclass
class Interruption:
    """Whether an interruptible block was stopped: the exit code for it, 0 if it came to its end."""

    code: int = 0


@contextlib.contextmanager
def interruptible() -> Iterator[Interruption]:
    """Run a block that a signal may end; after it signals wait for the end of the command, which writes what was reached."""
    interruption = Interruption()
    try:
        yield interruption
    except BaseException as error:
        stop = stop_behind(error)
        if stop is None:
            raise
        interruption.code = code_of(stop)
    finally:
        _now.held = True
