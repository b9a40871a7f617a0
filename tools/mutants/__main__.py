"""Plant errors one at a time and run the tests that should see them.

    python tools/mutants [--part checks] [--match WORD] [--sample 30 --seed 1] [--again] [--wide] [--jobs 2]

First the tests that an error names, then those that import its module; a survivor meets the whole folder of tests with `--wide`.
Results go line by line to tools/mutants/record.jsonl, which is kept with the sources; what is there is not run again, but for
`--again`, which tries survivors once more. `--table` writes docs/mutants.md from them. With `--sample` the program fails if an
error survives that is not known to be harmless.
"""

from __future__ import annotations

import argparse
import json
import queue
import random
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mutants.copies import Copy
from mutants.mutant import ROOT, Mutant, mutants
from mutants.reach import folders, tests_of
from mutants.table import write

RESULTS = Path(__file__).parent / "record.jsonl"


def results(path: Path) -> dict[str, dict]:
    """Return the last result of every error that was tried."""
    lines = path.read_text().splitlines() if path.exists() else []
    return {row["key"]: row for row in map(json.loads, lines)}


def seen(copy: Copy, mutant: Mutant, tests: list[str], seconds: float) -> tuple[str, str]:
    """Plant an error and run some tests; a test that fails without it as well has seen nothing."""
    left_out = [f"--deselect={test}" for test, sound in copy.sound.items() if not sound]
    with copy.wrong(mutant):
        outcome, test = copy.tested([*left_out, *tests], seconds)
    if outcome == "killed" and not copy.is_sound(test, seconds):
        return seen(copy, mutant, tests, seconds)
    return outcome, test


def judged(copy: Copy, mutant: Mutant, importing: int, seconds: float, wide: bool) -> dict:
    """Plant one error and return what became of it."""
    started = time.monotonic()
    named = list(mutant.tests)
    direct = [test for test in tests_of(mutant.file, importing) if test not in named]
    rounds = [tests for tests in (named, direct, list(folders(mutant.file)) if wide else []) if tests]
    outcome, test = "survived", ""
    for tests in rounds:
        outcome, test = seen(copy, mutant, tests, seconds)
        if outcome == "killed":
            break
    took = round(time.monotonic() - started, 1)
    row = {"key": mutant.key, "part": mutant.part, "file": mutant.file, "what": mutant.what}
    return {**row, "outcome": outcome, "test": test, "seconds": took, "wide": wide}


def main() -> int:
    """Run what was asked for; return 1 if something survived that should not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--part", help="list to take errors from")
    parser.add_argument("--match", default="", help="only errors whose file or description holds this")
    parser.add_argument("--sample", type=int, help="so many, drawn by the seed")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="try survivors once more")
    parser.add_argument("--wide", action="store_true", help="survivors meet the whole folder of tests")
    parser.add_argument("--importing", type=int, default=3, help="test files beside the named ones")
    parser.add_argument("--seconds", type=float, default=300, help="limit of one run of tests")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--table", action="store_true", help="write docs/mutants.md and end")
    asked = parser.parse_args()
    everything = mutants()
    if asked.table:
        write(everything, results(RESULTS), ROOT / "docs" / "mutants.md")
        return 0
    chosen = [m for m in everything if asked.part in (None, m.part) and asked.match in f"{m.file} {m.what}"]
    done = results(RESULTS)
    if asked.sample:
        chosen = random.Random(asked.seed).sample(chosen, min(asked.sample, len(chosen)))
    chosen = [m for m in chosen if m.key not in done or (asked.again and done[m.key]["outcome"] != "killed")]
    for mutant in (stale := [m for m in chosen if m.stale]):
        print(f"stale     {mutant.file}: {mutant.what}: write it anew", flush=True)
    chosen = [m for m in chosen if m not in stale]
    lock, survivors = Lock(), []
    copies: queue.Queue[Copy] = queue.Queue()
    with tempfile.TemporaryDirectory(prefix="fogproof-mutants-") as folder:
        for i in range(asked.jobs):
            copies.put(Copy.made(Path(folder) / str(i)))

        def one(mutant: Mutant) -> None:
            copy = copies.get()
            try:
                row = judged(copy, mutant, asked.importing, asked.seconds, asked.wide)
            finally:
                copies.put(copy)
            with lock:
                if row["outcome"] != "killed" and not mutant.harmless:
                    survivors.append(row)
                with RESULTS.open("a") as file:
                    file.write(json.dumps(row) + "\n")
                print(
                    f"{row['outcome']:9} {row['seconds']:6.1f} s  {mutant.file}: {mutant.what}  {row['test']}",
                    flush=True,
                )

        with ThreadPoolExecutor(asked.jobs) as pool:
            list(pool.map(one, chosen))
    print(f"{len(chosen)} errors, {len(survivors)} survive")
    return 1 if asked.sample and survivors else 0


if __name__ == "__main__":
    raise SystemExit(main())
