"""Legends: entries side by side, as many on a line as fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fogproof.reports.charts.axes import mark
from fogproof.reports.charts.colours import GRID, INK
from fogproof.reports.charts.sheet import FONT_SIZE, Outline, Sheet, Words
from fogproof.reports.charts.sheet_png import text_width


@dataclass(frozen=True)
class Key:
    """One entry of a legend; `kind` is "line", "area" or a marker, which may stand on a line."""

    text: str
    colour: str
    kind: str = "line"
    dash: tuple[float, float] | None = None
    joined: bool = False


def legend(sheet: Sheet, keys: Sequence[Key], left: float, top: float, width: float) -> float:
    """Write the entries side by side, as many on a line as fit, and return the height [px] that they take."""
    x, y = left, top + FONT_SIZE
    for key in keys:
        needed = 32 + text_width(key.text, FONT_SIZE)
        if x > left and x + needed > left + width:
            x, y = left, y + 1.4 * FONT_SIZE
        middle = y - 0.36 * FONT_SIZE
        if key.kind == "line" or key.joined:
            sheet.shapes.append(Outline([[(x, middle), (x + 26, middle)]], key.colour, 2, key.dash))
        if key.kind == "area":
            corners = [(x, middle - 5), (x + 26, middle - 5), (x + 26, middle + 5), (x, middle + 5)]
            sheet.shapes.append(Outline([corners], fill=key.colour, opacity=0.4 if key.colour != GRID else 1))
        elif key.kind != "line":
            sheet.shapes.append(mark([(x + 13, middle)], key.colour, key.kind, 5))  # type: ignore[arg-type]
        sheet.shapes.append(Words(x + 32, y, key.text, INK))
        x += needed + 18
    return y - top + 0.7 * FONT_SIZE if keys else 0.0
