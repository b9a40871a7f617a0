"""Count, mean and central moments of a stream of numbers, merged batch by batch, whatever their scale."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

ORDINARY = 2.0**150  # deviations between 1 / this and this have powers, up to the sixth, that binary64 holds
_LARGE = 2.0**1000  # sums of such numbers may overflow


@dataclass
class Moments:
    """Count, mean and central moments of a stream of numbers; merging in a fixed order gives the same bits every time.

    m2, m3, m4  sums of powers of the deviations from the mean, in units of `scale`
    values      counts while at most two values have been seen
    scale       a power of two, 1 unless deviations are so large or small that their powers would leave binary64
    """

    n: int = 0
    mean: float = 0.0
    m2: float = 0.0
    m3: float = 0.0
    m4: float = 0.0
    low: float = math.inf
    high: float = -math.inf
    values: dict[float, int] | None = field(default_factory=dict)
    scale: float = 1.0

    @staticmethod
    def of(x: np.ndarray) -> Moments:
        """Return the moments of one batch (n,)."""
        low, high = float(np.min(x)), float(np.max(x))
        mean = float(mean_of(x))
        mean = min(max(mean, low), high)  # rounding may leave the range
        scale = _scale_of(max(high - mean, mean - low))
        d = x - mean if scale == 1 else (x - mean) / scale
        d2 = d * d
        at_low, at_high = int(np.count_nonzero(x == low)), int(np.count_nonzero(x == high))
        values = {low: at_low, high: at_high} if low == high or at_low + at_high == len(x) else None
        sums = (float(np.sum(d2)), float(np.sum(d2 * d)), float(np.sum(d2 * d2)))
        return Moments(len(x), mean, *sums, low, high, values, scale)

    def merged(self, other: Moments) -> Moments:
        """Return the moments of both streams together (Pébay 2008)."""
        if self.n == 0:
            return other
        low, high = min(self.low, other.low), max(self.high, other.high)
        scale = _scale_of(high - low) if (self.scale, other.scale) != (1, 1) else 1.0
        n, na, nb = self.n + other.n, self.n, other.n
        d = (other.mean - self.mean) / scale
        if scale == 1 and not 1 / ORDINARY < abs(d) < ORDINARY and d != 0:
            scale = _scale_of(high - low)
            d = (other.mean - self.mean) / scale
        dn = d / n
        (a2, a3, a4), (b2, b3, b4) = self._in_units(scale), other._in_units(scale)
        m2 = a2 + b2 + d * dn * na * nb
        m3 = a3 + b3 + d * dn**2 * na * nb * (na - nb) + 3 * dn * (na * b2 - nb * a2)
        m4 = (
            a4
            + b4
            + d * dn**3 * na * nb * (na * na - na * nb + nb * nb)
            + 6 * dn**2 * (na * na * b2 + nb * nb * a2)
            + 4 * dn * (na * b3 - nb * a3)
        )
        values = None
        if self.values is not None and other.values is not None:
            values = {v: self.values.get(v, 0) + other.values.get(v, 0) for v in {**self.values, **other.values}}
            values = values if len(values) <= 2 else None
        return Moments(n, self.mean + dn * nb * scale, m2, m3, m4, low, high, values, scale)

    def _in_units(self, scale: float) -> tuple[float, float, float]:
        if self.m2 == 0 or self.scale == scale:
            return self.m2, self.m3, self.m4
        ratio = self.scale / scale
        return self.m2 * ratio**2, self.m3 * ratio**3, self.m4 * ratio**4

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON-ready form, which keeps every bit."""
        values = None if self.values is None else [[float.hex(v), count] for v, count in self.values.items()]
        names = ("mean", "m2", "m3", "m4", "low", "high", "scale")
        return {"n": self.n, "values": values, **{name: float.hex(getattr(self, name)) for name in names}}

    @staticmethod
    def from_dict(state: dict[str, Any]) -> Moments:
        """Return the moments that `to_dict` wrote."""
        values = state["values"]
        values = None if values is None else {float.fromhex(v): count for v, count in values}
        mean, m2, m3, m4, low, high = (float.fromhex(state[name]) for name in ("mean", "m2", "m3", "m4", "low", "high"))
        return Moments(state["n"], mean, m2, m3, m4, low, high, values, float.fromhex(state.get("scale", "0x1p+0")))

    @property
    def deviation(self) -> float:
        """Standard deviation of one number, from the unbiased sample variance."""
        return math.sqrt(self.m2 / (self.n - 1)) * self.scale if self.n > 1 else 0.0

    @property
    def variance(self) -> float:
        """Unbiased sample variance; it may leave the range of binary64 where `deviation` does not."""
        return (self.m2 / (self.n - 1)) * self.scale * self.scale if self.n > 1 else 0.0

    @property
    def stderr(self) -> float:
        """Standard error of the mean."""
        return math.sqrt(self.m2 / (self.n - 1) / self.n) * self.scale if self.n > 1 else math.inf

    @property
    def skewness(self) -> float:
        """Sample skewness."""
        return math.sqrt(self.n) * (self.m3 / self.m2) / math.sqrt(self.m2) if self.m2 > 0 else 0.0

    @property
    def largest(self) -> float:
        """The most extreme deviation from the mean."""
        return max(self.high - self.mean, self.mean - self.low) if self.n else 0.0

    @property
    def largest_share(self) -> float:
        """Share of the sum of squares that the most extreme number has."""
        return (self.largest / self.scale) ** 2 / self.m2 if self.m2 > 0 else 0.0


def mean_of(x: np.ndarray) -> np.ndarray:
    """Return the mean along the first axis; a sum of numbers that are nearly as large as there are does not overflow."""
    large = max(abs(float(np.min(x))), abs(float(np.max(x)))) > _LARGE
    return np.asarray(np.mean(x / _LARGE, axis=0) * _LARGE if large else np.mean(x, axis=0))


def _scale_of(spread: float) -> float:
    if spread == 0 or 1 / ORDINARY < spread < ORDINARY or math.isinf(spread):
        return 1.0
    return math.ldexp(1.0, min(math.frexp(spread)[1], 1023))
