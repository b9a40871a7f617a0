"""One number of every case in two runs, one against the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.reports.charts.axes import DASHED, Axes
from fogproof.reports.charts.colours import EXPECTED, GRID, INK, OBSERVED
from fogproof.reports.charts.legend import Key, legend
from fogproof.reports.charts.scale import spanning
from fogproof.reports.charts.sheet import Sheet, Words
from fogproof.reports.text import label

_NAMED = 3


@dataclass(frozen=True)
class BeforeAfter:
    """`what` [unit] was `before` and is `after` for the case of that name; all numbers are positive."""

    what: str
    names: tuple[str, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]

    HOW: ClassVar[str] = (
        "Each mark is a case: across, what it was in the older run; up, what it is now. On the dashed line nothing "
        "changed; above it the number grew. Marks outside the grey band changed by more than a factor of two and are "
        "named."
    )

    def draw(self, sheet: Sheet) -> str:
        """Draw after over before, both logarithmic, with the factor of two around no change; name what lies far out."""
        before, after = np.array(self.before), np.array(self.after)
        ratio = after / before
        keys = [Key("within a factor of 2", GRID, "area"), Key("no change", EXPECTED, dash=DASHED)]
        top = legend(sheet, [*keys, Key("a case", OBSERVED, "dot")], 20, 0, sheet.width - 20) + 4
        scale = spanning(np.concatenate([before, after]), log=True)
        axes = Axes(sheet, (96, top, sheet.width - 112, sheet.height - top - 50), scale, scale)
        axes.frame(f"{self.what}, before", f"{self.what}, after")
        ends = np.array([scale.low, scale.high])
        axes.band(ends, ends / 2, ends * 2, GRID, 0.6)
        axes.line(ends, ends, EXPECTED, DASHED)
        axes.points(before, after, OBSERVED)
        far = np.argsort(-np.abs(np.log(ratio)), kind="stable")[:_NAMED]
        named: list[tuple[float, float]] = []
        for index in far[np.abs(np.log2(ratio[far])) > 1]:
            (x, y), right = axes.at(before[[index]], after[[index]])[0], scale(before[[index]])[0] < 0.5
            if any(abs(y - other) < 14 and abs(x - beside) < 200 for beside, other in named):
                continue  # one name over another is none
            named.append((x, y))
            name = label(self.names[index], 24)
            sheet.shapes.append(Words(x + (7 if right else -7), y - 6, name, INK, "start" if right else "end", size=12))
        middle = float(np.exp(np.median(np.log(ratio))))
        return (
            f"{self.what} of {ratio.size} cases after against before: the middle ratio is {middle:.2f}, the smallest "
            f"{ratio.min():.2g}, the largest {ratio.max():.2g}."
        )
