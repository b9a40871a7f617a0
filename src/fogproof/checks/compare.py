"""`compare_estimators`: do two estimators have the same expectation, where nobody knows it?

Realisations are drawn in pairs, one of each, and the differences are held to zero by everything that `check_estimator` has, also
where both share random numbers: pairs are independent all the same. Two estimators that hit or miss the same values are compared by
the sign test on the pairs in which they differ, which is exact. Each by itself must be finite, and its realisations independent.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import islice
from typing import Any, Literal

import numpy as np

from fogproof.checks.arguments import alpha_of, bounds_of, samples_of, seed_of
from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.draws import Source, count_of
from fogproof.checks.escalation import stages
from fogproof.checks.judgement import Judgement
from fogproof.checks.pairs import NAMES, Pairs, neighbours
from fogproof.checks.quantities import Declared
from fogproof.checks.streams import batch_sizes
from fogproof.checks.subject import UNIT_ROUNDOFF, Precision
from fogproof.checks.verdict import Verdict
from fogproof.contracts import Draws, Reference
from fogproof.errors import InvalidValueError, SubjectError
from fogproof.validate import number

Drawing = Callable[[np.random.Generator, int], Any] | Any


def compare_estimators(
    first: Drawing,
    second: Drawing,
    *,
    variance: tuple[Reference | float, Reference | float] | None = None,
    bounds: tuple[float, float] | None = None,
    nonnegative: bool = False,
    tails: Literal["unknown", "light"] = "unknown",
    tolerance: float = 0.0,
    precision: Precision = "float64",
    samples: int = 1_000_000,
    alpha: float = 1e-6,
    seed: int | None = None,
) -> Verdict:
    """Test that two estimators have the same expectation, channel by channel, inside one false-alarm probability `alpha`.

    first, second  `draw(rng, n)` -> (n,) or (n, channels) independent realisations, or `Draws`; or as many realisations of both
                   that are already there, such as the pixels of two images. Standard errors that `Draws` hold are tested too
    variance       the exact variances of one realisation of each
    bounds         (low, high): no realisation of either lies outside; `nonnegative` is the same as (0, inf)
    tails          "light": no heavier than those of the exponential law
    tolerance      largest difference that is still none, in the unit of the values
    precision      "float32": values are computed in single precision
    samples        most realisations of each
    alpha          false-alarm probability of this call with everything in it
    seed           any whole number; None draws a fresh one, which the verdict states

    >>> compare_estimators(lambda rng, n: rng.random(n), lambda rng, n: 2 * rng.random(n), samples=10_000).outcome
    'rejected'
    """
    started = time.perf_counter()
    alpha, samples, seed = alpha_of(alpha), _count(first, second, samples), seed_of(seed)
    number("tolerance", tolerance, "must be >= 0", 0)
    low, high = bounds_of(bounds, nonnegative)
    roundoff = UNIT_ROUNDOFF[precision]
    total = None if variance is None else _sum(variance)
    declared = Declared(total, None, (low - high, high - low), tails == "light", (0.0, tolerance), roundoff)
    sources = [
        Source(draw, seed, tuple(batch_sizes(samples)), 0, f"compare {name}", precision)
        for name, draw in zip(NAMES, (first, second), strict=True)
    ]
    looks = [look.samples for look in stages(samples, None, alpha, 1.0)]
    pairs: Pairs | None = None
    judgement = Judgement((), False)
    for index, (both, calls) in enumerate(_drawn_together(sources)):
        difference = _difference(*both)
        if pairs is None:
            pairs = Pairs.of(both, difference, declared)
        before, pairs = pairs.seen.n, pairs.after(both, difference, calls)
        complete = pairs.seen.n == samples
        if pairs.bad or complete or any(before < size <= pairs.seen.n for size in looks):
            alone = [_again_neighbours(source, index + 1) for source in sources]
            judgement = pairs.judged(_again(sources, index + 1), alone, samples, alpha, complete)
            if complete or judgement.final:
                break
    assert pairs is not None
    names = ", ".join(getattr(draw, "__qualname__", type(draw).__name__) for draw in (first, second))
    reproduce = f"compare_estimators({names}, samples={samples}, alpha={alpha:g}, seed={seed})"
    settings = {"channels": len(pairs.signs[0]), "looks": looks}
    seconds = time.perf_counter() - started
    findings = judgement.findings
    return Verdict(findings, alpha, pairs.seen.n, seed, seconds, settings, likely_cause(findings), reproduce)


def _count(first: Drawing, second: Drawing, samples: int) -> int:
    """Return how many pairs there are at most; two sets of realisations that are there already must be equally large."""
    for draw in (first, second):
        if isinstance(draw, Reference) or (
            not callable(draw) and np.ndim(draw.value if isinstance(draw, Draws) else draw) == 0
        ):
            raise InvalidValueError(
                "first, second",
                "must be estimators or their realisations",
                draw,
                "check_estimator(draw, reference) knows numbers",
            )
    there = sorted({count for count in map(count_of, (first, second)) if count is not None})
    if len(there) > 1:
        raise InvalidValueError("first, second", "must hold as many realisations, which are compared in pairs", there)
    return there[0] if there else samples_of(samples)


def _sum(variance: Any) -> Reference:
    """Return the variance of a difference."""
    if not isinstance(variance, tuple | list) or len(variance) != 2:
        raise InvalidValueError("variance", "must be a pair, the exact variance of each estimator", variance)
    a, b = (Reference.of("variance", one) for one in variance)
    return Reference(a.value + b.value, a.error + b.error)


def _drawn_together(sources: list[Source]) -> Iterator[tuple[tuple[Draws, Draws], list[int]]]:
    for (a, calls), (b, _) in zip(*(source.batches() for source in sources), strict=True):
        if a.value.shape != b.value.shape:
            message = "both estimators must have as many channels, got"
            raise SubjectError(f"{message} {a.value.shape[1]} and {b.value.shape[1]}", "draw: value")
        yield (a, b), calls


def _again(sources: list[Source], upto: int) -> Callable[[], Iterator[tuple[Draws, list[int]]]]:
    return lambda: ((_difference(*both), calls) for both, calls in islice(_drawn_together(sources), upto))


def _again_neighbours(source: Source, upto: int) -> Callable[[], Iterator[tuple[Draws, list[int]]]]:
    return lambda: (
        (one, [len(one.value)]) for one in (neighbours(draws) for draws, _ in islice(source.batches(), upto))
    )


def _difference(a: Draws, b: Draws) -> Draws:
    with np.errstate(invalid="ignore"):
        return Draws(a.value - b.value)
