"""Are the times that a study states those of the estimators? Busy loops of known processor time, and work that grows with n.

    python tools/study_times.py [--executor processes] [--workers 1]

The truth is a loop of calls with nothing else in it. Printed are stated times over true ones: 1 is right.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.study import read_study, run_study

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


def true_time(estimator: Any, n: int) -> float:
    """Return the processor time of a call [s], the median over eight loops."""
    rng, calls, loops = np.random.default_rng(1), max(2, 50_000 // n // 10), []
    estimator.draw(rng, n)
    for _ in range(8):
        start = time.thread_time()
        for _ in range(calls):
            estimator.draw(rng, n)
        loops.append((time.thread_time() - start) / calls)
    return float(np.median(loops))


def main() -> int:
    """Print every ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executor", default="processes")
    parser.add_argument("--workers", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "spin.py").write_text(SPIN)
        (place / "study.toml").write_text(STUDY)
        study = read_study(place / "study.toml")
        record = run_study(study, place / "run", executor=arguments.executor, workers=arguments.workers)
    own: dict[str, Any] = {}
    exec(SPIN, own)
    for entry in record["scenes"][0]["estimators"]:
        estimator = own[entry["name"].partition(":")[2]](None)
        for told in entry["speed"]["counts"]:
            truth = true_time(estimator, told["count"])
            low, value, high = (told[key] / truth for key in ("low", "seconds", "high"))
            within = "" if low <= 1 <= high else "  the interval misses it"
            print(
                f"{entry['name']:14} n = {told['count']:6}  {1e6 * truth:10.2f} us  {value:5.2f} [{low:5.2f}, {high:5.2f}]{within}"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
