"""Kill a study at random moments, start it again each time, and compare the end with an undisturbed run.

    python tools/kill_study.py [--kills 20] [--executor threads]

The moments are drawn uniformly over what a run takes. A kill (SIGKILL) ends the process wherever it is: loading, in the middle of a
transaction, or while the record is written. The program fails if a stored batch is lost or a statistic differs by a bit.
"""

from __future__ import annotations

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from fogproof.errors import FogproofError
from fogproof.study import read_study
from fogproof.study.store import opened

STUDY = """
title = "to be killed"
samples = [100, 1000, 10_000]
replicates = 96
batch = 2048

[[scenes]]
name = "lamp in haze"
quantity = "airlight"
medium = { sigma_a = 0.1, sigma_s = 0.4 }
ray = { origin = [0, 0, -2], direction = [0, 0, 1], length = 5 }
light = { position = [0.6, -0.8, 0.5], intensity = 3 }
estimators = ["airlight", "mis", "marched-airlight"]

[[scenes]]
name = "grid"
quantity = "transmittance"
medium = { kind = "random-grid", cells = [1, 1, 64], lower = [-1, -1, 0], upper = [1, 1, 2], high = 2 }
ray = { origin = [0, 0, 0], direction = [0, 0, 1], length = 2 }
estimators = ["regular", "delta", "ratio", "march"]
"""


def start(file: Path, folder: Path, executor: str) -> subprocess.Popen[bytes]:
    """Start the study in a process of its own."""
    code = "from fogproof.cli import main; main()"
    command = [sys.executable, "-c", code, "study", str(file), "-o", str(folder), "--executor", executor]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def stored(file: Path, folder: Path) -> set[int]:
    """Return the batches that are there; the system may take a moment to give back a dead process's lock."""
    for _ in range(100):
        try:
            with opened(folder, read_study(file)) as store:
                return store.done()
        except FogproofError as error:
            if "another process" not in str(error):
                raise
            time.sleep(0.05)
    raise SystemExit("the lock of a dead process was not given back")


def digest(folder: Path) -> str:
    """Return the sum of all that does not depend on the clock."""
    return str(json.loads((folder / "results.json").read_text())["digest"])


def main() -> None:
    """Kill, resume, compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--executor", default="threads")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "study.toml"
        file.write_text(STUDY)
        started = time.perf_counter()
        start(file, Path(name) / "whole", arguments.executor).wait()
        whole, seconds = digest(Path(name) / "whole"), time.perf_counter() - started
        total = len(stored(file, Path(name) / "whole"))
        folder, kept, kills, mid = Path(name) / "killed", set[int](), 0, 0
        while kills < arguments.kills:
            process = start(file, folder, arguments.executor)
            moment = random.uniform(0, seconds)
            try:
                process.wait(moment)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.wait()
                kills += 1
            now = stored(file, folder) if folder.exists() else set()
            lost = kept - now
            print(f"kill {kills:2} after {moment:5.2f} s: {len(now)} of {total} batches stored, {len(lost)} lost")
            if lost:
                raise SystemExit(1)
            mid += 0 < len(now) < total
            kept = now
            if len(now) == total and kills < arguments.kills:  # begin another one
                if start(file, folder, arguments.executor).wait() == 2 or digest(folder) != whole:
                    raise SystemExit("the statistics differ")
                folder, kept = Path(name) / f"killed-{kills}", set()
        start(file, folder, arguments.executor).wait()
        same = digest(folder) == whole
        print(f"{kills} kills, {mid} of them with a part of the batches stored; the same statistics: {same}")
        raise SystemExit(0 if same else 1)


if __name__ == "__main__":
    main()
