"""Where batches are drawn: threads, processes, or a Dask cluster, all behind `concurrent.futures`.

A worker that dies takes its batches with it. They are drawn again: by a new pool, or by Dask elsewhere. `Workers.restart` makes the
new pool; whether a batch kills its workers is for the caller to find out.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import multiprocessing.connection
import multiprocessing.util
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from fogproof import parents, servers
from fogproof.errors import InvalidValueError, NotInstalledError, SubjectError

PATIENCE = 10.0
"""Seconds a scheduler has to answer."""


class ClusterError(SubjectError):
    """A cluster cannot be reached, or has been lost; what has been drawn is kept."""

    code = "cluster"


@dataclass
class Workers:
    """An executor and how to get another one.

    slots  batches that can be drawn at the same time
    """

    make: Callable[[], Executor]
    slots: int
    executor: Executor = field(init=False)

    def __post_init__(self) -> None:
        self.executor = self.make()

    def restart(self) -> None:
        """Put a new executor in the place of one that has broken."""
        self.executor.shutdown(wait=False, cancel_futures=True)
        self.executor = self.make()


def available() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextlib.contextmanager
def open_workers(where: str, workers: int | None) -> Iterator[Workers]:
    """Open workers: "threads", "processes", or "dask://host:port" for a cluster, whose workers are its own."""
    if where.startswith("dask://"):
        with _dask(where.removeprefix("dask://")) as made:
            yield made
        return
    n = workers or available()
    if where == "threads":
        made = Workers(lambda: ThreadPoolExecutor(n), n)
    elif where == "processes":
        made = Workers(
            lambda: ProcessPoolExecutor(n, servers.context(["fogproof.study.batches"]), initializer=_as_worker), n
        )
    else:
        raise InvalidValueError("--executor", "must be threads, processes or dask://host:port", where)
    try:
        yield made
    finally:
        made.executor.shutdown(wait=True, cancel_futures=True)


def _as_worker() -> None:
    """Leave signals to the process that coordinates, which wants the batches that are under way; end when that process ends.

    A worker that outlives it would wait for work for ever, and keep open what its parent's output is read from.
    """
    parents.stand_between(lambda: None)
    servers.let_go()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    multiprocessing.util.Finalize(None, _end_at_once, exitpriority=1000)  # before anybody is waited for
    parent = multiprocessing.parent_process()
    assert parent is not None
    with contextlib.suppress(RuntimeError):  # where no more threads may be started nothing watches
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_at_once() -> None:
    """End a worker that has nothing more to do: Python would wait for threads that an estimator has left."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(0)


def _end_with(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(1)


@contextlib.contextmanager
def _dask(address: str) -> Iterator[Workers]:
    host, _, port = address.rpartition(":")
    if not host or not port.isdigit():
        raise InvalidValueError("--executor", "must name host and port, as dask://host:port", f"dask://{address}")
    try:
        from distributed import Client
    except ImportError:
        raise NotInstalledError("Dask", "dask") from None
    try:
        client: Any = Client(f"tcp://{address}", timeout=PATIENCE, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise ClusterError(f"no Dask scheduler answers at {address}: {error}", "--executor") from None
    try:
        threads = sum(client.nthreads().values())
        # pure=False: by default equal calls are taken to be one, and copies of its result come back.
        yield Workers(lambda: client.get_executor(pure=False), max(threads, 1))
    finally:
        with contextlib.suppress(Exception):  # a cluster that has gone cannot be told goodbye
            client.close(timeout=5)
