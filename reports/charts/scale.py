"""Scales, linear or logarithmic, and their ticks: round values in one notation an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, inf, log10

import numpy as np

Values = Sequence[float] | np.ndarray


LEAST, MOST = 1e-290, 1e290
"""What scales reach at most: with margins around it is a number still."""


@dataclass(frozen=True)
class Scale:
    """Data from `low` to `high`, which differ; logarithmic ones are positive, `whole` ones counts, with ticks at whole numbers."""

    low: float
    high: float
    log: bool = False
    whole: bool = False

    def __call__(self, values: Values) -> np.ndarray:
        """Return where values lie: 0 at low, 1 at high."""
        data = np.asarray(values, dtype=float)
        place: np.ndarray
        if not self.log:
            place = (data - self.low) / (self.high - self.low)
            return place
        with np.errstate(divide="ignore", invalid="ignore"):
            place = (np.log10(data) - log10(self.low)) / (log10(self.high) - log10(self.low))
            return place

    def ticks(self, most: int) -> list[tuple[float, str]]:
        """Return round values within the scale, about `most` of them at most, and their labels."""
        if most < 1:
            return []
        if not 0 < self.high - self.low < inf:  # a record changed by hand may hold anything
            return []
        return _decades(self.low, self.high, most) if self.log else _steps(self.low, self.high, most, self.whole)


def spanning(values: Values, log: bool = False, margin: float = 0.05) -> Scale:
    """Return a scale around all finite values (positive ones if logarithmic), never empty."""
    data = np.asarray(values, dtype=float)
    data = data[np.isfinite(data) & ((data > 0) | (not log))]
    data = np.clip(data, LEAST if log else -MOST, MOST)
    low, high = (float(data.min()), float(data.max())) if data.size else (1.0, 1.0)
    if log:
        room = max(high**margin / low**margin, 1.05)
        return Scale(low / room, high * room, True)
    room = margin * (high - low) or 0.05 * abs(high) or 1.0
    return Scale(low - room, high + room)


def _steps(low: float, high: float, most: int, whole: bool = False) -> list[tuple[float, str]]:
    raw = max((high - low) / most, 1.0 if whole else 0.0)
    power = 10.0 ** floor(log10(raw))
    factors = (1, 2, 5, 10) if whole else (1, 2, 2.5, 5, 10)
    step = next(factor * power for factor in factors if factor * power >= raw * (1 - 1e-9))
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    if last - first > 2 * most:  # a span below the last digit of its numbers
        return []
    values = [step * i for i in range(first, last + 1)]
    digits = max((len(f"{value / step:.0f}") for value in values), default=1) + (2 if step == 2.5 * power else 1)
    return [(value, _plain(value, digits)) for value in values]


def _plain(value: float, digits: int) -> str:
    if value == 0:
        return "0"
    text = f"{value:.{min(max(digits, 5 if 1 <= abs(value) < 1e5 else 1), 15)}g}"  # 50 and 100, not 10²
    mantissa, _, exponent = text.partition("e")
    return (f"{mantissa}·{_power(int(exponent))}" if exponent else text).replace("-", "−")


def _decades(low: float, high: float, most: int) -> list[tuple[float, str]]:
    if low <= 0:
        return []
    first, last = floor(log10(low)), ceil(log10(high))
    span = log10(high) - log10(low)
    every = max(1, ceil(span / most))
    within: list[float] = []
    for factors in ((1, 2, 5),) if span < 2 else ((1,), (1, 3), (1, 2, 5)):
        values = [f * 10.0**e for e in range(first, last + 1) if e % every == 0 for f in factors]
        within = [value for value in values if low * (1 - 1e-9) <= value <= high * (1 + 1e-9)]
        if len(within) > 2:
            break
    if len(within) < 2:
        return _steps(low, high, most)
    plain = all(1e-3 <= value < 1e5 for value in within)  # one notation an axis
    return [(value, f"{value:g}" if plain else _mantissa(value)) for value in within]


def _mantissa(value: float) -> str:
    exponent = floor(log10(value) + 1e-9)
    factor = round(value / 10.0**exponent)
    return _power(exponent) if factor == 1 else f"{factor}·{_power(exponent)}"


def _power(exponent: int) -> str:
    return "10" + str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
