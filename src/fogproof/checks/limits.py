"""A time limit for subjects that may never return: the check runs in a process of its own, which can be ended."""

from __future__ import annotations

import contextlib
import errno
import math
import multiprocessing
import os
import pickle
import signal
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from fogproof import servers
from fogproof.errors import FogproofError, SubjectError, UnsupportedError
from fogproof.parents import CLOSED, SAID, WROTE, stand_between
from fogproof.validate import time_limit
from fogproof_command.startup import StandInError, stand_in

Answer = TypeVar("Answer")


def within(seconds: float, check: Callable[[], Answer]) -> Answer:
    """Return check(), or raise `SubjectError` if it has not returned after so many seconds.

    The check runs in a forked copy of this process, so it may be any closure; what it returns must be picklable, as a `Verdict`
    is. A loop in compiled code that never looks at signals is ended all the same. Needs a system that can fork.
    """
    time_limit("seconds", seconds)
    if sys.platform == "win32" or "fork" not in multiprocessing.get_all_start_methods():
        raise UnsupportedError("a time limit needs a system that can fork: run the check in a process of your own")
    process = IsolatedProcess(multiprocessing.get_context("fork"), _answer, check)
    returned: Answer = _answer_of(process, seconds)
    return returned


_SLOW = ("fogproof.verify", "fogproof.checks.suite", "scipy.stats", "scipy.optimize")


def isolated(check: Callable[[], Answer], seconds: float | None = None, preload: Sequence[str] = _SLOW) -> Answer:
    """Return check() from a fresh process, or raise `SubjectError` if it ends that process, or takes longer than `seconds`.

    Unlike `within` it may be called while other threads are at work, on any system; the check must be picklable: a function of a
    module, or a partial of one.

    preload  modules that take long to load, for the first such call of a process
    """
    if seconds is not None:
        time_limit("seconds", seconds)
    returned: Answer = _answer_of(fresh_process(preload, _answer, check), seconds)
    return returned


def end_isolated() -> None:
    """End whatever `isolated` still waits for, be it a process that has not begun."""
    servers.end()
    for child in multiprocessing.active_children():
        if child.name == _NAME:
            child.kill()


_NAME = "fogproof subject"
_TRIES = 3
"""A server of processes that is killed is started again so often for one subject."""
_AGAIN = 0.2
"""Seconds after which the process between is told to go on: a subject may have stopped it."""
_KILLED = "the subject killed the process that had started it (its parent, or that one's group); let it end what it started alone"
_WROTE = "the subject wrote into files that others had opened (descriptors from 3 on); let it write into its own alone"
_CLOSED = "the subject closed files that others had opened (descriptors from 3 on); let it close its own alone"


class UnstartedError(OSError):
    """No process could be started; the sentence says what to do."""


class IsolatedProcess:
    """A process for other people's code, behind one that stands between it and us.

    work  called there as work(say, *arguments); every object that it says is an answer here
    """

    def __init__(self, context: Any, work: Callable[..., None], *arguments: Any) -> None:
        self._pipe, theirs = context.Pipe(duplex=False)
        self._process = context.Process(target=_begin, args=(theirs, work, *arguments), name=_NAME, daemon=True)
        try:
            self._process.start()
        except (EOFError, OSError) as error:  # EOFError: the server of processes could start none, and ended
            self._pipe.close()
            if isinstance(
                error, ConnectionError | FileNotFoundError
            ):  # it was killed, or its socket removed, a moment ago
                raise
            raise _no_process(error) from None
        finally:
            theirs.close()

    def answer(self, seconds: float | None = None) -> Any:
        """Return the next answer; raise `SubjectError` if the process ends without one, or takes longer than `seconds`."""
        last = math.inf if seconds is None else time.monotonic() + seconds
        while not self._pipe.poll(max(min(_AGAIN, last - time.monotonic()), 0.0)):
            if time.monotonic() >= last:
                raise SubjectError(f"the subject did not return within {seconds:g} s", "sample")
            with contextlib.suppress(OSError, AttributeError):
                os.kill(self._process.pid, signal.SIGCONT)
        try:
            what, said = self._pipe.recv()
        except (EOFError, OSError):  # the process between has ended without a word
            raise SubjectError(self._without_a_word(), "sample") from None
        if what == SAID:
            return pickle.loads(said)
        raise SubjectError(_WROTE if what == WROTE else _ended(said), "sample")

    def kill(self) -> None:
        """Kill it, with all that it started and left in its session."""
        if self._process.pid is not None:
            with contextlib.suppress(OSError, AttributeError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()

    def end(self) -> None:
        """Kill it, and wait until it has ended."""
        self.kill()
        self._process.join()
        self._pipe.close()

    def _without_a_word(self) -> str:
        self._process.join()
        code = self._process.exitcode
        return _unguarded() or (_KILLED if code < 0 else _ended(code))


def _ended(code: int) -> str:
    return _CLOSED if code == CLOSED else f"the subject ended the process, exit code {code}"


def _unguarded() -> str:
    """Return why a process ended before it called anything, "" if the program may be read again without harm."""
    main = getattr(sys.modules.get("__main__"), "__file__", None) or ""
    try:
        guarded = "__name__" in Path(main).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return ""
    program, fix = Path(main).name, 'let what it runs stand under `if __name__ == "__main__":`'
    what = f"the process ended before it began: it reads {program} again, which must start no processes then; {fix}"
    return "" if guarded else what


def fresh_process(preload: Sequence[str], work: Callable[..., None], *arguments: Any) -> IsolatedProcess:
    """Return a process that the server of processes has forked; `UnstartedError` where there can be none."""
    for tries in range(_TRIES):
        try:
            return IsolatedProcess(servers.context(list(preload)), work, *arguments)
        except (ConnectionError, BlockingIOError, FileNotFoundError) as error:  # the server ended meanwhile
            if tries + 1 == _TRIES:
                raise UnstartedError(*_no_process(error).args) from None
            time.sleep(servers.ENDING)
        except OSError as error:
            raise UnstartedError(*_no_process(error).args) from None
    raise AssertionError("unreachable")


def _no_process(error: BaseException) -> OSError:
    if getattr(error, "errno", None) in (errno.EMFILE, errno.ENFILE):
        return OSError(error.errno, "too many files are open; raise the system's limit (ulimit -n)")  # type: ignore[attr-defined]
    if isinstance(error, FileNotFoundError):
        fix = f"what starts them was removed ({error.filename or servers.folder()}): let nothing remove what it has not made"
        return OSError(error.errno, f"no process could be started; {fix}")
    fix = "end some, or raise the system's limit (ulimit -u)"
    return OSError(getattr(error, "errno", None) or errno.EAGAIN, f"no process could be started; {fix}")


def _begin(to: Any, work: Callable[..., None], *arguments: Any) -> None:
    say = stand_between(to)
    servers.let_go()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # nobody sends it: a KeyboardInterrupt is the subject's own
    work(lambda answer: say(pickle.dumps(answer)), *arguments)


def _answer_of(process: IsolatedProcess, seconds: float | None) -> Any:
    try:
        good, answer = process.answer(seconds)
    finally:
        process.end()
    if good is None:
        raise StandInError(answer)
    if not good:
        raise SubjectError(*answer)
    return answer


def _answer(say: Callable[[object], None], check: Callable[[], object]) -> None:
    try:
        say((True, check()))
    except FogproofError as error:
        say((False, (str(error), error.path)))
    except SystemExit as error:  # the subject's own does not come so far
        say((None, stand_in(error)) if stand_in(error) else (False, (f"SystemExit: {error}", "sample")))
    except BaseException as error:  # the parent must hear of it, whatever it is
        say((False, (f"{type(error).__name__}: {error}".removesuffix(": "), "sample")))
