"""A check of a sampler that many draw for: threads, processes or a cluster, in any number of sittings.

The batches of a check are its own, whoever draws them, and their tallies are merged in the order of the batches. So the verdict is
that of one process without interruption.
"""

from __future__ import annotations

import hashlib
import json
import os
import pickle
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from fogproof.checks.arguments import whole
from fogproof.checks.sampler_parts import SamplerCheck
from fogproof.checks.tally import Tally
from fogproof.checks.verdict import Verdict
from fogproof.doing import doing
from fogproof.errors import FogproofError, InvalidInputError, InvalidValueError, SubjectError
from fogproof.input_files import open_regular
from fogproof.whole_files import write_file
from fogproof.workers.executors import PATIENCE, ClusterError, Workers, open_workers
from fogproof.workers.processes import FailedCallError, LostProcessError

SCHEMA = "fogproof tally 1"
EVERY = 10.0
"""Seconds from one writing of what has been drawn to the next."""
PART = 512
"""Batches of a task, at most: a worker draws 10^11 samples in three thousand tasks of some seconds."""
_AHEAD = 3
"""Tasks for each worker that are handed out at a time."""
_ATTEMPTS = 3
"""How often a task is handed out whose process comes to an end."""
_PRELOAD = ("fogproof.distributed", "fogproof.checks.suite", "scipy.stats", "scipy.optimize")


def check_distributed(
    make: Callable[[], SamplerCheck],
    executor: str = "processes",
    *,
    workers: int | None = None,
    keep: str | Path | None = None,
) -> Verdict:
    """Return the verdict of make().run(), with samples drawn by many workers, and kept: the same call goes on where it was.

    make      returns `sampler_check(...)` with a seed: a function of a module, or a partial of one, which every worker calls once
    executor  "threads", "processes", or "dask://host:port" for a cluster, whose workers must be able to import what `make` does
    workers   threads or processes; None for one a core
    keep      file of what has been drawn, written every ten seconds and in the end; None keeps nothing

    >>> from functools import partial
    >>> from fogproof import Interval, check_distributed, sampler_check
    >>> make = partial(sampler_check, lambda u: u[:, 0], np.ones_like, Interval(0, 1), dimensions=1, samples=200_000, seed=1)
    >>> check_distributed(make, "threads").outcome
    'not rejected'
    """
    check = make()
    if not isinstance(check, SamplerCheck):
        raise InvalidValueError("make", "must return what sampler_check(...) returns", type(check).__name__)
    path = None if keep is None else Path(keep)
    begun = None if path is None or not os.path.lexists(path) else _read(path, check)
    if workers is not None:
        workers = whole("workers", workers, 1)
    if path is not None and begun is None:
        _write(path, check, check.tally([]))  # better to learn now than later that it cannot be
    try:
        with open_workers(executor, workers, _PRELOAD) as pool:
            task = check.tally if executor == "threads" else _Task(check, _pickled(make))
            return check.run(_Drawing(check, pool, task, path), begun)
    except _OthersError:
        return _of_others(make, check)


class _OthersError(Exception):
    """A worker has drawn for another check."""


def _of_others(make: Callable[[], SamplerCheck], check: SamplerCheck) -> Verdict:
    """Say why a worker's check is another, or judge the sampler here if it is one that draws what it likes."""
    again = make()
    if again.seed != check.seed:
        fix = "give the check a seed: what each worker makes must be the same"
        raise InvalidValueError("make", "must return the same check whenever it is called", make, fix)
    if again.fingerprint == check.fingerprint:
        fix = "give the workers the same versions of your code and of fogproof"
        raise InvalidValueError(
            "executor", "must have workers that make the same check as this process", check.fingerprint, fix
        )
    return check.run()  # it depends on more than its uniforms, which any process sees


@dataclass(frozen=True)
class _Drawing:
    """Draws what is missing of a tally, and writes down what there is from time to time."""

    check: SamplerCheck
    pool: Workers
    task: Callable[[range], Tally] | _Task
    path: Path | None

    def __call__(self, tally: Tally, batches: int) -> Tally:
        missing = range(len(tally.batches), batches)
        if not missing:
            return tally  # all that was kept: nothing is written anew
        written = time.monotonic()
        try:
            for part in self._parts(missing):
                tally = tally.merged(part)
                doing(f"sample {tally.drawn} of {self.check.prepared.samples} at most")
                if time.monotonic() > written + EVERY:
                    self._keep(tally)
                    written = time.monotonic()
        finally:
            self._keep(tally)
        return tally

    def _keep(self, tally: Tally) -> None:
        """Write down what there is; where that fails the check goes on."""
        if self.path is not None:
            try:
                _write(self.path, self.check, tally)
            except InvalidInputError as error:
                warnings.warn(f"{error}; what is drawn is judged, and not kept", RuntimeWarning, stacklevel=2)

    def _parts(self, missing: range) -> Iterator[Tally]:
        """Yield the tallies of the missing batches in order, drawn by all workers."""
        size = min(PART, max(1, len(missing) // (self.pool.slots * _AHEAD)))
        waiting = iter([missing[start : start + size] for start in range(0, len(missing), size)])
        running: deque[tuple[range, Future[Any]]] = deque()
        try:
            while True:
                while len(running) < _AHEAD * self.pool.slots and (part := next(waiting, None)):
                    running.append((part, self._handed_out(part)))
                if not running:
                    return
                yield self._collected(*running.popleft())
        finally:
            for _, future in running:
                future.cancel()

    def _handed_out(self, part: range) -> Future[Any]:
        if isinstance(self.task, _Task):
            return self.pool.executor.submit(_drawn, self.task.pickled, part)
        return self.pool.executor.submit(self.task, part)

    def _collected(self, part: range, future: Future[Any]) -> Tally:
        for attempt in range(1, _ATTEMPTS + 1):
            try:
                found = self._waited_for(future)
                break
            except LostProcessError:
                if attempt == _ATTEMPTS:
                    raise
                future = self._handed_out(part)
            except FogproofError:
                raise
            except FailedCallError as error:
                raise SubjectError(str(error).removeprefix("SubjectError: "), "sample") from None
            except CancelledError:  # not by us: a Dask scheduler does that when it ends
                raise ClusterError(
                    "the cluster was lost; what was drawn is kept where `keep` says", "executor"
                ) from None
            except Exception as error:  # on a cluster: whatever comes from there
                raise SubjectError(f"{type(error).__name__}: {error}", "sample") from None
        return self.task.read(found) if isinstance(self.task, _Task) else found

    def _waited_for(self, future: Future[Any]) -> Any:
        """Return a result; where no worker is left for a while nobody will have one."""
        while True:
            try:
                return future.result(PATIENCE)
            except TimeoutError:
                if not future.done() and not self.pool.left():
                    raise ClusterError(
                        "the cluster has lost its last worker; what was drawn is kept where `keep` says"
                    ) from None


@dataclass(frozen=True)
class _Task:
    """What a worker elsewhere is asked, and how its answer is read."""

    check: SamplerCheck
    pickled: bytes

    def read(self, answer: dict[str, Any]) -> Tally:
        if answer["check"] != self.check.fingerprint:
            raise _OthersError
        return self.check.read(answer)


def _pickled(make: Callable[[], SamplerCheck]) -> bytes:
    try:
        return pickle.dumps(make)
    except Exception as error:  # whatever a part of it raises
        fix = 'give a function of a module, or a partial of one; a lambda goes with executor="threads"'
        raise InvalidValueError("make", f"must be picklable ({error})", make, fix) from None


@lru_cache(maxsize=4)
def _made(pickled: bytes) -> SamplerCheck:
    check: SamplerCheck = pickle.loads(pickled)()
    return check


def _drawn(pickled: bytes, batches: range) -> dict[str, Any]:
    """Draw batches in a worker."""
    return _made(pickled).tally(batches).to_dict()


def _write(path: Path, check: SamplerCheck, tally: Tally) -> None:
    text = json.dumps(tally.to_dict())
    head = {"schema": SCHEMA, "check": check.fingerprint, "alpha": check.alpha}
    write_file(path, json.dumps({**head, "digest": _digest(text), "tally": text}) + "\n")


def _read(path: Path, check: SamplerCheck) -> Tally:
    """Return the tally that a file keeps, or say why it is none of this check."""
    kept = require_kept(path)
    if kept["check"] != check.fingerprint or kept["alpha"] != check.alpha:
        what = "keeps samples of another check: another subject, seed, alpha, number of samples or version"
        raise InvalidInputError(f"{path} {what}; remove it, or choose another place", str(path))
    return check.read(json.loads(kept["tally"]))


def require_kept(path: Path) -> dict[str, Any]:
    """Return what a file keeps, of whatever check, or say what is wrong with it."""
    try:
        with open_regular(path, "the file of what was drawn") as file:
            kept: dict[str, Any] = json.loads(file.read())
        schema, _, _, text, digest = (kept[name] for name in ("schema", "check", "alpha", "tally", "digest"))
    except (ValueError, KeyError, TypeError, RecursionError):
        what = "keeps no samples of a check; remove it, and all is drawn anew, or choose another place"
        raise InvalidInputError(f"{path} {what}", str(path)) from None
    if schema != SCHEMA:
        raise InvalidInputError(
            f"{path} is of another version ({schema}); remove it, or choose another place", str(path)
        )
    if not isinstance(text, str) or _digest(text) != digest:
        raise InvalidInputError(f"{path} is damaged; remove it, and all is drawn anew", str(path))
    return kept


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
