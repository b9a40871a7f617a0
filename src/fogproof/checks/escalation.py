"""One false-alarm probability for everything a call does: shared by its tests, and by its looks at a growing sample.

The sample grows in stages (Gandy & Scott 2020, "Unit testing for MCMC and other Monte Carlo methods"): gross errors stop at the
first look, and where the user says how small an error matters, a subject that is clearly right stops too; only the doubtful go
on. Each look spends a share of alpha of its own on all samples so far. Whatever made the sample stop growing, the false-alarm
probability is at most the sum of the shares (Boole's inequality): stopping early cannot inflate it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.kolmogorov import kolmogorov_critical
from fogproof.checks.verdict import Finding

WEIGHTS = {
    "distribution": 1.0,
    "smooth": 2.0,
    "chi-square": 1.0,
    "scan": 1.0,
    "ends": 0.5,
    "atom": 1.0,
    "event": 0.5,
    "lost samples": 0.25,
    "mean weight": 0.5,
    "joint": 1.0,
    "dependence": 0.5,
    "fine joint": 0.5,
    "patches": 0.5,
    "labels": 1.0,
    "label cells": 0.5,
    "label levels": 1.0,
    "label scores": 1.0,
    "label strips": 1.0,
    "largest cell": 0.5,
    "serial correlation": 0.25,
    "repeated points": 0.25,
    "few values": 0.25,
    "size of the call": 0.25,
    "evenness": 0.25,
}
"""Relative shares of alpha. Errors that some tests exist for have p-values far below any share: these tests get little."""

_GROWTH = 16  # of the sample from one look for gross errors to the next
_FIRST = 1 << 15  # samples of the first look for gross errors, at least
_DOUBT_GROWTH = 4  # of the sample when a first stage leaves doubt
DOUBT = 0.01
"""A smallest p-value (times its number of rivals) below this is doubtful."""

EARLY = 1e-50
"""Share of alpha for the looks for gross errors: whatever they stop is beyond doubt, and they cost no power."""

GROSS = {"distribution", "smooth", "atom", "lost samples", "labels"}
"""The quick tests that no gross error escapes: only these are run at an early look, unless one of them rejects."""


@dataclass(frozen=True)
class Test:
    """One statistical test of a kind that has a weight: `run` takes its share of alpha and returns what it found."""

    kind: str
    run: Callable[[float], Finding]


@dataclass(frozen=True)
class Stage:
    """One look: at `samples` samples in all, with a share of the call's alpha; `final` if a pass may end the check here."""

    samples: int
    share: float
    final: bool


def stages(samples: int, resolution: float | None, alpha: float, weights: float) -> tuple[Stage, ...]:
    """Return the looks at up to `samples` samples.

    resolution  Kolmogorov distance that the first look must reject but for a probability `MISS`, or None
    weights     sum of the weights of all tests
    """
    if resolution is None:
        sizes = [samples]
        while sizes[-1] // _GROWTH >= _FIRST:
            sizes.append(sizes[-1] // _GROWTH)
        early = len(sizes) - 1
        last = 1.0 - EARLY if early else 1.0
        return tuple(Stage(n, last if n == samples else EARLY / early, final=n == samples) for n in reversed(sizes))
    share = 0.5 / 8 * alpha * WEIGHTS["distribution"] / weights
    first = 1000
    while first < samples and _distance(first, share) > resolution:
        first = math.ceil(1.02 * first)
    if first >= samples:
        return (Stage(samples, 1.0, final=True),)
    sizes = [first]
    while sizes[-1] * _DOUBT_GROWTH < samples:
        sizes.append(sizes[-1] * _DOUBT_GROWTH)
    sizes.append(samples)
    early = len(sizes) - 1
    return tuple(Stage(n, 0.5 if n == samples else 0.5 / max(early, 8), final=True) for n in sizes)


def _distance(n: int, alpha: float) -> float:
    return kolmogorov_critical(n, alpha) + math.sqrt(math.log(2 / MISS) / (2 * n)) + 32 / n


def total_weight(tests: list[Test]) -> float:
    """Return the sum of the weights of all tests."""
    return sum(WEIGHTS[test.kind] for test in tests)


def judged(tests: list[Test], alpha: float, final: bool) -> list[Finding]:
    """Run the tests, each with its share of alpha; at an early look only the quick ones, as long as none of them rejects."""
    share = alpha / total_weight(tests)
    if not final:
        quick = [test.run(share * WEIGHTS[test.kind]) for test in tests if test.kind in GROSS]
        if all(finding.outcome != "rejected" for finding in quick):
            return quick
    return [test.run(share * WEIGHTS[test.kind]) for test in tests]


def doubtful(findings: list[Finding], alpha: float) -> bool:
    """Return whether a pass would be premature: some p-value is small, or some finding could not tell."""
    return any(
        f.outcome == "inconclusive" or (f.p_value is not None and f.alpha and f.p_value * alpha / f.alpha <= DOUBT)
        for f in findings
    )
