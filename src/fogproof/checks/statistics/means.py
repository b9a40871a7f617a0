"""Does a mean equal its reference? Moments merged batch by batch, and a test that knows where it does not hold.

Data of two values (hit or miss) get the exact binomial test. Anything else gets Student's t, whose far tail is wrong by the factor
exp(|skewness| z^3 / (3 sqrt n)) to leading order (Edgeworth's expansion of the studentised mean, Hall 1987): the p-value is
multiplied by that factor, and where it is large, or one sample dominates the variance, the verdict is inconclusive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fogproof.checks.statistics.goodness import MISS, binomial_p
from fogproof.checks.statistics.tails import normal_quantile, student_two_sided
from fogproof.checks.verdict import Finding, Interval, Outcome, Resolution

LARGEST_CORRECTION = 1.0  # of the exponent |skewness| z^3 / (3 sqrt n); beyond it the expansion is not trusted
LARGEST_SHARE = 0.05  # of one sample in the sum of squares; beyond it the variance itself may be infinite


@dataclass
class Moments:
    """Count, mean and central moments of a stream of numbers; merging in a fixed order gives the same bits every time."""

    n: int = 0
    mean: float = 0.0
    m2: float = 0.0
    m3: float = 0.0
    m4: float = 0.0
    low: float = math.inf
    high: float = -math.inf
    values: dict[float, int] | None = field(default_factory=dict)  # counts while at most two values have been seen

    @staticmethod
    def of(x: np.ndarray) -> Moments:
        """Return the moments of one batch (n,)."""
        mean = float(np.mean(x))
        d = x - mean
        d2 = d * d
        low, high = float(np.min(x)), float(np.max(x))
        at_low, at_high = int(np.count_nonzero(x == low)), int(np.count_nonzero(x == high))
        values = {low: at_low, high: at_high} if low == high or at_low + at_high == len(x) else None
        sums = (float(np.sum(d2)), float(np.sum(d2 * d)), float(np.sum(d2 * d2)))
        return Moments(len(x), mean, *sums, low, high, values)

    def merged(self, other: Moments) -> Moments:
        """Return the moments of both streams together (Pébay 2008)."""
        if self.n == 0:
            return other
        n, na, nb = self.n + other.n, self.n, other.n
        d = other.mean - self.mean
        dn = d / n
        m2 = self.m2 + other.m2 + d * dn * na * nb
        m3 = self.m3 + other.m3 + d * dn**2 * na * nb * (na - nb) + 3 * dn * (na * other.m2 - nb * self.m2)
        m4 = (
            self.m4
            + other.m4
            + d * dn**3 * na * nb * (na * na - na * nb + nb * nb)
            + 6 * dn**2 * (na * na * other.m2 + nb * nb * self.m2)
            + 4 * dn * (na * other.m3 - nb * self.m3)
        )
        values = None
        if self.values is not None and other.values is not None:
            values = {v: self.values.get(v, 0) + other.values.get(v, 0) for v in {**self.values, **other.values}}
            values = values if len(values) <= 2 else None
        low, high = min(self.low, other.low), max(self.high, other.high)
        return Moments(n, self.mean + dn * nb, m2, m3, m4, low, high, values)

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON-ready form, which keeps every bit."""
        values = None if self.values is None else [[float.hex(v), count] for v, count in self.values.items()]
        names = ("mean", "m2", "m3", "m4", "low", "high")
        return {"n": self.n, "values": values, **{name: float.hex(getattr(self, name)) for name in names}}

    @staticmethod
    def from_dict(state: dict[str, Any]) -> Moments:
        """Return the moments that `to_dict` wrote."""
        values = state["values"]
        values = None if values is None else {float.fromhex(v): count for v, count in values}
        mean, m2, m3, m4, low, high = (float.fromhex(state[name]) for name in ("mean", "m2", "m3", "m4", "low", "high"))
        return Moments(state["n"], mean, m2, m3, m4, low, high, values)

    @property
    def variance(self) -> float:
        """Unbiased sample variance."""
        return self.m2 / (self.n - 1) if self.n > 1 else 0.0

    @property
    def stderr(self) -> float:
        """Standard error of the mean."""
        return math.sqrt(self.variance / self.n) if self.n else math.inf

    @property
    def skewness(self) -> float:
        """Sample skewness."""
        return math.sqrt(self.n) * self.m3 / self.m2**1.5 if self.m2 > 0 else 0.0

    @property
    def largest_share(self) -> float:
        """Share of the sum of squares that the most extreme sample has."""
        return max(self.high - self.mean, self.mean - self.low) ** 2 / self.m2 if self.m2 > 0 else 0.0


def mean_test(
    name: str, what: str, data: Moments, reference: float, error: float, alpha: float, cause: str = "bias"
) -> Finding:
    """Test that the expectation behind `data` lies within `error` of `reference`."""
    if data.n == 0:
        return Finding(name, "inconclusive", f"{what}: there are no data", alpha=alpha)
    if data.values is not None and len(data.values) == 1:
        finding = _constant(name, what, data, reference, error, alpha)
    elif data.values is not None:
        finding = _two_values(name, what, data, reference, error, alpha)
    else:
        finding = _student(name, what, data, reference, error, alpha)
    reach = normal_quantile(0.5 * MISS) * data.stderr
    effect = data.mean - reference
    interval = Interval(effect - reach, effect + reach, 1 - MISS)
    rejected = finding.outcome == "rejected"
    return replace(finding, interval=interval, cause=cause if rejected else "", region=_side(effect, rejected))


def _side(effect: float, rejected: bool) -> tuple[str, ...]:
    return (("too large" if effect > 0 else "too small"),) if rejected else ()


def trusted(data: Moments, alpha: float) -> bool:
    """Return whether Student's test may be used at alpha: two values are tested exactly, skewed ones need many samples."""
    if data.values is not None or data.m2 == 0:
        return True
    growth = abs(data.skewness) / (3 * math.sqrt(data.n)) * normal_quantile(alpha / 2) ** 3
    return growth <= LARGEST_CORRECTION and data.largest_share <= LARGEST_SHARE


def _resolution(what: str, data: Moments, error: float, alpha: float) -> Resolution:
    reach = normal_quantile(alpha / 2) + normal_quantile(MISS)
    return Resolution(f"bias of {what}", reach * data.stderr + error, MISS)


def _constant(name: str, what: str, data: Moments, reference: float, error: float, alpha: float) -> Finding:
    gap = abs(data.mean - reference)
    if gap <= error + 1e-12 * abs(reference):
        message = f"{what}: all {data.n} samples equal the reference {reference:.12g}"
        return Finding(
            name, "not rejected", message, None, alpha, effect=gap, resolution=Resolution(f"bias of {what}", error, 0)
        )
    message = (
        f"{what}: all {data.n} samples are {data.mean:.12g} and the reference is {reference:.12g}; an event too rare to be seen"
        " looks the same as a bias, so ask for more samples, or declare variance=0 if the estimator has none"
    )
    return Finding(name, "inconclusive", message, None, alpha, effect=data.mean - reference)


def _two_values(name: str, what: str, data: Moments, reference: float, error: float, alpha: float) -> Finding:
    assert data.values is not None
    (low, _), (high, count) = sorted(data.values.items())
    step = high - low
    p = binomial_p(count, data.n, (reference - error - low) / step, (reference + error - low) / step)
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"{what} {data.mean:.7g}, reference {reference:.7g} (exact binomial test of its two values)"
    effect = data.mean - reference
    return Finding(name, outcome, message, p, alpha, False, effect, effect, _resolution(what, data, error, alpha))


def _student(name: str, what: str, data: Moments, reference: float, error: float, alpha: float) -> Finding:
    gap = max(abs(data.mean - reference) - error, 0.0)
    z = gap / data.stderr
    needed = normal_quantile(alpha / 2)
    growth = abs(data.skewness) / (3 * math.sqrt(data.n))
    p_normal = student_two_sided(data.n - 1, z)
    effect = data.mean - reference
    message = (
        f"{what} {data.mean:.7g} +- {data.stderr:.2g}, reference {reference:.7g} (z = {effect / data.stderr:+.2f})"
    )
    if not trusted(data, alpha):
        enough = math.ceil(data.n * max(growth * needed**3 / LARGEST_CORRECTION, 1) ** 2)
        message += (
            f"; too skewed for a test at alpha = {alpha:.1g} (skewness {data.skewness:.3g}, the largest sample has"
            f" {data.largest_share:.1%} of the variance): ask for about {max(enough, 4 * data.n)} samples"
        )
        return Finding(
            name, "inconclusive", message, None, alpha, False, z, effect, _resolution(what, data, error, alpha)
        )
    p = _corrected(p_normal, growth, z, needed)
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    exact = growth * needed**3 < 0.3 and error < 0.01 * data.stderr
    return Finding(name, outcome, message, p, alpha, exact, z, effect, _resolution(what, data, error, alpha))


def _corrected(p_normal: float, growth: float, z: float, needed: float) -> float:
    """Return the corrected p-value; the correction stops growing where the expansion stops being one."""
    limit = max(needed, (LARGEST_CORRECTION / growth) ** (1 / 3)) if growth > 0 else math.inf
    return min(1.0, p_normal * math.exp(growth * min(z, limit) ** 3))
