"""What one request may cost: how long its line, how deep its lists, how many numbers in its answer, how many seconds."""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable
from dataclasses import dataclass, fields
from types import FrameType
from typing import Any, TypeVar

import numpy as np

from fogproof.errors import InvalidValueError, TimeLimitError, TooLargeError
from fogproof.quantities import Quantity
from fogproof.scene.arrays import Count
from fogproof.validate import LONGEST

Answer = TypeVar("Answer")

DEEPEST = 64
"""Levels of lists and tables in a request: NumPy has as many axes."""


AGAIN = 0.05
"""Seconds after which an alarm that came at a bad moment rings again."""


@dataclass(frozen=True)
class Limits:
    """Bounds on a single request.

    values   numbers in one answer
    seconds  until an answer is given up; inf, as all beyond 1e6, for no limit, and where the system has no alarm (on Windows, in
             threads)
    bytes    length of a line
    """

    values: int = 1_000_000
    seconds: float = 60.0
    bytes: int = 64 << 20

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, bool) or not isinstance(value, int | float) or not value > 0:
                raise InvalidValueError(field.name, "must be a number > 0", value)


def require_size(quantity: Quantity, arguments: dict[str, Any], most: int) -> None:
    """Refuse arrays that do not broadcast, and an answer of more than `most` numbers, before memory is taken for it."""
    shapes: dict[str, tuple[int, ...]] = {}
    size = 1
    for path, mark in quantity.arrays.items():
        array = _at(arguments, path)
        if not isinstance(array, np.ndarray):
            continue
        if mark.table:
            size *= array.size
        else:
            shapes[path] = array.shape[: array.ndim - mark.axes]
    try:
        size *= math.prod(np.broadcast_shapes(*shapes.values()))
    except ValueError:
        listed = ", ".join(f"{path} {list(shape)}" for path, shape in shapes.items())
        raise InvalidValueError(
            next(iter(shapes)), "must broadcast with the other arrays", listed, "axes must be equal or 1"
        ) from None
    for name, declared in quantity.arguments.items():
        if Count in (declared if isinstance(declared, tuple) else (declared,)):
            size *= max(arguments[name], 0) + 1
    size *= max(arguments.get("channels") or 1, 1)
    if size > most:
        raise TooLargeError(f"{quantity.name}: the answer would have {size} numbers; at most {most} are given", "")


def _at(arguments: dict[str, Any], path: str) -> Any:
    name, _, inner = path.partition(".")
    value = arguments.get(name)
    return getattr(value, inner, None) if inner else value


def _importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


class _Alarm(BaseException):
    """Raised wherever the program is when time is up; no `except Exception` on the way may swallow it."""


def within(seconds: float, work: Callable[[], Answer]) -> Answer:
    """Return work(), or raise `TimeLimitError` if it takes longer; without effect where the system has no alarm.

    The alarm may ring at any moment until the first line of `finally`, which no handler can come before: an assignment is no call.
    A parent may have left the signal blocked: it is heard until the answer is there.
    """
    possible = hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()
    if not possible or seconds > LONGEST:
        return work()
    awaited = blocked = False

    def ring(_signal: int, frame: FrameType | None) -> None:
        if not awaited:
            return
        if _importing(frame):  # a module that is left half-imported would spoil every answer after this one
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
            return
        raise _Alarm

    before = signal.signal(signal.SIGALRM, ring)
    try:
        blocked = signal.SIGALRM in signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGALRM])
        awaited = True  # one that had been waiting until now was not ours
        signal.setitimer(signal.ITIMER_REAL, seconds)
        return work()
    except _Alarm:
        raise TimeLimitError(f"no answer within {seconds:g} s; ask for less, or allow more time") from None
    finally:
        awaited = False
        signal.setitimer(signal.ITIMER_REAL, 0)
        if blocked:
            signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM])
        signal.signal(signal.SIGALRM, before)
