"""What the passes could not have missed: the smallest error each would have caught."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.reports.charts.axes import Axes, Marker
from fogproof.reports.charts.colours import EXPECTED, OBSERVED, THIRD
from fogproof.reports.charts.legend import Key, legend
from fogproof.reports.charts.names import SIZE, cut, shared_folder
from fogproof.reports.charts.scale import Scale, spanning
from fogproof.reports.charts.sheet import Sheet
from fogproof.reports.charts.sheet_png import text_width
from fogproof.reports.text import label

_NAMED = 48  # passes that have a line each
_LONGEST = 0.55  # of the width, for names


@dataclass(frozen=True)
class Resolutions:
    """One (case name, kind of error, smallest error caught) for each pass that states one."""

    passes: tuple[tuple[str, str, float], ...]

    HOW: ClassVar[str] = (
        "What a pass is worth: an error larger than the mark would have been rejected, with the probability that the "
        "verdict states. Further left is sharper. A mark far to the right is a pass that says little: give that case "
        "more samples."
    )

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [px]: a line for each named case, or a broader one for each kind."""
        if len(self.passes) <= _NAMED:
            return 560.0, 90.0 + 20 * len(self.passes) + 20 * len(self._kinds)
        return 560.0, 90.0 + 56 * len(self._kinds)

    @property
    def _kinds(self) -> list[str]:
        return sorted({kind for _, kind, _ in self.passes})

    def draw(self, sheet: Sheet) -> str:
        """Draw one mark a pass, sorted by kind and value: a line each while their names fit, otherwise a slope for each kind."""
        kinds = self._kinds
        rows = sorted(self.passes, key=lambda row: (kinds.index(row[1]), row[2]))
        values = [value for _, _, value in rows]
        named = len(rows) <= _NAMED
        looks: list[tuple[str, Marker]] = [
            (OBSERVED, "dot"),
            (EXPECTED, "square"),
            (THIRD, "triangle"),
            (OBSERVED, "cross"),
            (EXPECTED, "diamond"),
            (THIRD, "cross"),
        ]
        chosen = {kind: looks[index % len(looks)] for index, kind in enumerate(kinds)}
        counts = [sum(its == kind for _, its, _ in rows) for kind in kinds]
        keys = [Key(label(kind, 80), *chosen[kind]) for kind in kinds]
        top = (legend(sheet, keys, 8, 0, sheet.width - 8) if named else 4.0) + 4
        folder = shared_folder([name for name, _, _ in rows]) if named else ""
        lines = (
            [name.removeprefix(folder) for name, _, _ in rows]
            if named
            else [f"{k} ({n})" for k, n in zip(kinds, counts, strict=True)]
        )
        lines = [cut(line, _LONGEST * sheet.width) for line in lines]
        left = 16 + max(text_width(line, SIZE) for line in lines)
        y = Scale(len(rows), -1) if named else Scale(len(kinds) - 0.5, -0.5)
        across, beyond = _within(values)
        rows = [(name, kind, min(max(value, across.low), across.high)) for name, kind, value in rows]
        axes = Axes(sheet, (left, top, sheet.width - left - 20, sheet.height - top - 50), across, y)
        axes.frame("smallest relative error caught", ticks=(6, 0))
        for number, (kind, count) in enumerate(zip(kinds, counts, strict=True)):
            at = np.array([(value, y) for y, (_, its, value) in enumerate(rows) if its == kind])
            slope = number + 0.35 - 0.7 * (np.arange(count) + 0.5) / count
            axes.points(at[:, 0], at[:, 1] if named else slope, *chosen[kind])
        axes.names(lines, np.arange(len(lines)))
        named_kinds = ", ".join(label(kind, 80) for kind in kinds)
        least_and_most = " to ".join(dict.fromkeys(f"{end(values):.2g}" for end in (min, max)))
        return (
            f"{len(rows)} passes: errors above {least_and_most} ({named_kinds}) would have shown, "
            f"relative to what they are errors of.{f' All names begin with {folder}' if folder else ''}"
            f"{f' {beyond} lie beyond the axis and are drawn at its end.' if beyond else ''}"
        )


def _within(values: Sequence[float]) -> tuple[Scale, int]:
    """Return a scale that a few far ones do not stretch: three interquartile ranges, a decade at least; and how many are out."""
    logs = np.log10(values)
    low, high = np.quantile(logs, [0.25, 0.75])
    room = max(3 * (high - low), 1.0)
    inside = logs[(logs >= low - room) & (logs <= high + room)]
    return spanning(10**inside, log=True), len(values) - len(inside)
