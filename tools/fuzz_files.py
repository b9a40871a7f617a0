"""Throw broken files at everything that reads files: each is read, or refused by a named error, at once and in little memory.

python tools/fuzz_files.py               100000 files
python tools/fuzz_files.py --files 1000 --seed 7

Grids (`.npy`, `.vol`, `.nvdb`), images, samples, specs, scenes, studies and records are broken by `broken_files`. Anything but an
answer or a `FogproofError`, more than ten seconds of the processor for one file, or a gibibyte in all is a fault of ours: it is
printed, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import json
import random
import resource
import secrets
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

from broken_files import SCENE, SPEC, STUDY, broken_table, image, npy, nvdb, rows, text_of, toml, vol

from fogproof.errors import FogproofError
from fogproof.images.formats import SUFFIXES, format_of
from fogproof.input_files import read_toml
from fogproof.pipe.files import read_rows
from fogproof.pipe.spec import spec_of
from fogproof.reports import compare_exit_code, read_record, write_report
from fogproof.reports.records.runs import SCHEMA
from fogproof.scene.files import read_fields
from fogproof.scene.scenes import Scene
from fogproof.scene.volume_files import read_voxel_grid
from fogproof.study.files import study_of
from fogproof.study.record import read_results

SECONDS, GIBIBYTE = 10, 2**20
"""The most time of one file, of the processor; the most memory of all [KiB]."""


class Kind(NamedTuple):
    """One kind of file: what a broken one holds, and who reads it."""

    name: str
    suffix: str
    make: Callable[[random.Random], bytes]
    read: Callable[[Path], object]
    share: int = 8


class TooSlow(BaseException):
    """A file took more than `SECONDS` of the processor."""


def watch(seconds: float) -> None:
    """Ask for a signal after so many seconds of the processor, and after thirty times as many of the clock; 0 takes it back."""
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, 30 * seconds)


def kinds_of(folder: Path, run: dict[str, Any]) -> list[Kind]:
    """Return what is thrown."""
    box: dict[str, Any] = {"lower": (0, 0, 0), "upper": (1, 1, 1)}

    def scene(path: Path) -> object:
        return read_fields({"scene": Scene}, {"scene": json.loads(path.read_bytes())}, str(path))

    def page(path: Path) -> object:
        here = path.parent / "page"
        here.mkdir(exist_ok=True)
        path.replace(here / "results.json")
        found = read_record(here)
        compare_exit_code(found, found)
        return write_report(found, here, keep=True)

    return [
        Kind("npy", ".npy", npy, lambda path: read_voxel_grid(path, **box)),
        Kind("vol", ".vol", vol, read_voxel_grid),
        Kind("nvdb", ".nvdb", nvdb, read_voxel_grid, share=2),
        *(Kind(f"image{suffix}", suffix, partial(image, path=folder / f"whole{suffix}"), lambda path: format_of(path).read(path), 2)
          for suffix in SUFFIXES),
        Kind("samples", ".csv", rows, lambda path: read_rows(path, 3, "float64"), 2),
        Kind("samples", ".npy", npy, lambda path: read_rows(path, 3, "float64"), 2),
        Kind("spec", ".toml", lambda rng: toml(broken_table(rng, SPEC)).encode(),
             lambda path: spec_of(read_toml(path, "the spec file"), str(path)), 4),
        Kind("scene", ".json", lambda rng: json.dumps(broken_table(rng, SCENE)).encode(), scene),
        Kind("study", ".json", lambda rng: json.dumps(broken_table(rng, STUDY)).encode(),
             lambda path: study_of(path.read_text(), str(folder), str(path))),
        Kind("record", ".json", lambda rng: text_of(rng, run), page, share=1),  # a page takes a second
        Kind("results", ".json", lambda rng: text_of(rng, {"schema": SCHEMA, "kind": "study"}), read_results),
    ]  # fmt: skip


def fuzz(files: int, seed: int, folder: Path, run: dict[str, Any]) -> tuple[Counter[str], list[str]]:
    """Return how many files of each kind were read and refused, and the faults."""

    def late(number: int, frame: FrameType | None) -> None:
        raise TooSlow

    rng, counts, faults = random.Random(seed), Counter[str](), []
    for name in (signal.SIGPROF, signal.SIGALRM):
        signal.signal(name, late)
    kinds = [kind for kind in kinds_of(folder, run) for _ in range(kind.share)]
    for number in range(files):
        kind = kinds[number % len(kinds)]
        path = folder / f"file{kind.suffix}"
        path.write_bytes(data := kind.make(rng))
        watch(SECONDS)
        try:
            kind.read(path)
            counts[f"{kind.name} read"] += 1
        except FogproofError:
            counts[f"{kind.name} refused"] += 1
        except (Exception, TooSlow) as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            faults.append(
                f"{kind.name} {number}: {type(error).__name__}: {error!s:.200} at {where.filename}:{where.lineno}: {data[:300]!r}"
            )
        finally:
            watch(0)
    return counts, faults


def main() -> int:
    """Return 1 if there was a fault."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=secrets.randbits(32))
    parser.add_argument("--record", type=Path, help="a results.json to break; one of two cases is made unless given")
    given = parser.parse_args()
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        run = json.loads(given.record.read_text()) if given.record else made()
        counts, faults = fuzz(given.files, given.seed, Path(folder), run)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for fault in faults[:20]:
        print(fault)
    print(", ".join(f"{n} {name}" for name, n in sorted(counts.items())))
    took = f"{time.monotonic() - start:.0f} s, {memory / 1024:.0f} MiB at most"
    print(f"{given.files} files, seed {given.seed}: {len(faults)} faults; {took}")
    return int(bool(faults) or memory > GIBIBYTE)


def made() -> dict[str, Any]:
    """Return the record of a run of two cases."""
    command = [sys.executable, "-c", "from fogproof.cli import main; main()", "verify", "fog/analog", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


if __name__ == "__main__":
    sys.exit(main())
