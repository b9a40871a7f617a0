"""What was observed of an estimator, judged inside one false-alarm probability."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.mean_claim import SECOND, Again, MeanClaim
from fogproof.checks.observed import Observed
from fogproof.checks.quantities import CheckedQuantity
from fogproof.checks.statistics.coverage import coverage_test
from fogproof.checks.statistics.dependence import (
    evenness_of_calls,
    repeated_stretches,
    repeats_within_calls,
    runs_test,
    spread_of_calls,
)
from fogproof.checks.statistics.means import DISTRIBUTION_FREE
from fogproof.checks.verdict import Finding

_DEPENDENCE = 0.05  # share of alpha for the dependence of realisations
_NOISE = 1e-13  # of the mean: a scatter that rounding alone makes


def share_of_a_claim(alpha: float, claims: int) -> float:
    """Return the part of alpha that each of so many claims has, beside the dependence of realisations."""
    return (1 - _DEPENDENCE) * alpha / claims


def share_of_means(alpha: float, claims: int, declared: bool) -> tuple[float, float, float]:
    """Return the parts of alpha that one mean has for the usual test, for declared facts, and for bets on them."""
    share = share_of_a_claim(alpha, claims)
    first = (1 - SECOND) * share
    return (1 - DISTRIBUTION_FREE * declared) * first, DISTRIBUTION_FREE * first, SECOND * share


@dataclass(frozen=True)
class Judgement:
    """Findings, and whether they are beyond doubt: no further realisation could change them."""

    findings: tuple[Finding, ...]
    final: bool


def judged(seen: Observed, again: Again, samples: int, alpha: float, complete: bool) -> Judgement:
    """Return all findings; the statistical ones share alpha.

    again     gives the batches so far once more, for means that the moments alone cannot decide
    samples   how many realisations there will be at most
    complete  whether there will be no more
    """
    if seen.bad:
        message = f"{seen.bad} of {seen.n} realisations are not finite, in value, cost or standard error"
        effect = seen.bad / seen.n
        return Judgement((Finding("finite values", "rejected", message, effect=effect, cause="not a number"),), True)
    findings = [Finding("finite values", "not rejected", f"all {seen.n} realisations are finite")]
    claims = [(q, c) for q in seen.quantities for c in range(len(q.value))]
    covered = seen.coverage.n > 0
    share = share_of_a_claim(alpha, len(claims) + covered)
    fixed = without_variance(seen.quantities)
    final = False
    for (quantity, channel), data in zip(claims, (m for row in seen.moments for m in row), strict=True):
        name = f"{quantity.name} of channel {channel}" if len(quantity.value) > 1 else quantity.name
        if quantity.name == "variance" and channel in fixed:
            continue
        values = seen.moments[0][channel]
        further = 0.0 if quantity.further is None else quantity.further(values.low, values.high, channel)
        claim = MeanClaim(quantity, channel, name, data, samples, share, further)
        finding = claim.exactly() if quantity.name == "mean" and channel in fixed else claim.judged(again, complete)
        final |= claim.beyond_doubt(finding)
        if quantity is seen.quantities[0]:
            finding = replace(finding, figure=seen.figure(channel))
        findings.append(finding)
        findings += claim.outside()
    if covered:
        (off,) = (
            row for q, row in zip(seen.quantities, seen.moments, strict=True) if q.cause == "wrong standard errors"
        )
        findings.append(coverage_test("coverage of standard errors", seen.coverage, seen.moments[0], off, share))
    findings += _orders(seen)
    if not fixed and seen.n > 1:
        findings += dependence(seen, _DEPENDENCE * alpha)
    final |= any(f.outcome == "rejected" and f.p_value is None for f in findings)
    return Judgement(tuple(findings), final)


def without_variance(quantities: list[CheckedQuantity]) -> set[int]:
    """Return the channels that declare no variance."""
    variance = next((q.value for q in quantities if q.name == "variance"), np.empty(0))
    return {channel for channel, v in enumerate(variance) if v == 0}


def dependence(seen: Observed, alpha: float) -> list[Finding]:
    """Return what is found of the independence of realisations."""
    if all(data.deviation <= _NOISE * abs(data.mean) for data in seen.moments[0]):
        return []  # what varies is rounding
    share = alpha / 4
    found = [
        runs_test("correlation of realisations", seen.succession, share),
        repeated_stretches("repeated realisations", seen.succession),
        repeats_within_calls("realisations that occur twice", seen.succession, share),
        spread_of_calls("scatter of calls", seen.succession, seen.moments[0], share) if seen.labels is None else None,
        evenness_of_calls("evenness of calls", seen.succession, share) if seen.labels is None else None,
    ]
    return [finding for finding in found if finding is not None]


def _orders(seen: Observed) -> list[Finding]:
    """Report the orders that no reference was given for."""
    if not seen.unlisted:
        return []
    count = sum(n for n, _ in seen.unlisted.values())
    size = sum(total for _, total in seen.unlisted.values())
    names = ", ".join(f"{label:g}" for label in sorted(seen.unlisted)[:8]) + (", ..." if len(seen.unlisted) > 8 else "")
    message = (
        f"{count} of {seen.n} realisations have an order without a reference ({names}): {size / seen.n:.3g} of the mean"
    )
    message += " is not tested"
    return [Finding("other orders", "not rejected", message, effect=count / seen.n)]
