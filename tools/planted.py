"""Is every stated resolution true? An error of exactly that size is planted, and must be caught as often as stated.

    python tools/planted.py [--trials 300] [--samples 30000] [--only TEXT]

For each kind of finding a right sampler passes and says what it would have caught; then the same sampler with that very error is
judged again and again. What is counted is that finding alone, whatever else rejects. A part of `make calibrate`.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
from planted_errors import PLANTS, Plant

from fogproof.checks import Finding, SamplerCheck, Subject, fresh_seed

ALPHA = 1e-4


def _found(check: str, findings: tuple[Finding, ...]) -> Iterator[Finding]:
    for finding in findings:
        name = re.sub(r"labels in \d+ cells", "labels in cells", finding.check)
        if name == check or name.startswith((f"{check} of ", f"{check} in ")):
            yield finding


def _judged(subject: Subject, samples: int, seed: int) -> tuple[Finding, ...]:
    return SamplerCheck.of(subject, None, samples, ALPHA, seed).run().findings


def stated(plant: Plant, samples: int, seed: int) -> tuple[str, float]:
    """Return what the resolution of a right sampler's pass is of, and its value: the median of three."""
    found = [next(_found(plant.check, _judged(plant.right(), samples, seed + i))) for i in range(3)]
    resolutions = [f.resolution for f in found if f.resolution is not None]
    assert len(resolutions) == len(found), f"{plant.check} states no resolution"
    return resolutions[0].kind, float(np.median([r.value for r in resolutions]))


def caught(plant: Plant, kind: str, size: float, trials: int, samples: int, seed: int) -> int:
    """Return how many of so many errors of the given size were caught by that very finding."""
    extra: dict[str, Any] = {"cells": int(re.findall(r"(\d+) cells", kind)[0])} if plant.cells else {}
    hits = 0
    for trial in range(trials):
        subject = plant.wrong(plant.right(), size, trial, bool(trial % 2), **extra)
        findings = _judged(subject, samples, seed + trial)
        hits += any(f.outcome == "rejected" for f in _found(plant.check, findings))
    return hits


def least(plant: Plant, trials: int) -> int:
    """Return how many must be caught, if 99 of 100 are but for chance."""
    return trials if plant.sure else int(0.99 * trials - 4 * np.sqrt(trials * 0.0099))


def section(trials: int, samples: int, seed: int, only: str = "") -> tuple[str, bool]:
    """Return the part of the result page about resolutions, and whether all are true."""
    lines = [
        f"## Stated resolutions, alpha = {ALPHA:g}",
        "",
        f"Of each kind of finding, as stated for {samples} samples: an error of exactly that size is planted, in both directions",
        "and at changing places. 99 of 100 must be caught by that very finding; the last column is how many of half the size are.",
        "",
        "| kind of finding | resolution | value | caught | of | at least | of half |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]
    good = True
    for plant in PLANTS:
        if only in plant.check:
            kind, size = stated(plant, samples, seed)
            tried = 4 if plant.sure else trials
            hits = caught(plant, kind, size, tried, samples, seed + 10)
            halves = max(tried // 4, 1)
            half = caught(plant, kind, 0.5 * size, halves, samples, seed + 10 + tried) / halves
            good &= hits >= least(plant, tried)
            lines.append(
                f"| {plant.check} | {kind} | {size:.3g} | {hits} | {tried} | {least(plant, tried)} | {half:.0%} |"
            )
            print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines) + "\n", good


def main() -> None:
    """Print the table; exit 1 if a resolution is not true."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=300)
    parser.add_argument("--samples", type=int, default=30_000)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    text, good = section(arguments.trials, arguments.samples, fresh_seed() >> 2, arguments.only)
    print(text)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
