"""Throw broken files at everything that reads files: each is read, or refused by a named error, at once and in little memory.

python tools/fuzz_files.py               60000 files
python tools/fuzz_files.py --files 1000 --seed 7

Valid grids (`.npy`, `.vol`), scenes, studies and records are broken by a few seeded changes: bytes flipped, cut, inserted; lying
headers; numbers, keys and types of tables exchanged. Anything but an answer or a `FogproofError`, more than ten seconds of the
processor for one file, or a gibibyte in all is a fault of ours: it is printed, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import copy
import io
import json
import random
import resource
import secrets
import signal
import struct
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import numpy as np

from fogproof.errors import FogproofError
from fogproof.reports import compare_exit_code, read_record, write_report
from fogproof.reports.records.runs import SCHEMA
from fogproof.scene.files import read_fields
from fogproof.scene.scenes import Scene
from fogproof.scene.volume_files import read_voxel_grid
from fogproof.study.files import study_of
from fogproof.study.record import read_results

SECONDS, GIBIBYTE = 10, 2**20
"""The most time of one file, of the processor; the most memory of all [KiB]."""

VALUES: list[Any] = [
    0, 1, -1, 0.5, -0.0, 10**30, 10**308, -(10**310), 5e-324, 1e200, float("inf"), float("nan"), "inf", "nan", "1", "", None,
    True, [], {}, [[]], [1, 2], [0.1, 0.2, 0.3], [1, [2, 3]], ["a"], [None], {"kind": "point"}, "\x1b[31m", "\u202e", "x" * 3000,
]  # fmt: skip
KINDS = [
    "<f8",
    "<f4",
    ">f4",
    "|u1",
    "<i8",
    "|O",
    "<U4",
    "<c16",
    "|V8",
    "|b1",
    "<f16",
    "<M8[s]",
    [("a", "<f8")],
    "f9",
    "",
    3,
    None,
]
SIZES = [0, 1, 2, 3, -1, 2**31, 2**32, 2**62, 2**64, 10**30, True, 1.5, "2", None]
SCENE = {
    "scattering": "single", "background": 0.5,
    "medium": {"sigma_a": 0.1, "sigma_s": 0.2, "phase": {"kind": "henyey-greenstein", "g": 0.5}},
    "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 4}, "light": {"position": [0, 1, 2], "intensity": 3},
}  # fmt: skip
STUDY = {
    "title": "a study", "samples": [10, 100], "replicates": 8,
    "scenes": [{
        "name": "lamp", "quantity": "airlight", "medium": {"sigma_a": 0.1, "sigma_s": 0.2},
        "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 4}, "light": {"position": [0, 1, 2], "intensity": 3},
        "estimators": [{"kind": "airlight", "placing": "equiangular"}, {"kind": "mis"}],
    }],
}  # fmt: skip


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


def broken_bytes(rng: random.Random, data: bytes) -> bytes:
    """Return the bytes with up to three changes."""
    for _ in range(rng.randrange(4)):
        at = rng.randrange(len(data) + 1)
        match rng.randrange(5):
            case 0:
                data = data[:at]
            case 1:
                data = data[:at] + rng.randbytes(rng.randrange(1, 9)) + data[at:]
            case 2:
                data = data[:at] + data[at + rng.randrange(1, 9) :]
            case 3:
                data = rng.choice((b"", b"PK\x03\x04", b"\x00", b"\x80\x04")) + data
            case _:
                data = data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    return data


def broken_table(rng: random.Random, table: Any) -> Any:
    """Return the table with one to three values, keys or types exchanged."""
    table = copy.deepcopy(table)
    for _ in range(rng.randrange(1, 4)):
        places = list(_places(table))
        if not places:
            break
        inside, key = rng.choice(places)
        match rng.randrange(5):
            case 0:
                del inside[key]
            case 1 if isinstance(inside, dict):
                inside[rng.choice(("kind", "x", "", "length", "\x1b"))] = rng.choice(VALUES)
            case 2 if isinstance(inside[key], int | float) and abs(inside[key]) < 1e300:
                inside[key] = -inside[key] if rng.random() < 0.3 else inside[key] * 10.0 ** rng.randrange(-300, 300, 50)
            case _:
                inside[key] = copy.deepcopy(rng.choice(VALUES))
    return table


def _places(table: Any) -> Iterator[tuple[Any, Any]]:
    for key in table if isinstance(table, dict) else range(len(table)):
        yield table, key
        if isinstance(table[key], dict | list):
            yield from _places(table[key])


def npy(rng: random.Random) -> bytes:
    """Return a grid whose header may lie."""
    out = io.BytesIO()
    np.save(out, np.arange(24, dtype=rng.choice(("<f8", "<f4", ">f4", "u1", "<i8"))).reshape(2, 3, 4))
    data = out.getvalue()
    if rng.random() < 0.6:
        shape = tuple(rng.choice(SIZES) for _ in range(rng.randrange(6)))
        table = {"descr": rng.choice(KINDS), "fortran_order": rng.choice((True, False, 1, None)), "shape": shape}
        if rng.random() < 0.2:
            del table[rng.choice(list(table))]
        header = repr(table).encode() if rng.random() < 0.9 else b"(" * rng.randrange(3000)
        data = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header) + 1) + header + b"\n" + data[128:]
    return broken_bytes(rng, data)


def vol(rng: random.Random) -> bytes:
    """Return a grid whose header may lie."""
    sizes = [rng.choice((1, 2, 3, 0, -1, 2**31 - 1, 2**16)) if rng.random() < 0.1 else 2 for _ in range(4)]
    box = [
        rng.choice((0.0, 1.0, -1.0, float("nan"), float("inf"), 1e38)) if rng.random() < 0.05 else k // 3
        for k in range(6)
    ]
    head = struct.pack("<3sBi4i6f", b"VOL", rng.choice((3, 3, 3, 0, 255)), rng.choice((1, 1, 3, 0, -5)), *sizes, *box)
    return broken_bytes(rng, head + np.linspace(0, 1, 16, dtype="<f4").tobytes())


def text_of(rng: random.Random, table: Any) -> bytes:
    """Return a broken table as JSON, perhaps broken as a text too."""
    text = json.dumps(broken_table(rng, table)).encode()
    return broken_bytes(rng, text) if rng.random() < 0.2 else text


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
    parser.add_argument("--files", type=int, default=60_000)
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
