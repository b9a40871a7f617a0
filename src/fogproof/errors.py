"""The one hierarchy of errors: each carries a code for programs and a sentence for people."""

from __future__ import annotations

import pickle
import signal
import threading
from typing import Any, ClassVar


class FogproofError(Exception):
    """Base of every error a user can cause: `code` is stable, `path` names the argument at fault, if any."""

    code: ClassVar[str] = "error"

    def __init__(self, message: str, path: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.path = path

    def to_dict(self) -> dict[str, str]:
        """Return the JSON form: `{"code", "message", "path"}`."""
        return {"code": self.code, "message": str(self), "path": self.path}

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what the error holds and not how it was made: so it comes back from another process whatever its arguments."""
        return _restored, (type(self), self.args, {name: _carried(value) for name, value in vars(self).items()})


class InvalidValueError(FogproofError, ValueError):
    """An argument breaks a rule: the message names argument, rule, what came instead, and the fix.

    It is a `ValueError` too, so that pydantic collects it with the place in the file where it happened.
    """

    code = "invalid-value"

    def __init__(self, argument: str, rule: str, got: Any, fix: str = "") -> None:
        self.argument, self.rule, self.got, self.fix = argument, rule, got, fix
        super().__init__(f"{argument} {rule}, got {shorten(got)}" + (f"; {fix}" if fix else ""), argument)

    def inside(self, place: str, origin: str) -> InvalidValueError:
        """Return the same complaint about an argument at `place` of the file or request `origin`; the argument "" is the place."""
        moved = InvalidValueError(self.argument, self.rule, self.got, self.fix)
        fix, where = f"; {self.fix}" if self.fix else "", f" in {place}" if self.argument else ""
        moved.args = (f"{origin}: {self.argument or place} {self.rule}, got {shorten(self.got)}{where}{fix}",)
        moved.path = place if place.endswith(self.argument) else f"{place}.{self.argument}"
        return moved


class InvalidInputError(FogproofError):
    """A file or request cannot be read, parsed, or has a wrong or missing key."""

    code = "invalid-input"


class UnsupportedError(FogproofError):
    """A valid question that no method here can answer; the message says which ones it can."""

    code = "unsupported"


class TooLargeError(FogproofError):
    """A request or its answer exceeds a bound on its size; the message says which, and how to raise it."""

    code = "too-large"


class TimeLimitError(FogproofError):
    """An answer took longer than it may; the message says how long that is."""

    code = "timeout"


class InternalError(FogproofError):
    """A fault of fogproof itself that cost one answer; the message asks for a report."""

    code = "internal"


class NotInstalledError(FogproofError):
    """An optional program or package is not there; the message is the line that installs it."""

    code = "not-installed"

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(
            f"{package} is not installed; install it with: python -m pip install 'fogproof[{extra}]'", package
        )


class SubjectError(FogproofError):
    """What was to be checked raised, or returned something that breaks its contract."""

    code = "subject-failed"


class Stopped(KeyboardInterrupt):
    """A signal has asked the run to stop; `code` is what a shell expects of such a process: 128 + the signal's number."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.code = 128 + number


def is_stop(error: BaseException) -> bool:
    """Whether an error is a signal's, which asks this process to stop, and not one that somebody else's code has raised.

    Signals are heard by the main thread alone; a handler of ours raises `Stopped`, Python's own a plain KeyboardInterrupt.
    """
    if isinstance(error, Stopped):
        return True
    if not isinstance(error, KeyboardInterrupt) or threading.current_thread() is not threading.main_thread():
        return False
    handler = signal.getsignal(signal.SIGINT)
    return handler is not signal.SIG_IGN and not getattr(handler, "raises_stopped", False)


def stop_behind(error: BaseException) -> KeyboardInterrupt | None:
    """Return the interruption that an error is, or that caused it: code in C may turn one into a SystemError; None otherwise."""
    seen: set[int] = set()
    ahead: list[BaseException | None] = [error]
    while ahead:
        one = ahead.pop()
        if isinstance(one, KeyboardInterrupt) and is_stop(one):
            return one
        if one is not None and id(one) not in seen:
            seen.add(id(one))
            ahead += [one.__context__, one.__cause__]
    return None


def _restored(kind: type[FogproofError], args: tuple[Any, ...], held: dict[str, Any]) -> FogproofError:
    error = kind.__new__(kind, *args)
    error.args = args
    vars(error).update(held)
    return error


def _carried(value: Any) -> Any:
    """Return the value if it can be pickled, else what it looks like: a function made in place stays behind."""
    try:
        pickle.loads(pickle.dumps(value))
    except Exception:
        return shorten(value)
    return value


def shorten(value: Any, limit: int = 80) -> str:
    """Return `repr(value)`, at most `limit` characters of it, arrays and NumPy scalars as plain numbers."""
    text = repr(value.tolist()) if hasattr(value, "tolist") else repr(value)
    return text if len(text) <= limit else text[: limit - 3] + "..."
