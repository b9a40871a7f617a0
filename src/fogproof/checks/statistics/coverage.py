"""Do reported standard errors keep their promise? The share of intervals of two standard errors that hold the reference.

Standard errors of few values are no less right for holding it more rarely: the intervals are those of Student's t. The standard
error s of the mean of k independent values has Var s^2 / (E s^2)^2 = 2 / (k - 1) + excess kurtosis of the mean (Kenney & Keeping
1951): its scatter and that of the estimates tell the degrees of freedom k - 1. Of ten or fewer the law of the values decides as
much as their number (two coins hold the truth half of the time, two normal values 70%): such coverage is told and rejects nothing.
Skewed values cost coverage too: by Edgeworth's expansion of the studentised mean (Hall 1988) about a quarter of the squared
skewness of the estimate, at two standard errors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import binomial_at_most, binomial_interval, normal_quantile, student_two_sided
from fogproof.checks.verdict import EffectInterval, Finding, Outcome

SLACK = 0.05
"""Coverage that much below what is right is rejected: values need not be quite normal, but users must be safe."""

_STEADY = 2 / (
    8 * 7
)  # scatter of squares, relative, that eight coins have: that of eight values of any other law is larger
_FEW = 10.0  # degrees of freedom, below which the law of the values decides about coverage: twice those where it shows
_MOST = 4.0  # of the scatter of squares less the excess kurtosis: twice that of two values, and no k explains it
_SURE = 3.0  # standard errors, of normal values, by which a kurtosis must fall short
_SKEWNESS = 0.25  # coverage lost for each square of the skewness
_MISS = 0.01
_FORESEEN = 1e12  # realisations: nobody asks for more


@dataclass(frozen=True)
class Coverage:
    """How many of n intervals x +- 2 stderr held the reference, itself known to within its error; moments of stderr^2."""

    n: int = 0
    held: int = 0
    squares: tuple[Moments, ...] = field(default_factory=tuple)

    def after(self, x: np.ndarray, stderr: np.ndarray, reference: np.ndarray, error: np.ndarray) -> Coverage:
        """Return the count after values (n, channels) and standard errors, one a channel or one of all.

        A realisation counts if every channel is held.
        """
        stderr = np.broadcast_to(stderr, x.shape)
        held = np.all(np.abs(x - reference) <= 2 * stderr + error, axis=1)
        largest = float(np.max(stderr)) or 1.0
        unit = 1.0 if 1e-100 < largest < 1e100 else largest
        new = [Moments.of(np.ascontiguousarray((column / unit) ** 2)) for column in stderr.T]
        merged = [a.merged(b) for a, b in zip(self.squares, new, strict=True)] if self.squares else new
        return Coverage(self.n + len(held), self.held + int(np.count_nonzero(held)), tuple(merged))


def degrees_of_freedom(squares: Moments, values: Moments) -> float:
    """Return how many degrees of freedom standard errors have whose squares scatter like this; inf if they do not.

    Values with light tails hide some of their scatter; what heavy tails add to it counts as fewer degrees, which cover less.
    """
    scatter, excess = _scatter(squares), _excess(values)
    if scatter > _STEADY:
        scatter += max(-excess - _SURE * math.sqrt(24 / values.n), 0.0)
    return math.inf if scatter == 0 else min(max(2 / scatter, 1.0), 1e9)


def of_few_values(squares: Moments, values: Moments) -> bool:
    """Return whether these may be the standard errors of the means of few independent values."""
    scatter = _scatter(squares)
    return scatter > _STEADY and 2 / _FEW < scatter - _excess(values) < _MOST


def _scatter(squares: Moments) -> float:
    return (squares.deviation / squares.mean) ** 2 if squares.mean > 0 else math.inf


def _excess(values: Moments) -> float:
    return values.n * (values.m4 / values.m2) / values.m2 - 3 if values.m2 > 0 else 0.0


def coverage_test(
    name: str, data: Coverage, values: Sequence[Moments], off: Sequence[Moments], alpha: float
) -> Finding:
    """Test that the coverage is not below what is right (for several channels, that of all together): an exact binomial bound.

    values  the moments of the estimates, one channel each
    off     those of the square of the error less that of the standard error
    """
    freedom = [degrees_of_freedom(squares, v) for squares, v in zip(data.squares, values, strict=True)]
    few = any(of_few_values(squares, v) for squares, v in zip(data.squares, values, strict=True))
    missed = [1 - _nominal(one) for one in freedom]
    allowed = [SLACK + _SKEWNESS * v.skewness**2 for v in values]
    nominal, least = max(1 - sum(missed), 0.0), max(1 - sum(missed) - sum(allowed), 0.0)
    p = None if few else binomial_at_most(data.held, data.n, least)
    share = data.held / max(data.n, 1)
    low, high = binomial_interval(data.held, max(data.n, 1), _MISS)
    outcome: Outcome = "rejected" if p is not None and p <= alpha else "not rejected"
    message = f"{share:.2%} of the intervals of two standard errors hold the reference, {nominal:.2%} would be right"
    if min(freedom, default=math.inf) < 30:
        degrees = f"{min(freedom):.2g} degree{'s' * (round(min(freedom), 1) != 1)}"
        message += f"{' for normal values' * few} with {degrees} of freedom: use Student's t for intervals"
        message += "; of so few values their law decides, and only their squares are judged" * few
    each = zip(freedom, data.squares, values, off, strict=True)
    needed = max((_to_tell_n(*one, alpha) for one in each), default=0.0)
    if data.n < needed < _FORESEEN:
        message += f"; that they divide by n instead of n - 1 would show with {needed:.2g} realisations"
    cause = "wrong standard errors" if outcome == "rejected" else ""
    interval = EffectInterval(low - nominal, high - nominal, 1 - _MISS)
    return Finding(name, outcome, message, p, alpha, False, share, share - nominal, interval=interval, cause=cause)


def _to_tell_n(freedom: float, squares: Moments, values: Moments, off: Moments, alpha: float) -> float:
    """Return how many realisations tell standard errors from those that are too small by sqrt(1 - 1 / n).

    off  moments of (x - reference)^2 - stderr^2, whose mean leaves 0 by a share 1 / n of the first; Student's test of it loses
         what is taken off for the skewness
    """
    if min(values.m2, squares.mean, off.m2) <= 0 or math.isinf(freedom):
        return 0.0
    kurtosis = values.n * (values.m4 / values.m2) / values.m2
    effect = 1 / ((freedom + 1) * math.sqrt(max(kurtosis - 1, 0.0) + (squares.deviation / squares.mean) ** 2))
    z, skewness = normal_quantile(alpha / 2), abs(off.skewness) / 3
    if (skewness * z**3) ** 2 > off.n:
        return 0.0  # too skewed yet; the test itself says what it needs
    return ((z + normal_quantile(_MISS)) / effect) ** 2 / max(1 - 2 * skewness * effect, 0.25)


def _nominal(freedom: float) -> float:
    """Return P(|T| < 2) for Student's law."""
    return math.erf(math.sqrt(2)) if freedom > 1e6 else 1 - student_two_sided(freedom, 2.0)
