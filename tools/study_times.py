"""Are the times that a study states those of the estimators? Busy loops of known processor time, and work that grows with n.

    python tools/study_times.py

The truth is a loop of calls with nothing else in it, timed after each batch of the same estimator, so that it meets the machine in
the same moods. Printed are stated times over true ones: 1 is right.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.contracts import Estimator
from fogproof.study import read_study
from fogproof.study.batches import BatchResult, draw_batch
from fogproof.study.cells import Cell, cells_of
from fogproof.study.plan import Batch, batches_of
from fogproof.study.record import Circumstances, make_record
from fogproof.study.run import draw_missing
from fogproof.study.store import opened
from fogproof.workers.executors import open_workers

WITHIN = {1e-5: 0.1, math.inf: 0.05}
"""How far a stated time may be off, of calls that take less than so many seconds, where its own interval says no more."""
NAMES = ("Call1", "Call10", "Call100", "Call1000", "Vector")
COUNTS = (16, 1024, 65536)
SPIN = f"""
import math, time
import numpy as np

class Base:
    cost, turns = 0.0, 0
    def __init__(self, scene):
        pass
    def draw(self, rng, n):
        end = time.thread_time() + self.cost
        while self.cost and time.thread_time() < end:
            pass
        x = rng.standard_normal(n)
        for _ in range(self.turns):
            x = np.sin(x)
        return {math.exp(-1)!r} + 0.05 * rng.standard_normal(n)

class Call1(Base):
    cost = 1e-6
class Call10(Base):
    cost = 1e-5
class Call100(Base):
    cost = 1e-4
class Call1000(Base):
    cost = 1e-3
class Vector(Base):
    turns = 10
"""
STUDY = f"""
samples = {list(COUNTS)}
replicates = 64
[[scenes]]
name = "known times"
quantity = "transmittance"
medium = {{ sigma_a = 0.05, sigma_s = 0.05 }}
ray = {{ origin = [0, 0, 0], direction = [0, 0, 1], length = 10 }}
estimators = {[f"spin:{name}" for name in NAMES]}
"""


def true_time(estimator: Estimator, n: int) -> float:
    """Return the processor time of a call [s], the mean of those that a millisecond holds, two at least."""
    rng, calls = np.random.default_rng(1), 0
    estimator.draw(rng, n)
    start = time.thread_time()
    while calls < 2 or (calls % 16 or time.thread_time() - start < 1e-3):
        estimator.draw(rng, n)
        calls += 1
    return (time.thread_time() - start) / calls


def measured(folder: Path) -> tuple[dict[str, Any], dict[tuple[int, int], list[float]]]:
    """Return the record of the study, and the true times of each estimator at each count."""
    study = read_study(folder / "study.toml")
    cells = cells_of(study)
    batches, truths = batches_of(cells), defaultdict[tuple[int, int], list[float]](list)
    made: dict[str, Any] = {}
    exec(SPIN, made)

    def draw(text: str, place: str, batch: Batch, reference: float) -> BatchResult:
        cell: Cell = cells[batch.cell]
        result = draw_batch(cell, batch, reference)
        own = made[cell.name.partition(":")[2]](None)  # as it was written, without what the study puts around it
        truths[batch.cell, batch.size].append(true_time(own, batch.samples))
        return result

    with opened(folder / "run", study) as store:
        with open_workers("threads", 1) as pool:
            draw_missing(study, cells, batches.in_turn(), store, pool, draw=draw)
        return make_record(study, cells, batches, store, Circumstances("", "", 0.0, "threads", 1)), truths


def main() -> int:
    """Print every ratio; 1 if one is off by more than `WITHIN` says."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "spin.py").write_text(SPIN)
        (place / "study.toml").write_text(STUDY)
        record, truths = measured(place)
    bad = 0
    for index, entry in enumerate(record["scenes"][0]["estimators"]):
        for told in entry["speed"]["counts"]:
            truth = math.exp(float(np.mean(np.log(truths[index, told["count"]]))))
            low, value, high = (told[key] / truth for key in ("low", "seconds", "high"))
            within = next(share for most, share in WITHIN.items() if truth < most)
            off = "" if low <= 1 + within and high >= 1 - within else f"  off by more than {within:.0%}"
            bad += bool(off)
            where = f"{entry['name']:14} n = {told['count']:6}  {1e6 * truth:10.2f} us"
            print(f"{where}  {value:5.3f} [{low:5.3f}, {high:5.3f}]{off}")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
