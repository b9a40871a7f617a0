"""How many ulps a formula is off over two of its arguments, ours and as others write it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import ClassVar

import numpy as np

from fogproof.reports.charts.axes import Axes
from fogproof.reports.charts.colours import INK, diverging
from fogproof.reports.charts.scale import Scale
from fogproof.reports.charts.sheet import FONT_SIZE, Outline, Sheet, Words
from fogproof.reports.text import label

PANEL, GAP, LEFT, BELOW, ABOVE = 250.0, 26.0, 84.0, 86.0, 26.0
BITS = {"float64": 52.0, "float32": 23.0}
"""Where colours end: all digits lost."""


@dataclass(frozen=True)
class ErrorMap:
    """Maps over the same grid, side by side.

    names   of the two arguments
    values  those of either, which need not be evenly spaced: every cell is as wide as every other
    panels  (what is drawn, log2 of the error at each place of the grid, the first argument's places outermost)
    """

    names: tuple[str, str]
    values: tuple[tuple[float, ...], tuple[float, ...]]
    panels: tuple[tuple[str, tuple[float, ...]], ...]
    precision: str = "float64"

    HOW: ClassVar[str] = (
        "Each cell is one pair of arguments; they crowd where floating point fails. White: off by no more than rounding the "
        "arguments may do. The deeper the red, the more bits are wrong beyond that; the deepest has none right."
    )

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [px]."""
        return LEFT + len(self.panels) * (PANEL + GAP) + 80, ABOVE + PANEL + BELOW

    def draw(self, sheet: Sheet) -> str:
        """Draw one panel a form, and the scale of colours in bits."""
        n, m = map(len, self.values)
        most = BITS.get(self.precision, 52.0)
        for k, (name, bits) in enumerate(self.panels):
            left = LEFT + k * (PANEL + GAP)
            axes = Axes(sheet, (left, ABOVE, PANEL, PANEL), Scale(-0.5, n - 0.5), Scale(-0.5, m - 0.5))
            axes.frame(ticks=(0, 0), rules=False)
            self._cells(axes, np.array(bits).reshape(n, m) / most)
            self._ticks(sheet, left, k == 0)
            sheet.shapes.append(Words(left + PANEL / 2, ABOVE - 9, label(name, 34), INK, "middle"))
            sheet.shapes.append(Words(left + PANEL / 2, ABOVE + PANEL + 78, label(self.names[0]), INK, "middle"))
        sheet.shapes.append(Words(FONT_SIZE, ABOVE + PANEL / 2, label(self.names[1]), INK, "middle", turned=True))
        bar = Axes(sheet, (LEFT + len(self.panels) * (PANEL + GAP), ABOVE, 14, PANEL), Scale(0, 1), Scale(0, most))
        shades = np.linspace(0, most, 21)
        bar.cells(((0, 1), shades), [[diverging(value) for value in np.linspace(0, 1, 20)]])
        bar.colour_scale("bits lost")
        told = [f"{label(name)} loses at most {max(0.0, max(bits)):.3g} bits" for name, bits in self.panels]
        return f"Error over {label(self.names[0])} and {label(self.names[1])}: {'; '.join(told)}."

    def _cells(self, axes: Axes, share: np.ndarray) -> None:
        """Fill the cells; equal neighbours are one rectangle."""
        alike: dict[str, list[Sequence[tuple[float, float]]]] = {}
        for i, column in enumerate(share.tolist()):
            start = 0
            for colour, run in groupby(diverging(max(0.0, value)) for value in column):
                end = start + len(list(run))
                a, b = axes.at([i - 0.5, i + 0.5], [start - 0.5, end - 0.5])
                alike.setdefault(colour, []).append([a, (b[0], a[1]), b, (a[0], b[1])])
                start = end
        for colour, paths in alike.items():
            axes.sheet.shapes.append(Outline(paths, fill=colour, crisp=True))

    def _ticks(self, sheet: Sheet, left: float, labelled: bool) -> None:
        for i in places(len(self.values[0])):
            x = left + PANEL * (i + 0.5) / len(self.values[0])
            sheet.shapes.append(Outline([[(x, ABOVE + PANEL), (x, ABOVE + PANEL + 4)]], INK, 1))
            words = short(self.values[0][i])
            sheet.shapes.append(Words(x + 5, ABOVE + PANEL + 8 + 7.2 * len(words), words, INK, turned=True, size=12))
        if not labelled:
            return
        for j in places(len(self.values[1])):
            y = ABOVE + PANEL - PANEL * (j + 0.5) / len(self.values[1])
            sheet.shapes.append(Outline([[(left - 4, y), (left, y)]], INK, 1))
            sheet.shapes.append(Words(left - 7, y + 4, short(self.values[1][j]), INK, "end", size=12))


def places(n: int) -> list[int]:
    """Return about seven places of n, both ends among them."""
    return sorted({round(k * (n - 1) / 6) for k in range(7)})


def short(value: float) -> str:
    """Return a number in a few characters: its distance from 1 where that is what matters."""
    if value == value and 0.99 <= abs(value) < 1:
        return f"{'−' if value < 0 else ''}1−{1 - abs(value):.0e}".replace("e-0", "e-")
    return (
        f"{value:.2g}".replace("e-0", "e-")
        .replace("e+0", "e")
        .replace("e+", "e")
        .replace("-", "−", 1 if value < 0 else 0)
    )
