"""Tests of a mean that hold for every n and every law they allow, where a normal approximation would not.

Data with a lower bound: bet on the mean being larger than claimed; if the claim is true, the wealth is a martingale that starts at
1 and exceeds 1/p with probability p at most (Ville; Waudby-Smith & Ramdas 2024). Data with an upper bound: the same of what is left
below it. A mean on the other side cannot be shown without a bound there: an event too rare to be seen may hold the rest. Where the
exact variance v is known, Catoni's (2012) influence function serves both sides: with psi(y) = sign(y) log(1 + |y| + y^2/2), the
expectation of exp(psi(theta (X - m))) is at most exp(theta^2 v / 2). Wealth may be looked at as often as one likes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.statistics.known import Known

_STAKES = 2.0 ** -np.arange(1, 17)  # less than all of the wealth: nothing is lost for good
_THETAS = np.array([0.5, 1.0, 2.0, 4.0])


@dataclass(frozen=True)
class Bets:
    """Wealth of bets against a claimed mean in [low, high], one channel.

    low, high  the claim
    known      what is declared of one realisation
    samples    how many realisations there will be: it sets the scale of Catoni's test
    alpha      for which it is tuned
    logs       logarithms of the wealth so far: one row of bets for each declared fact
    """

    low: float
    high: float
    known: Known
    samples: int
    alpha: float
    logs: tuple[np.ndarray, ...] = ()

    @property
    def possible(self) -> bool:
        """Whether anything is declared that could be bet on."""
        return math.isfinite(self.known.low) or math.isfinite(self.known.high) or self.known.variance is not None

    def after(self, x: np.ndarray) -> Bets:
        """Return the bets after the numbers x (n,)."""
        with np.errstate(over="ignore", under="ignore"):
            gains = self._gains(x)
        return replace(self, logs=tuple(a + b for a, b in zip(self.logs, gains, strict=True)) if self.logs else gains)

    def _gains(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        gains = []
        if math.isfinite(self.known.low):
            gains.append(_stakes(x - self.known.low, self.high - self.known.low))
        if math.isfinite(self.known.high):
            gains.append(_stakes(self.known.high - x, self.known.high - self.low))
        if self.known.deviation is not None and self._spread > 0:
            gains.append(self._catoni(x))
        return tuple(gains)

    def _catoni(self, x: np.ndarray) -> np.ndarray:
        middle, half, totals = 0.5 * (self.low + self.high), 0.5 * (self.high - self.low), []
        for theta in self._thetas:
            y = theta * (x - middle)
            size = np.abs(y)
            total = float(np.sum(np.copysign(np.log1p(size + 0.5 * size * size), y)))
            # psi grows no faster than its argument: the error of the claim costs theta times as much at most.
            rest = len(x) * theta * (half + 0.5 * theta * self._spread**2)
            totals += [total - rest, -total - rest]
        return np.array(totals)

    @property
    def _spread(self) -> float:
        """Bound on the root mean square about either end of the claim."""
        return math.hypot(self.known.deviation or 0.0, self.high - self.low)

    @property
    def _needed(self) -> float:
        return math.log(2 * len(_THETAS) / self.alpha)

    @property
    def _thetas(self) -> np.ndarray:
        """Scales of Catoni's function, about the best one for this number of samples."""
        return _THETAS * (math.sqrt(2 * self._needed / self.samples) / self._spread)

    @property
    def p_value(self) -> float:
        """The reciprocal of the average wealth: a valid p-value for every n."""
        if not self.logs:
            return 1.0
        wealth = _log_mean(np.array([_log_mean(row) for row in self.logs]))
        return min(1.0, math.exp(-max(min(wealth, 700.0), 0.0)))

    def detectable(self, miss: float) -> float:
        """Return the bias that Catoni's test finds but for the probability `miss`, whatever the law; inf without a variance.

        With probability 1 - miss the sum of psi is at least n (theta b - theta^2 (v + b^2) / 2) - log(1 / miss).
        """
        if self.known.variance is None or self._spread == 0:
            return math.inf
        root = math.sqrt(2 * self._needed)
        reach = (2 * self._needed + root * root / 2 + math.log(max(len(self.logs), 1) / miss)) / root
        bias = reach * self._spread / math.sqrt(self.samples)
        own = 1 + (bias / self._spread) ** 2
        return bias * own + (self.high - self.low)


def _stakes(above: np.ndarray, claim: float) -> np.ndarray:
    """Return the gains of bets that numbers >= 0 have a larger mean than claimed."""
    if claim <= 0:
        return np.full(len(_STAKES), math.inf if np.max(above) > 0 else 0.0)
    # what lies below its bound breaks the declaration: another finding says so
    ratio = np.maximum(above, 0.0) / claim - 1
    return np.array([float(np.sum(np.log1p(stake * ratio))) for stake in _STAKES])


def _log_mean(logs: np.ndarray) -> float:
    largest = float(np.max(logs))
    if math.isinf(largest):
        return largest
    return largest + math.log(float(np.mean(np.exp(logs - largest))))
