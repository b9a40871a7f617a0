"""How much longer each estimator takes than in an earlier run, what the machine did taken out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.reports.charts.axes import DASHED, Axes
from fogproof.reports.charts.colours import EXPECTED, INK, OBSERVED
from fogproof.reports.charts.legend import Key, legend
from fogproof.reports.charts.names import SIZE, cut
from fogproof.reports.charts.scale import Scale, spanning
from fogproof.reports.charts.sheet import Sheet
from fogproof.reports.charts.sheet_png import text_width

_LINES = 16
"""Estimators that have a line: those that changed first, then those whose times are furthest apart."""
_LONGEST = 0.5
"""Of the width, for names."""
_FURTHEST = 10.0
"""Intervals that reach further than this factor from any time leave the picture."""


@dataclass(frozen=True)
class TimeChanges:
    """Of each estimator its name, time after / before with the interval [low, high], and whether it changed beyond noise."""

    names: tuple[str, ...]
    ratio: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    changed: tuple[bool, ...]

    HOW: ClassVar[str] = (
        "Each line is an estimator. The mark is its time in the newer run over that in the older one, the bar the "
        "interval that holds the truth 99 times of 100. On the dashed line nothing changed; to the right it became "
        "slower. A square changed beyond noise: chance alone, and what a process meets of the machine, bring so much "
        "once in a million comparisons. A dot whose bar ends before the dashed line has perhaps changed."
    )

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [px]: a line for each estimator that is shown."""
        return 620.0, 96.0 + 21.0 * min(len(self.names), _LINES)

    def draw(self, sheet: Sheet) -> str:
        """Draw ratio and interval of each, those that changed first."""
        ratio, low, high = np.array(self.ratio), np.array(self.low), np.array(self.high)
        order = sorted(range(ratio.size), key=lambda k: (not self.changed[k], -abs(float(np.log(ratio[k])))))[:_LINES]
        keys = [Key("changed beyond noise", EXPECTED, "square"), Key("not beyond noise", OBSERVED, "dot")]
        top = legend(sheet, [*keys, Key("no change", INK, dash=DASHED)], 8, 0, sheet.width - 8) + 4
        names = [cut(self.names[k], _LONGEST * sheet.width) for k in order]
        left = 16 + max(text_width(name, SIZE) for name in names)
        ends = np.concatenate(
            [np.maximum(low, ratio.min() / _FURTHEST), np.minimum(high, ratio.max() * _FURTHEST), [0.9, 1.1]]
        )
        across, lines = spanning(ends, log=True), Scale(len(order) - 0.5, -0.5)
        axes = Axes(sheet, (left, top, sheet.width - left - 24, sheet.height - top - 50), across, lines)
        axes.frame("time, after / before", ticks=(6, 0))
        axes.line([1.0, 1.0], [lines.low, lines.high], INK, DASHED, 1)
        for y, k in enumerate(order):
            colour, marker = (EXPECTED, "square") if self.changed[k] else (OBSERVED, "dot")
            axes.line(np.clip([low[k], high[k]], across.low, across.high), [y, y], colour)
            axes.points([ratio[k]], [y], colour, "square" if marker == "square" else "dot")
        axes.names(names, np.arange(len(order)))
        n, beyond = ratio.size, sum(self.changed)
        off = sum(not (a <= 1 <= b or changed) for a, b, changed in zip(low, high, self.changed, strict=True))
        perhaps = f"; {off} more perhaps" if off else ""
        more = f" Shown are {len(order)}." if n > len(order) else ""
        return (
            f"Times of {n} estimator{'' if n == 1 else 's'}, after over before: {ratio.min():.3g} to {ratio.max():.3g}; "
            f"{beyond or 'none'} changed beyond noise{perhaps}.{more}"
        )
