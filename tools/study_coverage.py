"""Do a study's intervals hold what they say? Estimators of known variance, cost and order are put through whole studies.

    python tools/study_coverage.py [--studies 200] [--equal 12] [-o build/study-coverage.json]

Their time is that of a clock which they move themselves: a fixed cost a call, so much a sample, a fifth of noise, and moods of the
machine that all share. Every interval of the record is held against the truth; 99 % of them should hold it. Speeds of a scene
should hold all at once in 99 % of the studies, also of so many equal estimators, of which chance alone makes one the soonest.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from fogproof.checks import fresh_seed
from fogproof.contracts import Reference
from fogproof.study import batches as drawing
from fogproof.study.batches import draw_batch
from fogproof.study.cells import Cell, cells_of
from fogproof.study.files import study_of
from fogproof.study.methods import table
from fogproof.study.methods.method import Method
from fogproof.study.plan import batches_of
from fogproof.study.reaching import TARGETS
from fogproof.study.record import Circumstances, make_record
from fogproof.study.run import draw_missing
from fogproof.study.store import opened
from fogproof.workers.executors import open_workers

MEAN = 2.0
COUNTS = (16, 128, 1024, 8192)
NOISE = 0.2


class Clock:
    """A clock that stands still until an estimator spends time; the machine has moods of 50 calls."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._lock = threading.Lock()
        self._own = threading.local()
        self._calls = 0
        self._mood = 1.0

    def spend(self, seconds: float) -> None:
        """Let about so many seconds pass in this thread."""
        with self._lock:
            if self._calls % 50 == 0:
                self._mood = math.exp(0.15 * self._rng.normal() - 0.15**2 / 2)
            self._calls += 1
            took = seconds * self._mood * math.exp(NOISE * self._rng.normal() - NOISE**2 / 2)
        self._own.now = self.thread_time() + took

    def thread_time(self) -> float:
        """Return the time of this thread [s]."""
        now: float = getattr(self._own, "now", 0.0)
        return now

    perf_counter = thread_time


@dataclass(frozen=True)
class Synthetic(Method):
    """An estimator of MEAN with known error and cost.

    name   its law: "independent", normal and without bias; "biased", the same and off by `bias_of`; "quasi", whose estimates err by
           sigma / count, normal, as of points that fill space evenly; "march", off by exactly sigma / steps^order
    fixed, each  seconds of a call and of a sample
    power  what the time of the samples grows with, if it is not their number
    twin   tells equal ones apart, so that each draws numbers of its own
    """

    name: str
    sigma: float
    fixed: float
    each: float
    order: float = 0.5
    bias_of: float = 0.0
    power: float = 1.0
    twin: int = 0
    clock: ClassVar[Clock]
    quantity = "transmittance"

    @property
    def title(self) -> str:
        """Its law and its deviation."""
        return f"{self.name} {self.sigma:g} {self.fixed:g} {self.power:g}"

    @property
    def axis(self) -> str:
        """Steps or samples."""
        return "steps" if self.name == "march" else "samples"

    @property
    def bias(self) -> str:
        """Declared, where there is one."""
        return "by design" if self.name in ("biased", "march") else ""

    def make(self, scene: Any, count: int) -> _Drawn:
        """Return the estimator."""
        return _Drawn(self, count)

    def error(self, count: float) -> float:
        """Return the true root mean square error."""
        if self.name in ("quasi", "march"):
            return self.sigma * count**-self.order
        return math.hypot(self.sigma / math.sqrt(count), self.bias_of)

    def time(self, count: float) -> float:
        """Return the true time of an estimate [s]."""
        return self.fixed + self.each * count**self.power

    def time_to(self, target: float) -> float:
        """Return the true time to an error; inf if the bias is larger."""
        if self.name in ("quasi", "march"):
            return self.time((self.sigma / target) ** (1 / self.order))
        left = target**2 - self.bias_of**2
        return self.time(self.sigma**2 / left) if left > 0 else math.inf


@dataclass(frozen=True)
class _Drawn:
    law: Synthetic
    steps: int

    def draw(self, rng: np.random.Generator, n: int) -> np.ndarray:
        law = self.law
        Synthetic.clock.spend(law.time(self.steps if law.name == "march" else n))
        if law.name == "march":
            return np.full(n, MEAN + law.sigma * float(self.steps) ** -law.order)
        if law.name == "quasi":  # points inside an estimate scatter, their mean hardly does
            x = law.sigma * rng.normal(size=n)
            return MEAN + (x - x.mean()) + law.sigma / n * rng.normal()
        return MEAN + law.bias_of + law.sigma * rng.normal(size=n)


LAWS = (
    Synthetic("independent", 0.5, 2e-5, 1e-7),
    Synthetic("independent", 0.1, 1e-4, 2e-6),
    Synthetic("independent", 2.0, 1e-6, 5e-8),
    Synthetic("biased", 0.05, 3e-5, 1e-6, bias_of=0.004),
    Synthetic("independent", 0.3, 3e-5, 1e-9, power=2.0),
    Synthetic("independent", 0.4, 1e-5, 2e-5, power=0.5),
    Synthetic("quasi", 1.0, 4e-5, 3e-7, order=1.0),
    Synthetic("march", 3.0, 5e-6, 4e-7, order=2.0),
    Synthetic("march", 0.3, 5e-6, 1e-7, order=1.0),
)


@contextmanager
def _clock(seed: int) -> Iterator[None]:
    """Let studies read a clock of their own."""
    real = drawing.time
    Synthetic.clock = clock = Clock(seed)
    drawing.time = clock  # type: ignore[assignment]
    table.METHODS["synthetic"] = Synthetic
    try:
        yield
    finally:
        drawing.time = real
        del table.METHODS["synthetic"]


def study(seed: int, laws: tuple[Synthetic, ...] = LAWS, replicates: int = 24) -> dict[str, Any]:
    """Return the record of a study of some laws."""
    ray = {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 1}
    scene = {"name": "s", "question": "Which?", "quantity": "transmittance", "medium": {"sigma_a": 1, "sigma_s": 0}}
    scene |= {"ray": ray, "estimators": [{"kind": "ratio"}]}
    asked = {"samples": COUNTS, "replicates": replicates, "seed": seed, "sobol": False, "scenes": [scene]}
    plan = study_of(json.dumps(asked, sort_keys=True), "/")
    (cell,) = cells_of(plan)
    cells: list[Cell] = []
    for index, law in enumerate(laws):
        own = replace(cell, index=index, method=law, _made={})
        own.__dict__["reference"] = Reference(np.asarray(MEAN), np.asarray(1e-15), "", "")
        cells.append(own)
    plan_of = batches_of(cells)

    def draw(text: str, folder: str, batch: Any, reference: float) -> Any:
        return draw_batch(cells[batch.cell], batch, reference)

    with _clock(seed), tempfile.TemporaryDirectory() as folder, opened(Path(folder), plan) as store:
        store._batches, store._identities = plan_of, [f"{k}" for k in range(len(plan_of.stretches))]
        store._keys = [k << 40 for k in range(len(plan_of.stretches))]
        with open_workers("threads", 1) as pool:
            draw_missing(plan, cells, plan_of.in_turn(), store, pool, draw=draw)
        return make_record(plan, cells, plan_of, store, Circumstances("", "", 0.0, "threads", 1))


def held(record: dict[str, Any], laws: tuple[Synthetic, ...] = LAWS) -> Iterator[tuple[str, bool]]:
    """Yield every interval of a record by its sort, and whether it holds the truth; and whether each outright claim is true."""
    target = TARGETS[0] * MEAN
    soonest = min((law.time_to(target), k) for k, law in enumerate(laws))
    (scene,) = record["scenes"]
    first = next(law for law, e in zip(laws, scene["estimators"], strict=True) if e["speed"]["rank"] == 1)
    speeds = []
    for law, entry in zip(laws, scene["estimators"], strict=True):
        for count, timing in zip(entry["counts"], entry["speed"]["counts"], strict=True):
            yield "error", _within(law.error(count["count"]), count["rmse_low"], count["rmse_high"])
            yield "time", _within(law.time(timing["count"]), timing["low"], timing["high"])
        if law.name in ("independent", "quasi"):
            yield "bias", _within(0.0, entry["bias"]["low"], entry["bias"]["high"])
        if law.name == "independent":
            yield "variance", _within(law.sigma**2, entry["variance"]["low"], entry["variance"]["high"])
        if law.name != "biased":
            yield "order seen", entry["order"] is not None
            yield "order", entry["order"] is None or _within(law.order, entry["order"]["low"], entry["order"]["high"])
        for told in entry["speed"]["targets"]:
            truth = law.time_to(told["error"] * MEAN)
            if told["seconds"] is None:
                yield f"said to be {told['how']}", truth > 0.9 * law.time(COUNTS[-1])
            else:
                yield f"time to an error, {told['how']}", _within(truth, told["low"], told["high"])
        relative = entry["speed"]["relative"]
        if relative is not None:
            speeds.append(_within(first.time_to(target) / law.time_to(target), relative["low"], relative["high"]))
            yield "relative speed", speeds[-1]
    yield "relative speeds, all at once", all(speeds)
    yield "the soonest is named", first.time_to(target) <= 1.05 * soonest[0]


def _within(truth: float, low: float | str, high: float | str) -> bool:
    return float(low) - 1e-9 * abs(truth) <= truth <= float(high) + 1e-9 * abs(truth)


def main() -> int:
    """Print how many intervals of each sort hold the truth; 1 if fewer than 97 % of any do."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--studies", type=int, default=200)
    parser.add_argument(
        "--equal", type=int, default=0, help="so many equal estimators in the place of those of every sort"
    )
    parser.add_argument("-o", "--output", type=Path)
    arguments = parser.parse_args()
    seed = fresh_seed()
    laws = tuple(Synthetic("independent", 0.5, 2e-5, 1e-7, twin=k) for k in range(arguments.equal)) or LAWS
    all_, good = Counter[str](), Counter[str]()
    for k in range(arguments.studies):
        for sort, holds in held(study((seed + k) % 2**62, laws), laws):
            all_[sort] += 1
            good[sort] += holds
    print(f"{arguments.studies} studies from seed {seed}")
    for sort, n in sorted(all_.items()):
        print(f"{sort:40}  {good[sort]:7} of {n:7}  {good[sort] / n:7.2%}")
    if arguments.output:
        arguments.output.parent.mkdir(parents=True, exist_ok=True)
        arguments.output.write_text(json.dumps({"seed": seed, "all": all_, "held": good}, indent=1))
    return int(any(good[sort] < 0.97 * n for sort, n in all_.items()))


if __name__ == "__main__":
    sys.exit(main())
