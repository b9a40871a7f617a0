"""`compare_estimators`: do two estimators have the same expectation, where nobody knows it?

Realisations are drawn in pairs, one of each, and the differences are held to zero by everything that `check_estimator` has, also
where both share random numbers: pairs are independent all the same. Two estimators that hit or miss the same values are compared by
the sign test on the pairs in which they differ, which is exact. Each by itself must be finite, and its realisations independent.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, Literal

import numpy as np

from fogproof.checks.arguments import alpha_of, bounds_of, samples_of, seed_of
from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.draws import Source, count_of
from fogproof.checks.escalation import stages
from fogproof.checks.judgement import Judgement, dependence, judged, share_of_a_claim
from fogproof.checks.observed import Observed
from fogproof.checks.quantities import Declared, column, quantities_of
from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.streams import batch_sizes
from fogproof.checks.subject import UNIT_ROUNDOFF, Precision
from fogproof.checks.verdict import Finding, Outcome, Verdict
from fogproof.contracts import Draws, Reference
from fogproof.errors import InvalidValueError, SubjectError
from fogproof.validate import number

Draw = Callable[[np.random.Generator, int], Any] | Any
_NAMES = ("first", "second")
_DIFFERENCE = 0.9  # share of alpha for the differences; the rest is for each estimator by itself
_ERRORS = 0.2  # of it for the standard errors of each, if any are reported


def compare_estimators(
    first: Draw,
    second: Draw,
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
        for name, draw in zip(_NAMES, (first, second), strict=True)
    ]
    looks = [look.samples for look in stages(samples, None, alpha, 1.0)]
    pairs: _Pairs | None = None
    judgement = Judgement((), False)
    for index, (both, calls) in enumerate(_drawn_together(sources)):
        difference = _difference(*both)
        if pairs is None:
            pairs = _Pairs.of(both, difference, declared)
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


def _count(first: Draw, second: Draw, samples: int) -> int:
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
        (one, [len(one.value)]) for one in (_neighbours(draws) for draws, _ in islice(source.batches(), upto))
    )


def _difference(a: Draws, b: Draws) -> Draws:
    with np.errstate(invalid="ignore"):
        return Draws(a.value - b.value)


def _neighbours(draws: Draws) -> Draws:
    """Return the differences of two realisations of one estimator after the other, and the standard errors of these.

    Their expectation is zero whatever the mean is, so that reported standard errors can be held to them.
    """
    n = len(draws.value) // 2 * 2
    stderr = column(draws.stderr)[:n]
    with np.errstate(invalid="ignore", over="ignore"):
        return Draws(draws.value[:n:2] - draws.value[1:n:2], stderr=np.hypot(stderr[::2], stderr[1::2]))


@dataclass(frozen=True)
class _Pairs:
    """What was seen of the differences, of each estimator by itself, and how often each was the larger.

    errors  of the estimators that report standard errors: differences of realisations that follow each other
    """

    seen: Observed
    sides: tuple[Observed, Observed]
    errors: tuple[Observed | None, Observed | None]
    signs: np.ndarray
    declared: Declared

    @staticmethod
    def of(both: tuple[Draws, Draws], difference: Draws, declared: Declared) -> _Pairs:
        zero = Reference(np.zeros(both[0].value.shape[1]))
        mean, *more = quantities_of(zero, declared, None)
        quantities = [replace(mean, signed=True), *more]
        alone = [Observed.of(quantities_of(zero, Declared(), None), draws) for draws in both]
        signs = np.zeros((2, both[0].value.shape[1]), dtype=np.int64)
        plain = Declared(light=declared.light, roundoff=declared.roundoff)
        errors = [
            None
            if one.stderr is None
            else Observed.of(quantities_of(zero, plain, column(one.stderr)), _neighbours(one))
            for one in both
        ]
        return _Pairs(
            Observed.of(quantities, difference), (alone[0], alone[1]), (errors[0], errors[1]), signs, declared
        )

    def after(self, both: tuple[Draws, Draws], difference: Draws, calls: list[int]) -> _Pairs:
        sides = [side.after(draws, calls) for side, draws in zip(self.sides, both, strict=True)]
        errors = [
            None if seen is None else seen.after(_neighbours(draws), [len(draws.value) // 2])
            for seen, draws in zip(self.errors, both, strict=True)
        ]
        signs = [np.count_nonzero(difference.value > 0, axis=0), np.count_nonzero(difference.value < 0, axis=0)]
        return replace(
            self,
            seen=self.seen.after(difference, calls),
            sides=(sides[0], sides[1]),
            errors=(errors[0], errors[1]),
            signs=self.signs + signs,
        )

    @property
    def bad(self) -> bool:
        """Whether either returned something that is not finite."""
        return any(side.bad for side in self.sides)

    def judged(self, again: Any, alone: list[Any], samples: int, alpha: float, complete: bool) -> Judgement:
        """Return the findings about the differences, and about each estimator by itself."""
        if self.bad:
            return Judgement(
                tuple(_not_finite(*one) for one in zip(_NAMES, self.sides, strict=True) if one[1].bad), True
            )
        reported = any(one is not None for one in self.errors)
        part = (_DIFFERENCE - 2 * _ERRORS if reported else _DIFFERENCE) * alpha
        whole = judged(self.seen, again, samples, part, complete)
        channels = len(self.seen.moments[0])
        share = share_of_a_claim(part, sum(len(quantity.value) for quantity in self.seen.quantities))
        findings = []
        for finding in whole.findings:
            if finding.check.startswith("mean"):
                channel = int(finding.check.rpartition(" ")[2]) if channels > 1 else 0
                findings.append(self._compared(finding, channel, share))
            elif finding.check == "finite values":
                findings.append(replace(finding, message=f"all realisations are finite, {self.seen.n} of each"))
            else:
                findings.append(finding)
        for name, side, seen, more in zip(_NAMES, self.sides, self.errors, alone, strict=True):
            found = dependence(side, 0.5 * (1 - _DIFFERENCE) * alpha)
            if seen is not None and seen.n > 1:
                kinds = ("square of the error", "coverage")
                found += [
                    f
                    for f in judged(seen, more, samples // 2, _ERRORS * alpha, complete).findings
                    if f.check.startswith(kinds)
                ]
            findings += [replace(finding, check=f"{finding.check} of the {name}") for finding in found]
        return Judgement(tuple(findings), whole.final and any(f.outcome == "rejected" for f in findings))

    def _compared(self, finding: Finding, channel: int, alpha: float) -> Finding:
        """Return the finding about a mean difference in words of two means, and by the sign test for hits and misses."""
        a, b = (side.moments[0][channel] for side in self.sides)
        name = "difference" if len(self.signs[0]) == 1 else f"difference in channel {channel}"
        effect = a.mean - b.mean
        spread = 0.0 if self.seen.n < 2 else self.seen.moments[0][channel].stderr
        start = f"means {a.mean:.7g} and {b.mean:.7g} differ by {effect:+.3g} +- {spread:.2g}"
        rest = finding.message.partition(";")[2]
        finding = replace(finding, check=name, message=start + (f";{rest}" if rest else ""))
        if self.declared.tolerance == (0.0, 0.0) and _hits_of_the_same(a, b):
            more, fewer = map(int, self.signs[:, channel])
            p = binomial_p(more, more + fewer, 0.5, 0.5) if more + fewer else 1.0
            outcome: Outcome = "rejected" if p <= alpha else "not rejected"
            message = f"{start} (sign test of the {more + fewer} pairs in which they differ)"
            finding = replace(finding, outcome=outcome, message=message, p_value=p, alpha=alpha, exact=False)
        elif (a.low == a.high) != (b.low == b.high) and not self.declared.known(self._variance).two_sided:
            message = f"{start}; one of them never varies, and a value too rare to be seen may hold the difference"
            message += ": ask for more samples, or declare bounds=(low, high) or the exact variances"
            finding = replace(finding, outcome="inconclusive", message=message, p_value=None, resolution=None)
        rejected = finding.outcome == "rejected"
        larger = ("the first is the larger",) if effect > 0 else ("the second is the larger",)
        return replace(finding, effect=effect, region=larger if rejected else (), cause="bias" if rejected else "")

    @property
    def _variance(self) -> float | None:
        return (
            None
            if self.declared.variance is None
            else float(Reference.of("variance", self.declared.variance).value.max())
        )


def _hits_of_the_same(a: Moments, b: Moments) -> bool:
    """Return whether both have shown the same two values: a law of hits and misses."""
    if a.values is None or b.values is None:
        return False
    if a.low == a.high and b.low == b.high:
        return False  # nothing was seen to vary: what was not seen may decide
    counts = {value: a.values.get(value, 0) + b.values.get(value, 0) for value in {**a.values, **b.values}}
    return len(counts) == 2 and min(counts.values()) > 1


def _not_finite(name: str, side: Observed) -> Finding:
    message = f"{side.bad} of {side.n} realisations of the {name} are not finite"
    return Finding(f"finite values of the {name}", "rejected", message, effect=side.bad / side.n, cause="bias")
