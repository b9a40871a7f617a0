"""What does a study cost beside what it measures, and how long does a very large one take to be summed up?

    python benchmarks/study.py [--seconds 9] [--batches 1000000]

1. A study whose batches take about 50 ms, against the bare estimator drawing the same batches on a thread: processor time of the
   whole process, runs interleaved; and the study with an estimator that costs nothing.
2. A store with a million batches, written directly, then opened, read and summed up: seconds and peak memory of a process that does
   nothing else.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from fogproof.checks.streams import batch_generator
from fogproof.study.aggregate import levels_of
from fogproof.study.batches import BatchResult, draw_batch, moments_of
from fogproof.study.cells import Cell, cells_of, prepare
from fogproof.study.files import Study, study_of
from fogproof.study.plan import Batch, Batches, batches_of
from fogproof.study.run import draw_missing
from fogproof.study.store import FILE, opened
from fogproof.workers.executors import open_workers

SIZE = 1 << 16
SCENE = {
    "name": "s",
    "quantity": "airlight",
    "medium": {"sigma_a": 0.1, "sigma_s": 0.4},
    "ray": {"origin": [0, 0, -2], "direction": [0, 0, 1], "length": 5},
    "light": {"position": [0.6, -0.8, 0.5], "intensity": 3},
}
NOISE = {
    "name": "n",
    "quantity": "transmittance",
    "medium": {"kind": "noise", "density": 2, "frequency": 1.5},
    "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 1.5},
}


def study_from(batch: int, replicates: int, scene: dict[str, object], estimator: dict[str, object]) -> Study:
    """Return a study of one estimator at one count, a batch for each replicate."""
    scenes = [{**scene, "estimators": [estimator]}]
    table = {"samples": [batch], "replicates": replicates, "batch": batch, "sobol": False, "scenes": scenes}
    return study_of(json.dumps(table), "/")


def bare(cell: Cell, batches: Sequence[Batch]) -> float:
    """Draw the batches and throw them away; return the seconds of processor it took."""
    estimator = cell.estimator(0)

    def draw() -> None:
        for batch in batches:
            estimator.draw(batch_generator(1, cell.stream, batch.first, 0), batch.samples)

    with ThreadPoolExecutor(1) as pool:
        started = time.process_time()
        pool.submit(draw).result()
        return time.process_time() - started


def whole(study: Study, cells: list[Cell], batches: Batches) -> float:
    """Draw them as a study; return the seconds of processor it took, once the store was open."""

    def here(text: str, folder: str, batch: Batch, reference: float) -> BatchResult:
        return draw_batch(cells[batch.cell], batch, reference)

    with (
        tempfile.TemporaryDirectory() as folder,
        opened(Path(folder), study) as store,
        open_workers("threads", 1) as pool,
    ):
        started = time.process_time()
        draw_missing(study, cells, batches, store, pool, draw=here)
        return time.process_time() - started


def overhead(seconds: float) -> None:
    """Print the cost of a study over its bare estimator at batches of about 50 ms."""
    majorant = 4.0
    for _ in range(2):  # look-ups are proportional to the majorant
        cells = cells_of(
            study_from(SIZE, max(4, int(seconds / 9 / 0.05)), NOISE, {"kind": "ratio", "majorant": majorant})
        )
        prepare(cells)
        started = time.process_time()
        cells[0].estimator(0).draw(np.random.default_rng(0), SIZE)
        majorant *= 0.05 / (time.process_time() - started)
    study, batches = cells[0].study, batches_of(cells)
    runs = np.array([(bare(cells[0], batches), whole(study, cells, batches)) for _ in range(9)])
    ratios, (fastest_bare, fastest) = runs[:, 1] / runs[:, 0] - 1, runs.min(axis=0)
    print(
        f"batches of {fastest_bare / len(batches) * 1e3:.1f} ms ({SIZE} samples), {len(batches)} of them, nine times:"
    )
    print(
        f"  overhead {fastest / fastest_bare - 1:+.2%}, fastest against fastest; the median of pairs is {np.median(ratios):+.2%}"
    )
    study = study_from(SIZE, 400, NOISE, {"kind": "ratio"})
    cells = cells_of(study)
    cells[0]._made[0] = Free()
    each = min(whole(study, cells, batches_of(cells)) for _ in range(3)) / 400
    print(f"  all but the drawing: {each * 1e3:.2f} ms a batch, {each / 0.05:.2%} of 50 ms")


class Free:
    """An estimator that costs nothing."""

    values = np.exp(np.random.default_rng(1).normal(size=SIZE))

    def draw(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Return the same numbers each time."""
        return self.values[:n]


LARGE = """
import sys
sys.path.insert(0, {here!r})
import study as bench
from pathlib import Path
bench.summed(Path({folder!r}), {batches})
"""


def write_large(folder: Path, study: Study, total: int) -> None:
    """Write a store with so many batches, each as a real one is, of a few different contents."""
    rng = np.random.default_rng(1)
    contents = []
    for _ in range(64):
        x = rng.normal(size=(1, 4096))
        contents.append((np.concatenate([moments_of(x), moments_of(x * x)]), np.sort(np.abs(x[0]))[-64:]))
    with opened(folder, study) as store:
        for start in range(0, total, 50_000):
            ids = range(start, min(start + 50_000, total))
            store.add(BatchResult(i, *contents[i % 64], 1.0, 0.05, 0.05, np.full(3, 2e-5)) for i in ids)


def summed(folder: Path, total: int) -> None:
    """Open, read and sum up; print seconds and memory."""
    study = study_from(4096, total, SCENE, {"kind": "airlight"})
    started = time.perf_counter(), time.process_time()
    cells = cells_of(study)
    batches = batches_of(cells)
    with opened(folder, study) as store:
        (levels,) = levels_of(store.rows(), cells, batches)
    wall, cpu = time.perf_counter() - started[0], time.process_time() - started[1]
    status = Path("/proc/self/status").read_text()  # getrusage would count in what this process was forked from
    peak = int(status.split("VmHWM:")[1].split()[0]) / 1e6
    n = len(levels[0].rows)
    print(
        f"{n} batches opened, checked, read and summed up in {wall:.1f} s ({cpu:.1f} s of processor), peak {peak:.2f} GB"
    )


def large(total: int) -> None:
    """Print what summing up a very large study takes, in a process of its own."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_large(folder, study_from(4096, total, SCENE, {"kind": "airlight"}), total)
        size = (folder / FILE).stat().st_size / 1e9
        print(f"a store of {total} batches has {size:.2f} GB on the disk")
        code = LARGE.format(here=str(Path(__file__).parent), folder=name, batches=total)
        subprocess.run([sys.executable, "-c", code], check=True)


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=9, help="of bare drawing, in all")
    parser.add_argument("--batches", type=int, default=1_000_000)
    arguments = parser.parse_args()
    overhead(arguments.seconds)
    large(arguments.batches)


if __name__ == "__main__":
    main()
