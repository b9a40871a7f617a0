"""Is a change of speed told from a change of the machine? Pairs of studies of the same estimators, each in a process of its own.

    python tools/study_speeds.py [--pairs 20]

The second of a pair is drawn while the machine does something else as well: nothing, what is interpreted, what moves memory about.
Of equal code no change may be said. Then one estimator of one takes half as long again, which must be said. Printed are the largest
change of equal code, and how often each was said; `ASIDE` and `SHARE` of `study/speed_change.py` are held to it.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fogproof.study import read_study, run_study
from fogproof.study.history import compare

LONGEST = 120
LOADS = {
    "nothing": "",
    "interpreted": f"import time\nwhile time.process_time() < {LONGEST}: pass",
    "memory": f"import numpy as np, time\nx = np.ones(1 << 23)\nwhile time.process_time() < {LONGEST}: x *= 1.0000001",
}
"""What the machine does meanwhile; it ends by itself where nobody ends it."""
OWN = """
import math, os
import numpy as np

class Base:
    def __init__(self, scene):
        self.more = os.environ.get("MORE") == "1"
        self.turn = 0
    def draw(self, rng, n):
        x = self.work(rng, n)
        self.turn += 1
        if self.more and self.turn % 2:  # every other call is made twice
            self.work(rng, n)
        return x

class Arrays(Base):
    def work(self, rng, n):
        return (rng.exponential(1.0, n) > 1.0).astype(float)

class Loop(Base):
    def work(self, rng, n):
        return np.array([1.0 if -math.log(1 - u) > 1.0 else 0.0 for u in rng.random(n).tolist()])

class Tables(Base):
    table = np.linspace(0.0, 1.0, 1 << 22)  # 32 MB, looked up far apart
    def work(self, rng, n):
        return (self.table[rng.integers(0, 1 << 22, n)] < math.exp(-1.0)).astype(float)

class Objects(Base):
    def work(self, rng, n):
        events = [{"u": u, "hit": u < math.exp(-1.0)} for u in rng.random(n).tolist()]
        return np.array([float(event["hit"]) for event in events])
"""
STUDY = """
samples = [64, 1024, 16384]
replicates = 128
[[scenes]]
name = "haze"
quantity = "transmittance"
medium = {{ sigma_a = 0.05, sigma_s = 0.05 }}
ray = {{ origin = [0, 0, 0], direction = [0, 0, 1], length = 10 }}
estimators = ["{name}"]
"""
NAMES = ("own:Arrays", "own:Loop", "own:Tables", "own:Objects", "ratio", "delta", "own:Loop")
AGAIN = "import sys; sys.path.insert(0, 'tools'); import study_speeds; study_speeds.draw(*sys.argv[1:])"


def draw(study: str, folder: str) -> None:
    """Draw a study into a folder."""
    run_study(read_study(study), folder)


@contextmanager
def load(what: str) -> Iterator[None]:
    """Let a process for each processor do something meanwhile."""
    others = [subprocess.Popen([sys.executable, "-c", LOADS[what]]) for _ in range(2 if LOADS[what] else 0)]
    try:
        yield
    finally:
        for other in others:
            other.kill()
            other.wait()


def drawn(place: Path, name: str, more: bool) -> dict[str, Any]:
    """Return the record of a study of one estimator, drawn in a fresh process."""
    with tempfile.TemporaryDirectory(dir=place) as folder:
        study = place / f"{name.replace(':', '-')}.toml"
        study.write_text(STUDY.format(name=name))
        environment = {**os.environ, "MORE": "1" if more else "0"}
        subprocess.run([sys.executable, "-c", AGAIN, str(study), folder], check=True, env=environment)
        record: dict[str, Any] = json.loads((Path(folder) / "results.json").read_text())
        return record


def told(before: dict[str, Any], after: dict[str, Any]) -> tuple[list[str], float, float]:
    """Return what became of the one estimator, the factor of its time, and the resolution."""
    (change,) = compare(before, after)["changes"]
    speed = [word for word in change["became"] if word in ("slower", "faster")]
    return speed, change["time"]["value"], change["time"]["resolution"]


def main() -> int:
    """Print each pair; 1 if a change was said of equal code, or not of code that takes half as long again."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=20)
    pairs = parser.parse_args().pairs
    wrong, missed, largest, first = 0, 0, 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "own.py").write_text(OWN)
        for k in range(pairs):
            name, loaded = NAMES[k % len(NAMES)], list(LOADS)[k % len(LOADS)]
            before = drawn(place, name, more=False)
            with load(loaded):
                equal = told(before, drawn(place, name, more=False))
                more = told(before, drawn(place, name, more=True)) if name.startswith("own:") else None
            wrong, largest = wrong + bool(equal[0]), max(largest, abs(math.log(equal[1])))
            said = f"equal code {equal[1]:5.3f} times as long, resolution {equal[2]:5.3f} {' '.join(equal[0])}"
            if more:
                first, missed = first + 1, missed + (more[0] != ["slower"])
                said += f"; half as long again {more[1]:5.3f}, resolution {more[2]:5.3f} {' '.join(more[0])}"
            print(f"{name:12} {loaded:12} {said}", flush=True)
    print(f"{wrong} of {pairs} said to have changed that had not, by {math.exp(largest):.3f} at most")
    print(f"{missed} of {first} not said to be slower that were")
    return int(wrong + missed > 0)


if __name__ == "__main__":
    sys.exit(main())
