"""A time limit for subjects that may never return: the check runs in a process of its own, which can be ended."""

from __future__ import annotations

import contextlib
import errno
import multiprocessing
import multiprocessing.connection
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, TypeVar

from fogproof import parents, servers
from fogproof.errors import FogproofError, SubjectError, UnsupportedError
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
    return _answer_of(multiprocessing.get_context("fork"), seconds, check)


_SLOW = ("fogproof.verify", "fogproof.checks.suite", "scipy.stats", "scipy.optimize")


def isolated(check: Callable[[], Answer], seconds: float | None = None, preload: Sequence[str] = _SLOW) -> Answer:
    """Return check() from a fresh process, or raise `SubjectError` if it ends that process, or takes longer than `seconds`.

    Unlike `within` it may be called while other threads are at work, on any system; the check must be picklable: a function of a
    module, or a partial of one.

    preload  modules that take long to load, for the first such call of a process
    """
    if seconds is not None:
        time_limit("seconds", seconds)
    for tries in range(_TRIES):
        try:
            return _answer_of(servers.context(list(preload)), seconds, check)
        except OSError as error:
            if (
                not isinstance(error, ConnectionError | BlockingIOError) or tries + 1 == _TRIES
            ):  # the latter: it ended meanwhile
                raise _no_process(error) from None
            time.sleep(servers.ENDING)
    raise AssertionError("unreachable")


def end_isolated() -> None:
    """End whatever `isolated` still waits for, be it a process that has not begun."""
    servers.end()
    for child in multiprocessing.active_children():
        if child.name == _NAME:
            child.kill()


_NAME = "fogproof subject"
_TRIES = 3
"""A server of processes that is killed is started again so often for one subject."""
_REST = 10.0
"""Seconds beyond its limit that a subject has for the rest of an answer that it has begun."""
_WROTE = "the subject wrote into files that others had opened (descriptors from 3 on); let it write into its own alone"
_CLOSED = 74
"""The exit code of a process that cannot send its answer: EX_IOERR of sysexits.h."""


def _answer_of(context: Any, seconds: float | None, check: Callable[[], Answer]) -> Answer:
    ours, theirs = context.Pipe(duplex=False)
    child = context.Process(target=_answer, args=(check, theirs), name=_NAME, daemon=True)
    try:
        child.start()
    except (EOFError, OSError) as error:  # EOFError: the server of processes could start none, and ended
        ours.close()
        if isinstance(error, ConnectionError):  # it was killed a moment ago
            raise
        raise _no_process(error) from None
    finally:
        theirs.close()
    try:
        end = None if seconds is None else time.monotonic() + seconds
        if not ours.poll(seconds):
            raise SubjectError(f"the subject did not return within {seconds:g} s", "sample")
        try:
            with _ended_after(None if end is None else end - time.monotonic(), child):
                good, answer = ours.recv()
        except EOFError:
            child.join()
            raise SubjectError(_without_answer(child.exitcode), "sample") from None
        except Exception:  # no message of ours, but bytes
            raise SubjectError(_WROTE, "sample") from None
    finally:
        _end(child)
        child.join()
        ours.close()
    if good is None:
        raise StandInError(answer)
    if not good:
        raise SubjectError(*answer)
    returned: Answer = answer
    return returned


@contextlib.contextmanager
def _ended_after(seconds: float | None, child: Any) -> Iterator[None]:
    """End a process that has begun to answer, and does not come to the end of it in time."""
    if seconds is None:
        yield
        return
    timer = threading.Timer(max(seconds, 0.0) + _REST, _end, [child])
    timer.daemon = True
    with contextlib.suppress(RuntimeError):  # where no more threads may be started nothing watches
        timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _end(child: Any) -> None:
    if child.pid is not None:
        with contextlib.suppress(OSError, AttributeError):  # with all that it started and left in its session
            os.killpg(child.pid, signal.SIGKILL)
    child.kill()


def _without_answer(code: int) -> str:
    if code == _CLOSED:
        return "the subject closed files that others had opened (descriptors from 3 on); let it close its own alone"
    return f"the subject ended the process, exit code {code}"


def _no_process(error: BaseException) -> OSError:
    if getattr(error, "errno", None) in (errno.EMFILE, errno.ENFILE):
        return OSError(error.errno, "too many files are open; raise the system's limit (ulimit -n)")  # type: ignore[attr-defined]
    fix = "end some, or raise the system's limit (ulimit -u)"
    return OSError(getattr(error, "errno", None) or errno.EAGAIN, f"no process could be started; {fix}")


def _answer(check: Callable[[], object], pipe: multiprocessing.connection.Connection) -> None:
    lock = threading.Lock()

    def send(answer: object) -> None:
        with lock:
            try:
                pipe.send(answer)
            except OSError:  # our parent is gone, or hears nothing but this number
                os._exit(_CLOSED)

    parents.stand_between(partial(send, (False, (parents.KILLED, "sample"))))
    servers.let_go()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # nobody sends it: a KeyboardInterrupt is the subject's own
    parent = multiprocessing.parent_process()
    assert parent is not None
    with contextlib.suppress(RuntimeError):  # where no more threads may be started nothing watches
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    try:
        answer = check()
        parents.confirm()
        send((True, answer))
    except FogproofError as error:
        send((False, (str(error), error.path)))
    except SystemExit as error:  # the subject's own does not come so far
        send((None, stand_in(error)) if stand_in(error) else (False, (f"SystemExit: {error}", "sample")))
    except BaseException as error:  # the parent must hear of it, whatever it is
        send((False, (f"{type(error).__name__}: {error}".removesuffix(": "), "sample")))


def _end_with(sentinel: int) -> None:
    """End this process when its parent has ended: nobody would wait for the answer."""
    multiprocessing.connection.wait([sentinel])
    os._exit(1)
