"""The exact binomial test of a mean whose realisations have shown two values, each of which came back.

Two values that were seen make no law: others, together so rare that all n realisations missed them, may hold what the mean lacks.
Declared bounds say how far these lie at most. A declared variance V bounds them too: values of probability q in all, left out of a
law of two values a distance s apart, r of which is the upper one, move its mean m from the expectation mu by no more than
(m - mu)^2 <= q (V / (1 - q) - r (1 - r) s^2), by Schwarz's inequality. Where nothing is declared, values as far off as the two are
from each other are allowed for: what these could explain is no rejection yet. Values further out are taken not to be there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fogproof.checks.statistics.binomial import binomial_p
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.power import binomial_reach
from fogproof.checks.statistics.unseen import SHARE, allowances, rarest
from fogproof.checks.verdict import Finding, Outcome, Resolution

_LEAST = 2  # times that each value must have come


def two_valued(data: Moments) -> bool:
    """Return whether there are two values, each of which came back: one that came once may be any of many."""
    return data.values is not None and len(data.values) == 2 and min(data.values.values()) >= _LEAST


def two_values_test(
    name: str,
    what: str,
    data: Moments,
    reference: float,
    error: float,
    alpha: float,
    known: Known,
    further: float = 0.0,
) -> Finding:
    """Test that the expectation lies within `error` of the reference.

    further  how far off an undeclared value that was not met must be allowed to lie, if that is more than the two are apart
    """
    claim = _Claim.of(data, reference, error, alpha, known, further)
    count = claim.count
    effect = data.mean - reference
    p = binomial_p(count, data.n, claim.low, claim.high) if claim.possible else 0.0
    p = min(1.0, p / (1 - SHARE)) if claim.allowed else p
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"{what} {data.mean:.7g}, reference {reference:.7g} (exact binomial test of its two values)"
    gap = max(claim.low * data.n - count, count - claim.high * data.n)
    if outcome == "rejected" and gap <= (claim.above if effect < 0 else claim.below):
        message += "; a third value, no further off, that was not met may hold the rest"
        return Finding(name, "inconclusive", message, None, alpha, False, effect, effect)
    resolution = None
    if claim.possible:  # no law of these two values has another mean: nothing is planned for it
        resolution = Resolution(f"bias of {what}", claim.reach(data.n, alpha, known), MISS, reference)
    return Finding(name, outcome, message, p, alpha, False, effect, effect, resolution)


@dataclass(frozen=True)
class _Claim:
    """What the claimed mean says of the share of the upper value.

    count         realisations of the upper value
    step          how far the two are apart
    low, high     the shares that are right
    widened       by how much of a step the farther of them lies beyond the share that the reference itself asks for
    allowed       whether values that were not met are allowed for in that
    above, below  realisations that undeclared values which were not met may be worth, where the mean is too small, or too large
    """

    count: int
    step: float
    low: float
    high: float
    widened: float
    allowed: bool
    above: float
    below: float

    @staticmethod
    def of(data: Moments, reference: float, error: float, alpha: float, known: Known, further: float) -> _Claim:
        assert data.values is not None
        (bottom, _), (top, count) = sorted(data.values.items())
        step = top - bottom
        exact = (reference - bottom) / step
        slack = error / step
        down, up = (room / step for room in allowances(data, replace(known, variance=None), alpha))
        low, high = exact - slack - up, exact + slack + down
        rare = rarest(data.n, SHARE * alpha)
        declared = known.variance is not None and not known.assumed
        if declared:
            ends = _shares_of(exact - slack, rare, known, step)[0], _shares_of(exact + slack, rare, known, step)[1]
            bounded = math.isfinite(known.low), math.isfinite(known.high)
            low = min(exact - slack, max(low, ends[0]) if bounded[1] else ends[0])
            high = max(exact + slack, min(high, ends[1]) if bounded[0] else ends[1])
        room = max(1.0, further / step)
        # A value of a sign that none so far had is allowed for only where the claim itself needs one, or signs mean nothing.
        signed = further > 0 or reference - error <= bottom or reference + error >= top
        below = room if signed or bottom < 0 else min(room, bottom / step)
        above = room if signed or top > 0 else min(room, -top / step)
        return _Claim(
            count,
            step,
            low,
            high,
            max(exact - low, high - exact),
            max(exact - slack - low, high - exact - slack) > 0,
            0.0 if declared or math.isfinite(known.high) else rare * data.n * above,
            0.0 if declared or math.isfinite(known.low) else rare * data.n * below,
        )

    @property
    def possible(self) -> bool:
        """Whether a law of the two values has such a mean."""
        return self.low <= 1 and self.high >= 0

    def reach(self, n: int, alpha: float, known: Known) -> float:
        """Return the bias that is found but for the probability `MISS`."""
        inside = max(self.low, 0.0), min(self.high, 1.0)
        least = 0 if known.bounded else _LEAST  # bounds decide about a value that came once, or not at all
        return (
            binomial_reach(n, *inside, alpha, least=least, margins=(self.above, self.below)) + self.widened
        ) * self.step


def _shares_of(share: float, rare: float, known: Known, step: float) -> tuple[float, float]:
    """Return the least and the greatest share of the upper value in laws of this variance; `share` has the claimed mean alone."""
    assert known.deviation is not None
    if rare >= 1:
        return 0.0, 1.0
    varies = (known.deviation / step) ** 2
    half = share - 0.5 * rare
    root = half * half - (1 - rare) * share * share + rare * varies
    if root < 0:  # two values alone vary more than declared: nothing is left for others
        return share, share
    return (half - math.sqrt(root)) / (1 - rare), (half + math.sqrt(root)) / (1 - rare)
