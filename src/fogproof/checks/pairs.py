"""What was seen of two estimators drawn in pairs: their differences, each by itself, and which was the larger how often."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fogproof.checks.judgement import Judgement, dependence, judged, share_of_a_claim
from fogproof.checks.observed import Observed
from fogproof.checks.quantities import OF_A_DIFFERENCE, Declared, column, quantities_of
from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.means import short_of_variance
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.power import sign_reach
from fogproof.checks.statistics.unseen import unseen
from fogproof.checks.verdict import Finding, Outcome, Resolution
from fogproof.contracts import Draws, Reference

NAMES = ("first", "second")
_DIFFERENCE = 0.9  # share of alpha for the differences; the rest is for each estimator by itself
_EQUAL = 1e-12  # relative: rounding in double precision
_ERRORS = 0.2  # of it for the standard errors of each, if any are reported


def neighbours(draws: Draws) -> Draws:
    """Return the differences of two realisations of one estimator after the other, and the standard errors of these.

    Their expectation is zero whatever the mean is, so that reported standard errors can be held to them.
    """
    n = len(draws.value) // 2 * 2
    stderr = column(draws.stderr)[:n]
    with np.errstate(invalid="ignore", over="ignore"):
        return Draws(draws.value[:n:2] - draws.value[1:n:2], stderr=np.hypot(stderr[::2], stderr[1::2]))


@dataclass(frozen=True)
class Pairs:
    """What was seen of the differences, of each estimator by itself, and how often each was the larger.

    errors  of the estimators that report standard errors: differences of realisations that follow each other
    """

    seen: Observed
    sides: tuple[Observed, Observed]
    errors: tuple[Observed | None, Observed | None]
    signs: np.ndarray
    declared: Declared

    @staticmethod
    def of(both: tuple[Draws, Draws], difference: Draws, declared: Declared) -> Pairs:
        """Return the empty record for two estimators whose first batches are `both`."""
        zero = Reference(np.zeros(both[0].value.shape[1]))
        mean, *more = quantities_of(zero, declared, None)
        quantities = [replace(mean, signed=True, ways=OF_A_DIFFERENCE), *more]
        alone = [Observed.of(quantities_of(zero, Declared(), None), draws) for draws in both]
        signs = np.zeros((2, both[0].value.shape[1]), dtype=np.int64)
        plain = Declared(light=declared.light, roundoff=declared.roundoff)
        errors = [
            None if one.stderr is None else Observed.of(quantities_of(zero, plain, column(one.stderr)), neighbours(one))
            for one in both
        ]
        return Pairs(Observed.of(quantities, difference), (alone[0], alone[1]), (errors[0], errors[1]), signs, declared)

    def after(self, both: tuple[Draws, Draws], difference: Draws, calls: list[int]) -> Pairs:
        """Return the record after one more batch of each, drawn in calls of these sizes."""
        sides = [side.after(draws, calls) for side, draws in zip(self.sides, both, strict=True)]
        errors = [
            None if seen is None else seen.after(neighbours(draws), [len(draws.value) // 2])
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
                tuple(_not_finite(*one) for one in zip(NAMES, self.sides, strict=True) if one[1].bad), True
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
        for name, side, seen, more in zip(NAMES, self.sides, self.errors, alone, strict=True):
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
        if self.declared.tolerance == (0.0, 0.0) and _hits_of_the_same(a, b) and self._nothing_else(a, b, channel):
            more, fewer = map(int, self.signs[:, channel])
            p = binomial_p(more, more + fewer, 0.5, 0.5) if more + fewer else 1.0
            outcome: Outcome = "rejected" if p <= alpha else "not rejected"
            message = f"{start} (sign test of the {more + fewer} pairs in which they differ)"
            known = self.declared.known(self._variance)
            if outcome == "rejected" and not known.two_sided:
                message += unseen(self.seen.moments[0][channel], effect, 0.0, alpha, known)
            reach = sign_reach(self.seen.n, more + fewer, alpha) * (max(a.high, b.high) - min(a.low, b.low))
            finding = replace(
                finding,
                outcome=outcome,
                message=message,
                p_value=p,
                alpha=alpha,
                exact=False,
                resolution=Resolution("bias of difference", reach),
            )
        elif a.low == a.high and b.low == b.high and abs(effect) <= self._rounding * max(abs(a.mean), abs(b.mean)):
            message = f"all {self.seen.n} realisations of both are {a.mean:.7g}"
            finding = replace(finding, outcome="not rejected", message=message, p_value=None, resolution=None)
        elif (a.low == a.high) != (b.low == b.high) and not self.declared.known(self._variance).two_sided:
            message = f"{start}; one of them never varies, and a value too rare to be seen may hold the difference"
            message += ": ask for more samples, or declare bounds=(low, high) or the exact variance=(first, second)"
            finding = replace(finding, outcome="inconclusive", message=message, p_value=None, resolution=None)
        if finding.resolution is not None:
            kind = name.replace("difference", "difference of means", 1)
            finding = replace(finding, resolution=replace(finding.resolution, kind=kind))
        rejected = finding.outcome == "rejected"
        larger = ("the first is the larger",) if effect > 0 else ("the second is the larger",)
        return replace(finding, effect=effect, region=larger if rejected else (), cause="bias" if rejected else "")

    def _nothing_else(self, a: Moments, b: Moments, channel: int) -> bool:
        """Return whether nothing that is declared asks for values beside the two that were seen, or leaves room for them."""
        room = self.declared.bounds[1]  # of a difference: as far as values lie apart
        within = math.isinf(room) or room <= (max(a.high, b.high) - min(a.low, b.low)) * (1 + _EQUAL)
        return within and not short_of_variance(self.seen.moments[0][channel], self.declared.known(self._variance))

    @property
    def _rounding(self) -> float:
        """By how much two equal constants may differ, relative to them, that were computed in two ways."""
        return max(_EQUAL, 4 * self.declared.roundoff)

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
    cause = "not a number"
    return Finding(f"finite values of the {name}", "rejected", message, effect=side.bad / side.n, cause=cause)
