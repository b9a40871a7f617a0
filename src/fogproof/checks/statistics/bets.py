"""Tests of a mean that hold for every n and every law they allow, where a normal approximation would not.

Non-negative data: bet on the mean being larger than claimed; if the claim is true, the wealth is a martingale that starts at 1 and
exceeds 1/p with probability p at most (Ville; Waudby-Smith & Ramdas 2024). A mean that is too small cannot be shown without a bound
on the data: an event too rare to be seen may hold the rest. Where the exact variance v is known, Catoni's (2012) influence function
serves both sides: with psi(y) = sign(y) log(1 + |y| + y^2/2), the expectation of exp(psi(theta (X - m))) is at most
exp(theta^2 v / 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

_STAKES = 2.0 ** -np.arange(1, 17)  # less than all of the wealth: nothing is lost for good
_THETAS = np.array([0.5, 1.0, 2.0])


@dataclass(frozen=True)
class Bets:
    """Wealth of bets against a claimed mean in [low, high], one channel.

    low, high  the claim
    variance   the exact variance of one realisation (an upper bound), or None
    samples    how many realisations there will be: it sets the scale of Catoni's test
    alpha      for which it is tuned
    logs       (k,) logarithms of the wealth of each bet so far
    least      the smallest number seen: bets on large means need non-negative data
    """

    low: float
    high: float
    variance: float | None
    samples: int
    alpha: float
    logs: np.ndarray | None = None
    least: float = math.inf

    def after(self, x: np.ndarray) -> Bets:
        """Return the bets after the numbers x (n,)."""
        logs = self._gains(x)
        return replace(
            self, logs=logs if self.logs is None else self.logs + logs, least=min(self.least, float(x.min()))
        )

    def _gains(self, x: np.ndarray) -> np.ndarray:
        gains = []
        if self.high > 0 and x.min() >= 0 and self.least >= 0:
            ratio = x / self.high - 1
            gains += [float(np.sum(np.log1p(stake * ratio))) for stake in _STAKES]
        else:
            gains += [-math.inf] * len(_STAKES)
        if self.variance is not None:
            for theta in self.thetas:
                for sign, mean in ((1, self.high), (-1, self.low)):
                    y = sign * theta * (x - mean)
                    total = float(np.sum(np.sign(y) * np.log1p(np.abs(y) + 0.5 * y * y)))
                    gains.append(total - 0.5 * len(x) * theta**2 * self._spread)
        return np.array(gains)

    @property
    def _spread(self) -> float:
        """Bound on the mean square about either end of the claim."""
        return (self.variance or 0.0) + (self.high - self.low) ** 2

    @property
    def thetas(self) -> np.ndarray:
        """Scales of Catoni's function, about the best one for this number of samples."""
        if self._spread <= 0:
            return np.empty(0)
        return _THETAS * math.sqrt(2 * math.log(2 * len(_THETAS) / self.alpha) / (self.samples * self._spread))

    @property
    def p_value(self) -> float:
        """The reciprocal of the average wealth: a valid p-value for every n."""
        if self.logs is None:
            return 1.0
        sides = [self.logs[: len(_STAKES)], self.logs[len(_STAKES) :]]
        sides = [side for side in sides if len(side) and np.max(side) > -math.inf]
        if not sides:
            return 1.0
        logs = [_log_mean(side) for side in sides]
        return min(1.0, math.exp(-max(min(_log_mean(np.array(logs)), 700.0), 0.0)))

    @property
    def two_sided(self) -> bool:
        """Whether a mean that is too small would be found too."""
        return self.variance is not None

    def detectable(self, miss_quantile: float) -> float:
        """Return the bias that Catoni's test finds but for the probability of that normal quantile."""
        sigma = math.sqrt(self._spread / self.samples)
        return (math.sqrt(2 * math.log(2 * len(_THETAS) / self.alpha)) + miss_quantile) * sigma + (self.high - self.low)


def _log_mean(logs: np.ndarray) -> float:
    largest = float(np.max(logs))
    if largest == -math.inf:
        return largest
    return largest + math.log(float(np.mean(np.exp(logs - largest))))
