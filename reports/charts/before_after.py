"""One number of every case in two runs, one against the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.reports.charts.axes import DASHED, Axes
from fogproof.reports.charts.colours import EXPECTED, GRID, INK, OBSERVED
from fogproof.reports.charts.legend import Key, legend
from fogproof.reports.charts.names import SIZE
from fogproof.reports.charts.scale import spanning
from fogproof.reports.charts.sheet import Sheet, Words
from fogproof.reports.charts.sheet_png import text_width
from fogproof.reports.text import label

_NAMED = 3
_Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class BeforeAfter:
    """`what` [unit] was `before` and is `after` for the case of that name; all numbers are positive."""

    what: str
    names: tuple[str, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]

    HOW: ClassVar[str] = (
        "Each mark is a case: across, what it was in the older run; up, what it is now. On the dashed line nothing "
        "changed; above it the number grew. Marks outside the grey band changed by more than a factor of two; the furthest "
        "are named where there is room."
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
        marks = axes.at(before, after)
        taken: list[_Box] = [(x - 4, y - 4, x + 4, y + 4) for x, y in marks]
        for index in far[np.abs(np.log2(ratio[far])) > 1]:
            (x, y), name = marks[index], label(self.names[index], 24)
            width = text_width(name, SIZE)
            for left, base in [(left, y + down) for left in (x + 7, x - 7 - width) for down in (4.0, -6.0, 14.0)]:
                box = (left, base - SIZE, left + width, base + 3)
                if axes.box[0] <= left and left + width <= sheet.width and not any(_overlap(box, one) for one in taken):
                    taken.append(box)
                    sheet.shapes.append(Words(left, base, name, INK, size=SIZE))
                    break  # where there is no room a name is left out: one over a mark or another name is none
        middle = float(np.exp(np.median(np.log(ratio))))
        return (
            f"{self.what} of {ratio.size} cases after against before: the middle ratio is {middle:.2f}, the smallest "
            f"{ratio.min():.2g}, the largest {ratio.max():.2g}."
        )


def _overlap(a: _Box, b: _Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
