"""Drawing what is missing: batches out to the workers, results into the store, until all are there or somebody says stop."""

from __future__ import annotations

import concurrent.futures
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import CancelledError, Future
from dataclasses import dataclass, field

from fogproof.study.batches import BatchResult, run_batch
from fogproof.study.cells import Cell
from fogproof.study.files import Study
from fogproof.study.plan import Batch
from fogproof.study.stored_batches import Store
from fogproof.workers.executors import ClusterError, Workers
from fogproof.workers.processes import FailedCallError, LostProcessError, NoProcessError

ATTEMPTS = 3
"""A batch that has failed so often is given up for this run, and reported; so is a cell that did in so many batches."""
PATIENCE = 1.0
"""Seconds after an interrupt, from which on somebody is told what is waited for."""
AHEAD = 2
"""Batches a worker has waiting, beside the one it draws."""

_DIED = "the worker that drew it died"

DrawBatch = Callable[[str, str, Batch, float], BatchResult]
Advance = Callable[[Batch, "BatchResult | None"], None]


@dataclass
class _Work:
    """What is to be drawn: `waiting` in any number, `suspects` one at a time with nobody else at work.

    ended   batches under which a process ended
    deadly  of a cell, batches that were given up for that
    """

    waiting: deque[Batch]
    suspects: deque[Batch] = field(default_factory=deque)
    running: dict[Future[BatchResult], Batch] = field(default_factory=dict)
    failed: dict[int, int] = field(default_factory=dict)
    ended: set[int] = field(default_factory=set)
    deadly: Counter[int] = field(default_factory=Counter)

    def next(self, slots: int) -> Batch | None:
        """Return the next batch to hand out, None if the workers have enough."""
        if self.waiting and len(self.running) < slots * (1 + AHEAD) and not self.suspects:
            return self.waiting.popleft()
        if self.suspects and not self.running:
            return self.suspects.popleft()
        return None


def draw_missing(
    study: Study,
    cells: Sequence[Cell],
    batches: Iterable[Batch],
    store: Store,
    pool: Workers,
    advance: Advance = lambda batch, result: None,
    draw: DrawBatch = run_batch,
    tell: Callable[[str], None] = lambda words: None,
) -> None:
    """Draw every batch that is not in the store yet, in the order given.

    On KeyboardInterrupt no more is handed out, what is under way is still stored, and the interrupt goes on.

    advance  told of each batch, with its result or None if it was given up
    draw     what a worker calls
    tell     told in words what an interrupt waits for
    """
    done = store.done()
    work = _Work(deque(batch for batch in batches if batch.number not in done))
    try:
        while work.waiting or work.suspects or work.running:
            while (batch := work.next(pool.slots)) is not None:
                if work.deadly[batch.cell] >= ATTEMPTS:
                    store.fail(batch.number, 0, f"{_DIED} in {ATTEMPTS} other batches: this one was not tried")
                    advance(batch, None)
                else:
                    _hand_out(study, cells, batch, pool, work, draw)
            ready, _ = concurrent.futures.wait(work.running, return_when=concurrent.futures.FIRST_COMPLETED)
            _collect(ready, work, store, pool, advance)
    except KeyboardInterrupt:
        _keep_what_is_under_way(work, store, tell)
        raise


def _hand_out(study: Study, cells: Sequence[Cell], batch: Batch, pool: Workers, work: _Work, draw: DrawBatch) -> None:
    if batch.number in work.ended:  # whose fault that was is known if nobody has been at work in the process before
        pool.restart()
    reference = float(cells[batch.cell].reference.value)
    work.running[pool.executor.submit(draw, study.text, study.folder, batch, reference)] = batch


def _collect(ready: set[Future[BatchResult]], work: _Work, store: Store, pool: Workers, advance: Advance) -> None:
    """Store what is ready; see to what has failed."""
    results = {}
    failed: list[tuple[Batch, BaseException]] = []
    for future in ready:
        batch = work.running.pop(future)
        try:
            error = future.exception()  # not raised here: it may be a KeyboardInterrupt of the batch's own
        except CancelledError:  # not by us: a Dask scheduler does that when it ends
            raise ClusterError("the cluster was lost; what was drawn is kept: give the same command again") from None
        if error is None:
            results[batch] = future.result()
        else:
            failed.append((batch, error))
    if results:
        store.add(results.values())
    for batch, result in results.items():
        advance(batch, result)
    for batch, error in failed:  # whatever a batch does, the others go on
        if isinstance(error, NoProcessError):
            raise error
        if isinstance(error, LostProcessError):
            work.ended.add(batch.number)
            work.deadly[batch.cell] += _again(batch, f"{_DIED}: {error}", work, store, advance)
        else:
            words = str(error) if isinstance(error, FailedCallError) else f"{type(error).__name__}: {error}"
            _again(batch, words, work, store, advance)


def _again(batch: Batch, error: str, work: _Work, store: Store, advance: Advance) -> bool:
    """Have a batch drawn again, or give it up; return whether it was given up."""
    attempts = work.failed[batch.number] = work.failed.get(batch.number, 0) + 1
    if attempts < ATTEMPTS:
        work.suspects.append(batch)
        return False
    store.fail(batch.number, attempts, error)
    advance(batch, None)
    return True


def _keep_what_is_under_way(work: _Work, store: Store, tell: Callable[[str], None]) -> None:
    """Store the batches that were being drawn; those that only waited are drawn another time."""
    under_way = [future for future in work.running if not future.cancel()]
    _, late = concurrent.futures.wait(under_way, PATIENCE)
    if late:
        which = "the batch that is" if len(late) == 1 else f"{len(late)} batches that are"
        tell(
            f"stopping: waiting for {which} under way, to keep what is drawn; a second signal ends at once, without that"
        )
    finished, _ = concurrent.futures.wait(under_way)
    results = [future.result() for future in finished if not future.cancelled() and future.exception() is None]
    store.add(results)
