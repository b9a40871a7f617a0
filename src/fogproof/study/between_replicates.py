"""Do realisations of one call depend on each other? Means of replicates against the spread within them, whatever the law.

Given the values, independent realisations may be split into calls in any way. Then the share of the squares that lies between calls
has a Beta law, as in Fisher's analysis of variance, as far as means of calls are about normal. Beside it the mean of each single
call keeps to Bennett's inequality (1962), which holds of draws without replacement from any values (Hoeffding 1963).

Means that scatter more come of realisations that share something. Less comes of strata or antithetic pairs: such an estimate is
right, and more exact than the variance of one realisation says; what is said of it must come from the means alone. What is too weak
to be told either way makes intervals and resolutions as much wider as means scatter, never narrower.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fogproof.checks.statistics.means import DOUBT, LARGEST_CORRECTION
from fogproof.checks.verdict import Finding, Outcome
from fogproof.study.aggregate import Level, pooled

Calls = Literal["independent", "doubtful", "dependent", "stratified"]
_LEAST = 8
"""Realisations of a call whose mean may be about normal."""
_ROUNDING = 1e-12
"""Relative deviations that rounding may make."""


@dataclass(frozen=True)
class BetweenReplicates:
    """How the realisations of a call go together.

    calls    "independent" as far as was seen; "doubtful": means scatter more than by chance in one cell of a hundred, if not
             beyond doubt; "dependent": more than chance explains; "stratified": less
    finding  says so; None where there is nothing to see
    design_effect  how many times as much as independent realisations the mean varies, over all counts; 1 at least (Kish 1965)
    """

    calls: Calls
    finding: Finding | None = None
    design_effect: float = 1.0

    @property
    def by_replicates(self) -> bool:
        """Whether only whole replicates are independent of each other."""
        return self.calls in ("dependent", "stratified")


@dataclass(frozen=True)
class _Squares:
    """Squared deviations between and within the calls of some levels, in units of each level's variance.

    freedom   degrees of freedom of both
    rounded   the squares between, were each mean further off by half of what one realisation can make of it
    count     realisations of the smallest call
    skewness, excess  the largest of a realisation, in size
    """

    between: float
    within: float
    freedom: tuple[int, int]
    rounded: float
    count: int
    skewness: float
    excess: float

    @staticmethod
    def of(level: Level) -> _Squares:
        rows, n = level.rows, level.count
        data = pooled(rows)
        off, step = np.abs(rows[:, 1] - data.mean), (data.high - data.low) / (2 * n)
        between, within, rounded = (
            n * float(np.sum(off**2)),
            float(rows[:, 2].sum()),
            n * float(np.sum((off + step) ** 2)),
        )
        unit = data.variance
        excess = abs(data.n * (data.m4 / data.m2) / data.m2 - 3)
        freedom = len(rows) - 1, len(rows) * (n - 1)
        return _Squares(between / unit, within / unit, freedom, rounded / unit, n, abs(data.skewness), excess)

    @property
    def ratio(self) -> float:
        """How many times as much means vary as those of independent realisations (the design effect, Kish 1965)."""
        return self.between / self.freedom[0] * sum(self.freedom) / (self.between + self.within)

    def more(self) -> float:
        """Return the probability of so much between the calls, were their means normal."""
        from scipy.special import betaincc

        return float(betaincc(self.freedom[0] / 2, self.freedom[1] / 2, self.between / (self.between + self.within)))

    def less(self) -> float:
        """Return the probability of so little between them, give or take one realisation each."""
        from scipy.special import betainc

        return float(betainc(self.freedom[0] / 2, self.freedom[1] / 2, self.rounded / (self.rounded + self.within)))

    def growth_above(self, alpha: float) -> float:
        """Return how much, as a logarithm, skewness and kurtosis may add to a tail of probability alpha.

        Edgeworth's expansion of a mean z standard errors off, |skewness| z^3 / (6 sqrt n) + excess z^4 / (24 n), adds most where
        one call holds it all.
        """
        from scipy.special import chdtri

        z = math.sqrt(float(chdtri(self.freedom[0], alpha)))
        return self.skewness * z**3 / (6 * math.sqrt(self.count)) + self.excess * z**4 / (24 * self.count)

    def growth_below(self) -> float:
        """Return how much they may add to the lower tail, where every mean is near its expectation."""
        return self.freedom[0] * (self.excess / 8 + 5 * self.skewness**2 / 24) / self.count

    def trusted(self, growth: float) -> bool:
        """Return whether means are near enough to normal for what is added."""
        return self.count >= _LEAST and growth <= LARGEST_CORRECTION


def between_replicates(levels: Sequence[Level], alpha: float) -> BetweenReplicates:
    """Return how the realisations of a call go together, with the false-alarm probability alpha, half of it on either side."""
    levels = [level for level in levels if level.count > 1 and len(level.rows) > 1 and _varies(level)]
    alone = [_Squares.of(level) for level in levels]
    if not alone:
        return BetweenReplicates("independent")
    looks, each = len(alone) + 1, alpha / (4 * (len(alone) + 1))
    above = _with_their_sum([s for s in alone if s.trusted(s.growth_above(each))])
    below = _with_their_sum([s for s in alone if s.trusted(s.growth_below())])
    normal = min(
        (s.more() * math.exp(s.growth_above(each)) for s in above if s.trusted(s.growth_above(each))), default=1.0
    )
    more = 2 * min(looks * normal, sum(len(level.rows) for level in levels) * min(map(_furthest, levels)))
    less = looks * min(
        (s.less() * math.exp(s.growth_below()) for s in below if s.trusted(s.growth_below())), default=1.0
    )
    p = min(1.0, 2 * min(more, less))
    whole = _with_their_sum(alone)
    nominal = looks * min(s.more() for s in whole)
    calls: Calls = "independent"
    if p <= alpha:
        calls = "dependent" if more < less else "stratified"
    elif nominal <= DOUBT:
        calls = "doubtful"
    even = calls == "independent" and looks * min(s.less() for s in whole) <= DOUBT
    shown = (min if even or calls == "stratified" else max)(whole, key=lambda s: s.ratio)
    finding = _finding(calls, shown.ratio, p, alpha, 2 * nominal <= alpha, even)
    return BetweenReplicates(calls, finding, max(1.0, whole[-1].ratio))


def _with_their_sum(some: list[_Squares]) -> list[_Squares]:
    """Return the levels, and behind them all as one."""
    if len(some) < 2:
        return some
    between, within, rounded = (sum(getattr(s, name) for s in some) for name in ("between", "within", "rounded"))
    freedom = sum(s.freedom[0] for s in some), sum(s.freedom[1] for s in some)
    skewness, excess = max(s.skewness for s in some), max(s.excess for s in some)
    return [*some, _Squares(between, within, freedom, rounded, min(s.count for s in some), skewness, excess)]


def _finding(calls: Calls, ratio: float, p: float, alpha: float, sure: bool, even: bool) -> Finding:
    told = {
        "dependent": "; realisations of one call depend on each other",
        "doubtful": "; whether realisations of one call depend on each other their law does not tell" if sure else "",
        "stratified": "; a call is stratified, and judged by its mean alone",
        "independent": "; a call may be stratified, and its mean nearer than is stated" if even else "",
    }
    message = (
        f"means of replicates vary {ratio:.3g} times as much as those of independent realisations{told.get(calls, '')}"
    )
    outcome: Outcome = (
        "rejected" if calls == "dependent" else "inconclusive" if calls == "doubtful" and sure else "not rejected"
    )
    cause = "correlation" if outcome == "rejected" else ""
    return Finding("scatter of replicates", outcome, message, p, alpha, False, ratio, ratio - 1, cause=cause)


def _varies(level: Level) -> bool:
    data = pooled(level.rows)
    return data.m2 > data.n * (_ROUNDING * data.mean) ** 2


def _furthest(level: Level) -> float:
    """Return the probability, at most, that the mean of one call is as far off as the furthest (Bennett 1962)."""
    data = pooled(level.rows)
    p, variance = 1.0, data.m2 / data.n
    for sign, most in ((1, data.high - data.mean), (-1, data.mean - data.low)):
        off = float((sign * (level.rows[:, 1] - data.mean)).max())
        u = most * max(off, 0.0) / variance
        p = min(p, math.exp(-level.count * variance / most**2 * ((1 + u) * math.log1p(u) - u)))
    return 2 * p
