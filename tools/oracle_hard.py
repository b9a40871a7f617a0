"""Every public function of the oracle on 10^5 hard cases against other formulas, many digits, another solver and plain walks.

    python tools/oracle_hard.py [CASES] [SEED] [--only WORD] [--parts FILE] [--table FILE]

The cases stand in tools/hard, a module a theme. A case is broken if |value - truth| exceeds the stated error plus what the truth
itself is in doubt by, if anything is not a number, or if the oracle raises an error. Exits with 1 if one is.
--parts keeps every batch that is done in a file of JSON lines, and goes on where an interrupted run with the same seed was.
--table writes the accuracy of every function to a file (docs/oracle-accuracy.md).
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import os
import pkgutil
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import mpmath as mp
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(1, str(Path(__file__).parents[1] / "tests" / "truth"))
import hard
from hard.case import Case, Kind

from fogproof import analytic

BATCH = 20
NOT_A_QUANTITY = {"Coefficients", "Golden", "coefficients", "delta_m", "golden_values"}
"""Public names that give no value of their own."""


ELSEWHERE = {
    "image": "tests/images/",
    "microflake_pdf": "tests/oracle/test_microflakes.py",
    "voxel_estimate_cost": "tests/oracle/test_voxel_estimates.py",
    "voxel_estimate_mean": "tests/oracle/test_voxel_estimates.py",
    "voxel_estimate_variance": "tests/oracle/test_voxel_estimates.py",
}
"""Functions whose values are many, or whose truth is a sum over all that may happen, and where they are held to it."""


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


def batch(job: tuple[str, int, int]) -> tuple[str, int, list[Case | str]]:
    """Return what became of a batch of cases of a kind."""
    name, seed, index = job
    rng = np.random.default_rng([seed, index])
    kind = kinds()[name]
    return name, index, [judged(kind, rng) for _ in range(BATCH)]


def kept(path: Path | None, seed: int) -> dict[tuple[str, int], list[Case | str]]:
    """Return the batches in a file of parts, by the name of their kind and their index."""
    done: dict[tuple[str, int], list[Case | str]] = {}
    if path is None or not path.exists():
        return done
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            part = json.loads(line)
        except json.JSONDecodeError:
            continue  # the last line of a run that was killed
        if part["seed"] == seed:
            read = [
                x if isinstance(x, str) else Case(x[0], x[1], mp.mpf(x[0]) + mp.mpf(x[2]), mp.mpf(x[3]), x[4], x[5])
                for x in part["cases"]
            ]
            done[part["name"], part["index"]] = read
    return done


def line_of(name: str, seed: int, index: int, cases: list[Case | str]) -> str:
    """Return a batch as a line of the file of parts; of the truth by how much it is more, in 30 digits."""
    plain = [
        x if isinstance(x, str) else [*x[:2], mp.nstr(x.truth - mp.mpf(x.value), 30), mp.nstr(x.doubt, 30), *x[4:]]
        for x in cases
    ]
    return json.dumps({"name": name, "seed": seed, "index": index, "cases": plain}) + "\n"


def jobs(count: int, seed: int, only: str) -> Iterator[tuple[str, int, int]]:
    """Yield batches of all kinds, in proportion to their shares, at least one each."""
    chosen = {name: kind for name, kind in kinds().items() if only in name}
    whole = sum(kind.share for kind in chosen.values())
    index = 0
    for name, kind in chosen.items():
        for _ in range(max(1, round(count * kind.share / whole / BATCH))):
            yield name, seed, index
            index += 1


TIGHT = 0.05
"""Share of the stated error that a tight one reaches at its worst; where it is less, the table says why."""

REASONS = {
    "ball_": "difference to a coarser solution; the closed forms it is held to are of albedos at which both solutions are exact",
    "half_space_reflectance_orders": "ten times the error of the solution on the circle, for all orders alike",
    "slab_reflectance_orders": "ten times the error of the solution on the circle, for all orders alike",
    "slab_transmittance_orders": "ten times the error of the solution on the circle, for all orders alike",
    "point_source": "the worst over all albedos and distances, measured",
    "radiance_by_ode": "ten times the integrator's own estimate",
    "emitted_radiance/steps": "a jump costs twice the worst place in its panel",
    "path_length_": "Cauchy's bound: the largest value on a circle in the complex plane",
    "scattering_count_": "Cauchy's bound: the largest value on a circle in the complex plane",
    "slab_": "difference to a coarser solution, far above the error of the finer one",
}
"""Why the error is far larger than what a function is off by, by the start of its name."""

ROUNDING = "the worst of every rounding, which in fact cancel"


def reason(name: str, cases: list[Case]) -> str:
    """Return why the stated error of a function is not tight, or nothing if it is."""
    if max(share(case) for case in cases) >= TIGHT:
        return ""
    if not any(case.error for case in cases):
        return "exact"
    if sum(case.doubt > case.error for case in cases) > len(cases) / 2:
        return "the truth is in doubt by more"
    return next((text for start, text in REASONS.items() if name.startswith(start)), ROUNDING)


def row(name: str, cases: list[Case]) -> str:
    """Return a row of the table: cases, worst relative error and bound, worst share of the stated error, microseconds, why."""
    shares = [share(case) for case in cases]
    sizes = [float(abs(case.truth)) for case in cases]
    off = [float(abs(mp.mpf(c.value) - c.truth) - c.doubt) / s for c, s in zip(cases, sizes, strict=True) if s > 1e-290]
    stated = sorted(c.error / s for c, s in zip(cases, sizes, strict=True) if s > 1e-290)
    usual, worst = (stated[len(stated) // 2], stated[-1]) if stated else (0.0, 0.0)
    micro = sorted(case.seconds for case in cases)[len(cases) // 2] * 1e6
    off_by = max([0.0, *off])
    numbers = f"{off_by:.1e} | {usual:.1e} | {worst:.1e} | {max(shares):.2g} | {micro:.0f}"
    return f"| `{name}` | {len(cases)} | {numbers} | {reason(name, cases)} |"


HEAD = """| function | cases | worst relative error | stated, usual | stated, worst | worst share of it | µs | why not tight |
|---|---|---|---|---|---|---|---|"""


def main() -> None:
    """Judge all cases in all processors."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="?", type=int, default=100_000)
    parser.add_argument("seed", nargs="?", type=int, default=int.from_bytes(os.urandom(4)))
    parser.add_argument("--only", default="", metavar="WORD", help="kinds whose name contains the word")
    parser.add_argument("--parts", type=Path, metavar="FILE", help="keep what is done, and go on from it")
    parser.add_argument("--table", type=Path, metavar="FILE", help="write the accuracy of every function")
    asked = parser.parse_args()
    start, found = time.perf_counter(), defaultdict(list)
    done = kept(asked.parts, asked.seed)
    every = list(jobs(asked.cases, asked.seed, asked.only))
    left = [(name, seed, index) for name, seed, index in every if (name, index) not in done]
    for name, _, index in every:
        found[name] += done.get((name, index), [])
    left.sort(
        key=lambda job: -kinds()[job[0]].share
    )  # of an interrupted run as many cases as can be: the slow kinds have few
    with ProcessPoolExecutor() as pool, open(asked.parts or os.devnull, "a", encoding="utf-8") as parts:
        for future in as_completed([pool.submit(batch, job) for job in left]):
            name, index, results = future.result()
            found[name] += results
            parts.write(line_of(name, asked.seed, index, results))
            parts.flush()
    rows, broken, total = [], [], 0
    for name, results in sorted(found.items()):
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
