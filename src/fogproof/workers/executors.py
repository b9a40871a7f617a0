"""Where parts of long work are done: threads, processes, or a Dask cluster, all behind `concurrent.futures`.

A process that ends takes its part with it, which is done again: by a new one, or by Dask elsewhere. What a subject has left in
a process, a thread that writes where it should not, say, may end it under another's part: `Workers.restart` makes new ones.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from fogproof.errors import InvalidValueError, NotInstalledError, SubjectError
from fogproof.workers.processes import Processes

PATIENCE = 10.0
"""Seconds a scheduler has to answer."""

_DASK = "dask://"


class ClusterError(SubjectError):
    """A cluster cannot be reached, or has been lost; what has been drawn is kept."""

    code = "cluster"


@dataclass
class Workers:
    """An executor and how to get another one.

    slots  parts that can be done at the same time
    left   how many are there now: workers of a cluster come and go
    """

    make: Callable[[], Executor]
    slots: int
    left: Callable[[], int] = lambda: 1
    executor: Executor = field(init=False)

    def __post_init__(self) -> None:
        self.executor = self.make()

    def restart(self) -> None:
        """Put a new executor in the place of one that has broken."""
        self.executor.shutdown(wait=False, cancel_futures=True)
        self.executor = self.make()


def require_executor(where: str) -> None:
    """Refuse what names no executor; whether a cluster answers is not asked."""
    host, _, port = where.removeprefix(_DASK).rpartition(":")
    if where not in ("threads", "processes") and not (where.startswith(_DASK) and host and port.isdigit()):
        raise InvalidValueError("executor", "must be threads, processes or dask://host:port", where)


def available() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextlib.contextmanager
def open_workers(where: str, workers: int | None, preload: Sequence[str] = ()) -> Iterator[Workers]:
    """Open workers: "threads", "processes", or "dask://host:port" for a cluster, whose workers are its own.

    preload  modules that take long to load, for processes
    """
    require_executor(where)
    if where.startswith(_DASK):
        with _dask(where.removeprefix(_DASK)) as made:
            yield made
        return
    n = workers or available()
    made = Workers(lambda: Processes(n, preload) if where == "processes" else ThreadPoolExecutor(n), n)
    try:
        yield made
    finally:
        made.executor.shutdown(wait=True, cancel_futures=True)


@contextlib.contextmanager
def _dask(address: str) -> Iterator[Workers]:
    try:
        from distributed import Client
    except ImportError:
        raise NotInstalledError("Dask", "dask") from None
    try:
        client: Any = Client(f"tcp://{address}", timeout=PATIENCE, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise ClusterError(f"no Dask scheduler answers at {address}: {error}", "executor") from None

    def slots() -> int:
        return sum(client.nthreads().values())

    try:
        threads = slots()
        if not threads:
            raise ClusterError(
                f"the cluster at {address} has no worker; start one: dask worker tcp://{address}", "executor"
            )
        # pure=False: by default equal calls are taken to be one, and copies of its result come back.
        yield Workers(lambda: client.get_executor(pure=False), threads, slots)
    finally:
        with contextlib.suppress(Exception):  # a cluster that has gone cannot be told goodbye
            client.close(timeout=5)
