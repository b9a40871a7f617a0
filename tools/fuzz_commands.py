"""Throw broken files and words at every command: each run ends with a true exit code and a sentence, at once and in little memory.

python tools/fuzz_commands.py                    30000 runs
python tools/fuzz_commands.py --runs 1000 --seed 7

Runs happen in this process, by the function that the console script calls; one in `--apart` is repeated as a process of its own
and must end the same. `fuzz_runs` makes them: files of every kind are broken by a few seeded changes, words and options exchanged.
A fault of ours is: an exit code that does not belong to the command, a refusal without a sentence, a traceback, a character that
moves a terminal, a warning, the code `internal`, more than ten seconds of the processor, or a gibibyte in all. It is printed, and
the exit code is 1.
"""

from __future__ import annotations

import argparse
import io
import os
import random
import re
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
from typing import Any, BinaryIO, NamedTuple

from fuzz_files import GIBIBYTE, SECONDS, made, watch
from fuzz_runs import MAKERS, SHARES, Run

from fogproof.cli import main as fogproof

MOVES_A_TERMINAL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


class Ended(NamedTuple):
    """What a call came to."""

    code: object
    out: bytes
    err: bytes
    seconds: float


@contextmanager
def streams(stdin: bytes, out: BinaryIO) -> Iterator[io.BytesIO]:
    """Put bytes in place of stdin and stderr, and a file in place of stdout."""
    kept, err = (sys.stdin, sys.stdout, sys.stderr), io.BytesIO()
    sys.stdin = io.TextIOWrapper(io.BufferedReader(io.BytesIO(stdin)))  # type: ignore[arg-type]
    sys.stdout, sys.stderr = (
        io.TextIOWrapper(file, "utf-8", "backslashreplace", write_through=True) for file in (out, err)
    )
    mine = sys.stdout, sys.stderr
    try:
        yield err
    finally:
        for stream in mine:
            stream.flush()
            stream.detach()
        sys.stdin, sys.stdout, sys.stderr = kept


def here(run: Run, stdout: BinaryIO | None = None) -> Ended:
    """Run it in this process; after `SECONDS` of the processor comes what Ctrl-C is. `stdout` takes what it prints, if given."""
    out = io.BytesIO()
    started = time.process_time()
    code: object = "returned"
    with streams(run.stdin, stdout or out) as err:
        watch(SECONDS)
        try:
            fogproof(run.words)
        except SystemExit as end:
            code = end.code
        except BaseException as error:
            code = repr(error)
        finally:
            watch(0)
        sys.stdout.flush()
        sys.stderr.flush()
        return Ended(code, out.getvalue(), err.getvalue(), time.process_time() - started)


def apart(run: Run) -> Ended:
    """Run it in a process of its own."""
    started = time.monotonic()
    command = [sys.executable, "-m", "fogproof", *run.words]
    try:
        done = subprocess.run(command, input=run.stdin, capture_output=True, timeout=60, check=False)
    except subprocess.TimeoutExpired:
        return Ended("none within a minute", b"", b"", 60.0)
    return Ended(done.returncode, done.stdout, done.stderr, time.monotonic() - started)


def fault_of(run: Run, end: Ended) -> str:
    """Return what is wrong with an end, nothing if it is well."""
    text = (end.out + end.err).decode("utf-8", "replace")
    if end.code == 130 and 130 in run.codes and "go on with" in text:
        return ""
    if end.code not in run.codes:
        return f"exit code {end.code}"
    if "Traceback" in text or re.search("(?<!Syntax)Warning:", text) or '"code": "internal"' in text:
        return "a fault of our own"
    if end.code == 2 and run.words[:1] != ["oracle"] and not end.err.strip():
        return "refused without a sentence"
    binary = run.words[0] == "golden" and "npz" in run.words
    if found := MOVES_A_TERMINAL.search(end.err.decode("utf-8", "replace") if binary else text):
        return f"{found[0]!r} on the terminal"
    return "" if end.seconds < SECONDS else f"{end.seconds:.0f} s"


def fuzz(runs: int, seed: int, folder: Path, record: dict[str, Any], every: int = 0) -> tuple[Counter[str], list[str]]:
    """Return how often each kind of run ended with each code, and the faults; each `every`-th is repeated apart."""

    def stop(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    rng, counts, faults = random.Random(seed), Counter[str](), []
    before = {name: signal.signal(name, stop) for name in (signal.SIGPROF, signal.SIGALRM)}
    bytecode, sys.dont_write_bytecode = sys.dont_write_bytecode, True  # files change within a second
    path = list(sys.path)
    here_before, deep = Path.cwd(), folder / "a" / "b" / "c"  # words may be paths, "../.." among them
    deep.mkdir(parents=True)
    os.chdir(deep)
    try:
        for number in range(runs):
            (kind,) = rng.choices(list(SHARES), list(SHARES.values()))
            run = MAKERS[kind](rng, folder, record)
            end = here(run)
            counts[f"{kind} {end.code}"] += 1
            fault = fault_of(run, end)
            if not fault and every and number % every == every - 1:
                for place in ("study", "compared", *(f"renders-{n}" for n in range(4))):
                    shutil.rmtree(folder / place, ignore_errors=True)
                again = apart(run)
                counts["apart"] += 1
                late = b'"code": "timeout"' in again.out  # a busy machine loads for longer than a small limit
                differs = again.code != end.code and not late
                fault = fault_of(run, again._replace(seconds=0)) or differs * f"apart {again.code}"
            if fault:
                files = {f.name: f.read_bytes()[:700] for f in folder.iterdir() if f.is_file()}
                file = next((data for name, data in files.items() if any(name in word for word in run.words)), b"")
                told = (end.err[-300:], end.out[-300:], run.stdin[:500], file)
                faults.append(f"{kind} {number}: {fault}: {run.words!r}: {told!r}")
    finally:
        for name, handler in before.items():
            signal.signal(name, handler)
        sys.dont_write_bytecode, sys.path[:] = bytecode, path
        os.chdir(here_before)
    return counts, faults


def main() -> int:
    """Return 1 if there was a fault."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=30_000)
    parser.add_argument("--apart", type=int, default=300, help="each so many-th run is repeated as a process")
    parser.add_argument("--seed", type=int, default=secrets.randbits(32))
    given = parser.parse_args()
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        counts, faults = fuzz(given.runs, given.seed, Path(folder), made(), given.apart)
    memory = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    for fault in faults[:30]:
        print(fault)
    print(", ".join(f"{n} {name}" for name, n in sorted(counts.items())))
    took = f"{time.monotonic() - start:.0f} s, {memory / 1024:.0f} MiB at most"
    print(f"{given.runs} runs, seed {given.seed}: {len(faults)} faults; {took}")
    return int(bool(faults) or memory > GIBIBYTE)


if __name__ == "__main__":
    sys.exit(main())
