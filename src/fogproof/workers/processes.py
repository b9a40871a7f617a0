"""Processes that do one part of long work each at a time: whose end it was that one came to is known, and costs nobody else."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import queue
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from fogproof.checks.limits import IsolatedProcess, fresh_process
from fogproof.errors import SubjectError


class NoProcessError(SubjectError):
    """No process can be started; what has been drawn is kept."""

    code = "no-process"


class LostProcessError(SubjectError):
    """The process that was at work has ended, or what it says is no answer."""


class FailedCallError(Exception):
    """What a call raised in its process, in words."""


class Processes(ThreadPoolExecutor):
    """As many threads, and a process for each that is at work."""

    def __init__(self, n: int, preload: Sequence[str] = ()) -> None:
        """Prepare for n processes. `preload`: modules that take long to load."""
        super().__init__(n)
        self._preload = preload
        self._idle: queue.SimpleQueue[_Process | None] = queue.SimpleQueue()
        self._all: set[_Process] = set()
        self._over = False
        for _ in range(n):
            self._idle.put(None)

    def submit(self, call: Callable[..., Any], /, *arguments: Any) -> Future[Any]:  # type: ignore[override]
        """Have call(*arguments) called in a process; all of it must be picklable."""
        return super().submit(self._asked, call, *arguments)

    def _asked(self, *asked: Any) -> Any:
        process = self._idle.get()
        try:
            process = process or self._started()
            good, answer = process.ask(asked)
        except SubjectError:
            if process is not None:
                process.end()
                self._all.discard(process)
            process = None
            raise
        finally:
            self._idle.put(process)
        if not good:
            raise FailedCallError(answer)
        return answer

    def _started(self) -> _Process:
        try:
            process = _Process(self._preload)
        except OSError as error:
            fix = "what was drawn is kept: give the same command again"
            raise NoProcessError(f"{error.strerror or error}; {fix}", "--executor") from None
        self._all.add(process)
        if self._over:
            process.kill()
        return process

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all processes; what they are at is lost."""
        super().shutdown(wait=False, cancel_futures=cancel_futures)
        self._over = True
        for process in list(self._all):
            process.kill()
        super().shutdown(wait=wait)
        for process in list(self._all) if wait else ():
            process.end()


class _Process:
    """A process and the pipe by which it is told what to do."""

    def __init__(self, preload: Sequence[str]) -> None:
        asks, self._asks = multiprocessing.Pipe(duplex=False)
        try:
            self._process: IsolatedProcess = fresh_process(preload, _serve, asks)
        except OSError:
            self._asks.close()
            raise
        finally:
            asks.close()
        self.kill = self._process.kill

    def ask(self, asked: tuple[Any, ...]) -> tuple[bool, Any]:
        """Return (True, result), or (False, words) if the call raised; `LostProcessError` if the process has come to an end."""
        said = pickle.dumps(asked)
        try:
            with contextlib.suppress(OSError):  # it has ended: the answer says how
                self._asks.send_bytes(said)
            answer: tuple[bool, Any] = self._process.answer()
        except SubjectError as error:
            raise LostProcessError(str(error), error.path) from None
        return answer

    def end(self) -> None:
        """End it."""
        self._asks.close()
        self._process.end()


def _serve(say: Callable[[object], None], asks: Any) -> None:
    """Answer what is asked until nobody asks any more."""
    while True:
        try:
            call, *arguments = pickle.loads(asks.recv_bytes())
        except (EOFError, OSError):
            os._exit(0)  # Python would wait for threads that an estimator has left
        try:
            answer: tuple[bool, Any] = True, call(*arguments)
        except BaseException as error:  # an estimator may raise KeyboardInterrupt: no signal comes here
            answer = False, f"{type(error).__name__}: {error}"
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError, AttributeError):
                stream.flush()
        say(answer)
