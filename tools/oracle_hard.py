"""Every public function of the oracle on 10^5 hard cases against other formulas, many digits, another solver and plain walks.

    python tools/oracle_hard.py [CASES] [SEED] [--only WORD] [--table FILE]

The cases stand in tools/hard, a module a theme. A case is broken if |value - truth| exceeds the stated error plus what the truth
itself is in doubt by, if anything is not a number, or if the oracle raises an error. Exits with 1 if one is.
--table writes the accuracy of every function to a file (docs/oracle-accuracy.md).
"""

from __future__ import annotations

import argparse
import importlib
import math
import os
import pkgutil
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import mpmath as mp
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(1, str(Path(__file__).parents[1] / "tests" / "truth"))
import hard
from hard.case import Case, Kind

from fogproof import analytic

BATCH = 20
NOT_A_QUANTITY = {"Coefficients", "Golden", "coefficients", "golden_values"}
"""Public names that give no value of their own."""

ELSEWHERE = {
    "sky_colour": "tests/oracle/test_colour.py",
    "sun_colour": "tests/oracle/test_colour.py",
}
"""Functions that are sums or products of others, and where they are compared with the truth."""


def kinds() -> dict[str, Kind]:
    """Return all kinds of cases: a function, and what it is held to where there is more than one."""
    found: dict[str, Kind] = {}
    for module in pkgutil.iter_modules(hard.__path__):
        found |= getattr(importlib.import_module(f"hard.{module.name}"), "KINDS", {})
    return dict(sorted(found.items()))


def missing() -> set[str]:
    """Return the public functions of the oracle that have no case."""
    return set(analytic.__all__) - {name.split("/")[0] for name in kinds()} - NOT_A_QUANTITY - set(ELSEWHERE)


def judged(kind: Kind, rng: np.random.Generator) -> Case | str:
    """Return one case, or what went wrong."""
    given = "a case being drawn"
    try:
        call, truth, doubt, given = kind.draw(rng)
        start = time.perf_counter()
        reference = call()
    except Exception as error:  # whatever it is, it is one the oracle should not raise
        return f"{type(error).__name__}: {error} for {given}"
    seconds = time.perf_counter() - start
    value, error = float(reference.value), float(reference.error)
    if math.isnan(value) or math.isnan(error):
        return f"not a number for {given}"
    return Case(value, error, mp.mpf(truth), mp.mpf(doubt), given, seconds)


def share(case: Case) -> float:
    """Return by how much a case is off, beyond the doubt of the truth, as a share of the stated error."""
    off = abs(mp.mpf(case.value) - case.truth) - case.doubt
    if off <= 0:
        return 0.0
    return float(off / mp.mpf(case.error)) if case.error else math.inf


def batch(job: tuple[str, int, int]) -> tuple[str, list[Case | str]]:
    """Return what became of a batch of cases of a kind."""
    name, seed, index = job
    rng = np.random.default_rng([seed, index])
    kind = kinds()[name]
    return name, [judged(kind, rng) for _ in range(BATCH)]


def jobs(count: int, seed: int, only: str) -> Iterator[tuple[str, int, int]]:
    """Yield batches of all kinds, in proportion to their shares, at least one each."""
    chosen = {name: kind for name, kind in kinds().items() if only in name}
    whole = sum(kind.share for kind in chosen.values())
    index = 0
    for name, kind in chosen.items():
        for _ in range(max(1, round(count * kind.share / whole / BATCH))):
            yield name, seed, index
            index += 1


def row(name: str, cases: list[Case]) -> str:
    """Return a row of the table: cases, worst relative error and bound, worst share of the stated error, microseconds."""
    shares = [share(case) for case in cases]
    sizes = [float(abs(case.truth)) for case in cases]
    off = [float(abs(mp.mpf(c.value) - c.truth) - c.doubt) / s for c, s in zip(cases, sizes, strict=True) if s > 1e-290]
    stated = sorted(c.error / s for c, s in zip(cases, sizes, strict=True) if s > 1e-290)
    usual, worst = (stated[len(stated) // 2], stated[-1]) if stated else (0.0, 0.0)
    micro = sorted(case.seconds for case in cases)[len(cases) // 2] * 1e6
    off_by = max([0.0, *off])
    return f"| `{name}` | {len(cases)} | {off_by:.1e} | {usual:.1e} | {worst:.1e} | {max(shares):.2g} | {micro:.0f} |"


HEAD = """| function | cases | worst relative error | stated, usual | stated, worst | worst share of the error | microseconds |
|---|---|---|---|---|---|---|"""


def main() -> None:
    """Judge all cases in all processors."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="?", type=int, default=100_000)
    parser.add_argument("seed", nargs="?", type=int, default=int.from_bytes(os.urandom(4)))
    parser.add_argument("--only", default="", metavar="WORD", help="kinds whose name contains the word")
    parser.add_argument("--table", type=Path, metavar="FILE", help="write the accuracy of every function")
    asked = parser.parse_args()
    start, found = time.perf_counter(), defaultdict(list)
    with ProcessPoolExecutor() as pool:
        for name, results in pool.map(batch, jobs(asked.cases, asked.seed, asked.only)):
            found[name] += results
    rows, broken, total = [], [], 0
    for name, results in found.items():
        cases = [case for case in results if isinstance(case, Case)]
        total += len(results)
        broken += [f"{name}: {text}" for text in results if isinstance(text, str)]
        broken += [
            f"{name}: {share(c):.3g} times the error, {c.value!r} +- {c.error:.3g} for {c.given}"
            for c in cases
            if share(c) > 1
        ]
        rows += [row(name, cases)] if cases else []
    title = f"{total} cases, seed {asked.seed}: {len(broken)} broken promises"
    print(title, HEAD, *rows, *broken[:50], f"{time.perf_counter() - start:.0f} s", sep="\n")
    if asked.table:
        text = [
            "# Accuracy of the oracle",
            "",
            f"`make oracle-hard`: {title}. After the slash stands what a function is held to where there is more than one thing.",
            "Errors are relative to the truth; the time is that of one call for one value, the median on a busy machine.",
            "",
            HEAD,
            *rows,
            "",
        ]
        asked.table.write_text("\n".join(text), encoding="utf-8")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
