"""Names at the ends of curves, instead of a legend: spread so that none covers another, each beside the look of its curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap

from fogproof.reports.charts.axes import Marker, mark
from fogproof.reports.charts.colours import INK
from fogproof.reports.charts.sheet import FONT_SIZE, Outline, Sheet, Words
from fogproof.reports.charts.sheet_png import text_width

_LINE = 1.15 * FONT_SIZE
_GAP = 0.3 * FONT_SIZE
_LETTER = 7.5
"""Width [px] of a letter of English text, about."""
_BESIDE = 44.0
"""Between the axes and the names [px]: the leader, and a piece of the curve with its mark."""


@dataclass(frozen=True)
class EndLabel:
    """A name, where its curve ends [px], and what that looks like."""

    text: str
    colour: str
    end: tuple[float, float]
    marker: Marker
    dash: tuple[float, float] | None = None


def lines_of(text: str, width: int) -> list[str]:
    """Return a name on as many lines as it needs, of at most so many characters, fewer where they are wide."""
    most = _LETTER * width
    for letters in range(width, 1, -1):
        lines = wrap(text, letters) or [text]
        if max(text_width(line, FONT_SIZE) for line in lines) <= most:
            return lines
    return wrap(text, 1) or [text]


def height_of(names: Sequence[str], width: int) -> float:
    """Return how high [px] names are, one below the other."""
    return sum(len(lines_of(name, width)) * _LINE + _GAP for name in names)


def write_labels(sheet: Sheet, labels: Sequence[EndLabel], right: float, top: float, bottom: float, width: int) -> None:
    """Write the labels to the right of an axes box that ends at `right`, between `top` and `bottom` [px] where they have room."""
    order = sorted(labels, key=lambda label: (label.end[1], label.end[0]))
    heights = [len(lines_of(label.text, width)) * _LINE + _GAP for label in order]
    tops: list[float] = []
    for label, height in zip(order, heights, strict=True):
        least = tops[-1] + heights[len(tops) - 1] if tops else top
        tops.append(max(label.end[1] - height / 2, least))
    lowest = bottom
    for k in reversed(range(len(tops))):  # what hangs over the bottom pushes back
        tops[k] = min(tops[k], lowest - heights[k])
        lowest = tops[k]
    for label, start, height in zip(order, tops, heights, strict=True):
        middle, x = start + (height - _GAP) / 2, right + _BESIDE
        sheet.shapes += [
            Outline([[label.end, (right + 10, middle)]], label.colour, 1, opacity=0.45),  # fainter than any curve
            Outline([[(right + 10, middle), (x - 6, middle)]], label.colour, 2, label.dash),
            mark([((right + 4 + x) / 2, middle)], label.colour, label.marker),
        ]
        for number, line in enumerate(lines_of(label.text, width)):
            sheet.shapes.append(Words(x, start + (number + 0.8) * _LINE, line, INK))
