"""A study from beginning to end in a run folder: the store opened, what is missing drawn, the record written."""

from __future__ import annotations

import datetime
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fogproof.errors import InvalidInputError
from fogproof.study.cells import cells_of, prepare
from fogproof.study.csv_table import table
from fogproof.study.environment import environment
from fogproof.study.files import Study
from fogproof.study.history import compare
from fogproof.study.plan import batches_of
from fogproof.study.progress import Progress
from fogproof.study.record import Circumstances, make_record, read_results
from fogproof.study.run import draw_missing
from fogproof.study.store import opened
from fogproof.study.trial import try_own
from fogproof.workers.executors import open_workers

_PRELOAD = ("fogproof.study.batches",)


class UnwrittenError(InvalidInputError):
    """What a study has come to cannot be written; `record` is what was to be."""

    record: dict[str, Any]


def run_study(
    study: Study,
    folder: str | Path,
    *,
    executor: str = "threads",
    workers: int | None = None,
    against: str | Path | None = None,
    salvage: bool = False,
    command: str = "",
    tell: Callable[[str], None] = lambda words: None,
) -> dict[str, Any]:
    """Draw what is missing of a study in its folder, write `results.json` and `results.csv` there, and return the record.

    `UnwrittenError` if they cannot be written. KeyboardInterrupt goes on after the results of what has been drawn are written.

    executor  "threads", "processes" or "dask://host:port"; in threads of this process one's own estimator may end it
    workers   threads or processes; None for one a core
    against   folder or results.json of an earlier run that this one is compared with
    salvage   whether a damaged store is put aside, and what can be read of it used
    command   how the run was called, for the record
    tell      told in words what an interrupted run waits for
    """
    folder = Path(folder)
    started, clock = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"), time.perf_counter()
    before = None if against is None else _comparable(Path(against))
    elsewhere = executor != "threads"
    if elsewhere:
        try_own(study)
    cells = cells_of(study)
    batches = batches_of(cells)
    prepare(
        cells, tried=elsewhere
    )  # what cannot run leaves no folder behind that another study, the mended one, would not fit into
    with opened(folder, study, salvage) as store:
        done = store.done()
        missing = len(batches) - len(done)
        slots = 0
        stopped: KeyboardInterrupt | None = None
        if missing:
            with (
                open_workers(executor, workers, _PRELOAD) as pool,
                Progress(cells, batches, done, pool.slots) as progress,
            ):
                store.begin(started, json.dumps(environment(), sort_keys=True))
                slots = pool.slots
                try:
                    draw_missing(study, cells, batches.in_turn(), store, pool, progress.advance, tell=tell)
                except KeyboardInterrupt as stop:
                    stopped = stop
        run = Circumstances(command, started, time.perf_counter() - clock, executor, slots, stopped is not None)
        record = make_record(study, cells, batches, store, run)
        store.require_there()
    from fogproof.whole_files import write_file

    if before is not None:
        record["history"] = compare(before, record)
    try:
        write_file(folder / "results.json", json.dumps(record, indent=1, allow_nan=False) + "\n")
        write_file(folder / "results.csv", table(record))
    except InvalidInputError as error:
        unwritten = UnwrittenError(str(error), error.path)
        unwritten.record = record
        raise unwritten from None
    if stopped is not None:
        raise stopped
    return record


def _comparable(path: Path) -> dict[str, Any]:
    """Return an earlier record that can be compared with; one that cannot is told before anything is drawn."""
    record = read_results(path)
    try:
        compare(record, record)
    except Exception as error:  # whatever somebody made of a record
        what = f"{path} cannot be compared with, as if changed by hand: {type(error).__name__}: {error}"
        raise InvalidInputError(what, str(path)) from None
    return record
