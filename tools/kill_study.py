"""Kill a study at random moments, start it again each time, and compare the end with an undisturbed run; then fill the disk.

    python tools/kill_study.py [--kills 60]

A third of the kills (SIGKILL) each ends the main process of a run with threads, that of one with processes, and a helper of the
latter: a worker or the fork server. The moments are drawn uniformly over what a run takes: while it loads, in the middle of a
transaction, or while the record is written. The program fails if a stored batch is lost, a statistic differs by a bit, a process
is left ten seconds later, or a run that was not itself killed does not end with a sentence. At last the store is put on disks that
are too small: a run must say so, and end alike after there is room.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
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
MARK = "FOGPROOF_KILL_STUDY"
"""What is in the environment of all processes of a run: a server of processes has a session of its own."""

_marks: dict[int, bytes] = {}

WHOM = {"main", "worker", "fork server"}
"""Who is to be killed."""

HELPERS = 10.0
"""Seconds that helpers may outlive the main process."""

DISKS = (16, 96, 240)
"""Sizes of disks that are too small [KiB]: for the tables, for half of the batches, and for nearly all."""


def start(file: Path, folder: Path, executor: str = "threads", most: int | None = None) -> subprocess.Popen[bytes]:
    """Start the study in a session of its own; no file may grow beyond `most` bytes."""

    def limited() -> None:
        if most is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    command = [sys.executable, "-m", "fogproof", "study", str(file), "-o", str(folder), "--executor", executor]
    mark = secrets.token_hex(16)
    with open(complaints(folder), "wb") as said:
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=said, preexec_fn=limited, env={**os.environ, MARK: mark}
        )
    _marks[process.pid] = f"{MARK}={mark}".encode()
    return process


def complaints(folder: Path) -> Path:
    """Return the file of what a run says on stderr: not beside its folder, which may be on a full disk."""
    above = folder.parent.parent if folder.parent.name.startswith("disk-") else folder.parent
    return above / f"{folder.name}.err"


def members(process: subprocess.Popen[bytes]) -> dict[int, str]:
    """Return the processes of a run that are still there, with their commands: whatever their session, they bear its mark."""
    found = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and _marks[process.pid] in (entry / "environ").read_bytes().split(b"\0"):
                state = (entry / "stat").read_text().rpartition(")")[2].split()[0]
                if state != "Z":
                    found[int(entry.name)] = (entry / "cmdline").read_text().replace("\0", " ")
        except OSError:  # it has just ended, or is somebody else's
            continue
    return found


def helper(process: subprocess.Popen[bytes], rng: random.Random) -> tuple[str, int] | None:
    """Return a helper of a run with processes, and what it is: a worker, or the server that forks them."""
    parents = {}
    for pid in members(process):
        try:
            parents[pid] = int((Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
    servers = [pid for pid, parent in parents.items() if parent == process.pid and pid in parents.values()]
    workers = [pid for pid, parent in parents.items() if parent in servers]
    kind = rng.choice(("worker", "fork server"))
    among = workers if kind == "worker" else servers
    return (kind, rng.choice(among)) if among else None


def stored(file: Path, folder: Path) -> set[int]:
    """Return the batches that are there; the system may take a moment to give back a dead process's lock."""
    for _ in range(200):
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


def demand(truth: bool, otherwise: str) -> None:
    """End the program with a sentence if something is not so."""
    if not truth:
        raise SystemExit(otherwise)


def kill(file: Path, folder: Path, executor: str, whom: str, seconds: float, rng: random.Random) -> str | None:
    """Start a run and kill the main process or a helper at a random moment; return whom, nothing if the run was over before."""
    process = start(file, folder, executor)
    moment, victim = time.monotonic() + rng.uniform(0, seconds), None
    while process.poll() is None and victim is None:
        if time.monotonic() >= moment:
            victim = ("main", process.pid) if whom == "main" else helper(process, rng)
        time.sleep(0.01)
    if victim is not None:
        try:
            os.kill(victim[1], signal.SIGKILL)
        except ProcessLookupError:
            victim = None
    code = process.wait(600)
    said = complaints(folder).read_text()
    demand(whom == "main" or code in (0, 2, 3), f"exit code {code}: {said}")
    demand("Traceback" not in said, said)
    ended = time.monotonic()
    while left := members(process):
        demand(time.monotonic() < ended + HELPERS, f"left after {HELPERS} s: {left}")
        time.sleep(0.1)
    return victim[0] if victim else None


def whom_of(done: Counter[str]) -> set[str]:
    """Return which kinds of processes were killed."""
    return {name.partition(" of ")[0] for name in done}


def kills(file: Path, parent: Path, wanted: int, rng: random.Random) -> None:
    """Kill runs, resume them, compare."""
    ways = [("threads", "main"), ("processes", "main"), ("processes", "helper")]
    usual = {}
    for executor in ("threads", "processes"):
        began = time.monotonic()
        start(file, parent / f"whole-{executor}", executor).wait()
        usual[executor] = time.monotonic() - began
    whole, total = digest(parent / "whole-threads"), len(stored(file, parent / "whole-threads"))
    demand(digest(parent / "whole-processes") == whole, "executors differ")
    done, mid, runs = Counter[str](), 0, 0
    folder, kept = parent / "killed", set[int]()
    while done.total() < wanted:
        executor, whom = ways[runs % len(ways)]
        runs += 1
        victim = kill(file, folder, executor, whom, usual[executor], rng)
        if victim:
            done[f"{victim} of {executor}"] += 1
        now = stored(file, folder) if folder.exists() else set()
        demand(kept <= now, f"{len(kept - now)} batches lost")
        print(f"{done.total():3} {victim or 'nobody':11} of {executor:9}: {len(now)} of {total} stored", flush=True)
        mid += bool(victim) and 0 < len(now) < total
        kept = now
        if len(now) == total:  # begin another one
            demand(start(file, folder).wait() in (0, 3), "does not end")
            demand(digest(folder) == whole, "the statistics differ")
            folder, kept = parent / f"killed-{runs}", set()
    demand(start(file, folder).wait() in (0, 3) and digest(folder) == whole, "the statistics differ")
    demand(whom_of(done) >= WHOM or wanted < 12, f"not all kinds of processes were killed: {dict(done)}")
    print(f"{wanted} kills ({dict(done)}), {mid} with a part of the batches stored; the same statistics, nothing left")


@contextmanager
def disk(parent: Path, size: int) -> Iterator[tuple[Path, int | None]]:
    """Make a disk of so many KiB; where that is not allowed, return the longest file instead."""
    place = parent / f"disk-{size}"
    place.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", place], capture_output=True)
    try:
        yield place, None if mounted.returncode == 0 else size * 1024
    finally:
        if mounted.returncode == 0:
            subprocess.run(["umount", place], check=True)


def full_disks(file: Path, parent: Path) -> None:
    """Fill disks of several sizes; what is kept must lead to the same end elsewhere."""
    whole = digest(parent / "whole-threads")
    for size in DISKS:
        with disk(parent, size) as (place, most):
            code = start(file, place / "run", most=most).wait()
            said = complaints(place / "run").read_text()
            demand(code == 2 and "Traceback" not in said and "room" in said, f"{size} KiB: exit code {code}: {said}")
            rest = parent / f"moved-{size}"
            if (place / "run").exists():
                shutil.copytree(place / "run", rest)
        kept = len(stored(file, rest)) if rest.exists() else 0
        demand(start(file, rest).wait() in (0, 3) and digest(rest) == whole, f"{size} KiB: the statistics differ")
        how = "disk" if most is None else "longest file"
        print(f"{how} of {size} KiB: {kept} batches kept, then the same statistics; it said: {said.strip()[:150]}")


def main() -> None:
    """Kill, resume, compare; fill disks."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=60)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(2**31))
    given = parser.parse_args()
    print(f"seed {given.seed}")
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "study.toml"
        file.write_text(STUDY)
        kills(file, Path(name), given.kills, random.Random(given.seed))
        full_disks(file, Path(name))


if __name__ == "__main__":
    main()
