"""Axes on a sheet: linear or logarithmic scales, ticks, labels, and marks at data coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np

from fogproof.reports.charts.colours import GRID, INK
from fogproof.reports.charts.scale import Scale, Values
from fogproof.reports.charts.sheet import FONT_SIZE, Dots, Group, Mark, Outline, Sheet, Words
from fogproof.reports.charts.sheet_png import text_width

DASHED = (7.0, 4.0)
Marker = Literal["dot", "square", "triangle", "cross", "diamond"]


@dataclass
class Axes:
    """A box (left, top, width, height) [px] of a sheet, with a scale for either direction; `y` grows upwards."""

    sheet: Sheet
    box: tuple[float, float, float, float]
    x: Scale
    y: Scale
    _inside: list[Mark] = field(default_factory=list)

    def frame(self, across: str = "", up: str = "", ticks: tuple[int, int] = (6, 5), rules: bool = True) -> None:
        """Draw grid, axes, ticks and labels; call it first, what comes later lies on top."""
        left, top, width, height = self.box
        bottom = top + height
        xs = [(left + width * float(self.x([value])[0]), name) for value, name in self.x.ticks(ticks[0])]
        ys = [(bottom - height * float(self.y([value])[0]), name) for value, name in self.y.ticks(ticks[1])]
        add = self.sheet.shapes.append
        if rules:
            grid = [[(x, top), (x, bottom)] for x, _ in xs] + [[(left, y), (left + width, y)] for y, _ in ys]
            add(Outline(grid, GRID, 1))
        add(Group(self.box, self._inside))
        marks = [[(x, bottom), (x, bottom + 4)] for x, _ in xs] + [[(left - 4, y), (left, y)] for y, _ in ys]
        add(Outline([[(left, top), (left, bottom), (left + width, bottom)], *marks], INK, 1))
        if across:  # axes without a label share the ticks of those below
            self.sheet.shapes += [Words(x, bottom + 6 + FONT_SIZE, name, INK, "middle") for x, name in xs]
            add(Words(left + width / 2, bottom + 12 + 2 * FONT_SIZE, across, INK, "middle"))
        self.sheet.shapes += [Words(left - 7, y + 0.36 * FONT_SIZE, name, INK, "end") for y, name in ys]
        if up:
            widest = max((text_width(name, FONT_SIZE) for _, name in ys), default=0)
            middle = top + height / 2
            add(Words(max(left - 16 - widest, FONT_SIZE), middle, up, INK, "middle", turned=True))

    def names(self, names: Sequence[str], values: Values) -> None:
        """Write names instead of ticks beside values of y."""
        left, size = self.box[0], 12.0
        places = self.at(np.full(len(names), self.x.low), values)
        self.sheet.shapes += [
            Words(left - 7, y + 0.36 * size, name, INK, "end", size=size)
            for (_, y), name in zip(places, names, strict=True)
        ]

    def colour_scale(self, up: str) -> None:
        """Draw what lies inside with ticks and a label to the right: a legend of colours."""
        left, top, width, height = self.box
        right, bottom = left + width, top + height
        self.sheet.shapes.append(Group(self.box, self._inside))
        ticks = [(bottom - height * float(self.y([value])[0]), name) for value, name in self.y.ticks(5)]
        self.sheet.shapes.append(Outline([[(right, y), (right + 4, y)] for y, _ in ticks], INK, 1))
        self.sheet.shapes += [Words(right + 7, y + 0.36 * FONT_SIZE, name, INK) for y, name in ticks]
        widest = max((text_width(name, FONT_SIZE) for _, name in ticks), default=0)
        self.sheet.shapes.append(
            Words(right + 14 + widest + FONT_SIZE, top + height / 2, up, INK, "middle", turned=True)
        )

    def at(self, x: Values, y: Values) -> list[tuple[float, float]]:
        """Return the places [px] of points; infinite coordinates lie far outside."""
        left, top, width, height = self.box
        across = np.nan_to_num(left + width * self.x(x), nan=np.nan, posinf=1e5, neginf=-1e5)
        up = np.nan_to_num(top + height - height * self.y(y), nan=np.nan, posinf=1e5, neginf=-1e5)
        return list(zip(np.clip(across, -1e5, 1e5).tolist(), np.clip(up, -1e5, 1e5).tolist(), strict=True))

    def line(
        self, x: Values, y: Values, colour: str, dash: tuple[float, float] | None = None, width: float = 2
    ) -> None:
        """Join points; what is not a number leaves a gap."""
        pieces: list[list[tuple[float, float]]] = [[]]
        for point in self.at(x, y):
            if np.isnan(point).any():
                pieces.append([])
            else:
                pieces[-1].append(point)
        pieces = [piece for piece in pieces if len(piece) > 1]
        if pieces:
            self._inside.append(Outline(pieces, colour, width, dash))

    def band(self, x: Values, low: Values, high: Values, colour: str, opacity: float = 0.25) -> None:
        """Fill between two curves where both are numbers."""
        known = ~np.isnan(self.x(x)) & ~np.isnan(self.y(low)) & ~np.isnan(self.y(high))
        if known.sum() > 1:
            x, low, high = (np.asarray(values, dtype=float)[known] for values in (x, low, high))
            around = self.at(x, low) + self.at(x, high)[::-1]
            self._inside.append(Outline([around], fill=colour, opacity=opacity))

    def stairs(
        self, values: Values, edges: Values, colour: str, dash: tuple[float, float] | None = None, fill: bool = False
    ) -> None:
        """Draw a value over each bin; filled down to 0."""
        x, y = np.repeat(edges, 2)[1:-1], np.repeat(values, 2)
        if fill:
            self.band(x, np.zeros(len(x)), y, colour, 0.35)
        self.line(x, y, colour, dash)

    def points(self, x: Values, y: Values, colour: str, marker: Marker = "dot", size: float = 4) -> None:
        """Put a mark of about `size` [px] radius at each point."""
        known = [point for point in self.at(x, y) if not np.isnan(point).any()]
        if known:
            self._inside.append(mark(known, colour, marker, size))

    def cells(self, edges: tuple[Values, Values], colours: Sequence[Sequence[str]]) -> None:
        """Fill the cells of a grid, cell (i, j) with colours[i][j]; cells of one colour are one shape."""
        x = [point[0] for point in self.at(edges[0], np.full(len(edges[0]), self.y.low))]
        y = [point[1] for point in self.at(np.full(len(edges[1]), self.x.low), edges[1])]
        alike: dict[str, list[list[tuple[float, float]]]] = {}
        for (a, b), column in zip(pairwise(x), colours, strict=True):
            for (c, d), colour in zip(pairwise(y), column, strict=True):
                alike.setdefault(colour, []).append([(a, c), (b, c), (b, d), (a, d)])
        self._inside += [Outline(paths, fill=colour, crisp=True) for colour, paths in alike.items()]


def mark(at: Sequence[tuple[float, float]], colour: str, marker: Marker = "dot", size: float = 4) -> Mark:
    """Return marks around points [px]."""
    if marker == "dot":
        return Dots(at, colour, size)
    if marker == "cross":
        strokes = [[(x - size, y - size), (x + size, y + size)] for x, y in at]
        return Outline([*strokes, *[[(x - size, y + size), (x + size, y - size)] for x, y in at]], colour, 2)
    corners = 3 if marker == "triangle" else 4
    start = np.pi / 4 if marker == "square" else np.pi / 2
    angle = start + 2 * np.pi * np.arange(corners) / corners
    outline = list(zip((size * np.cos(angle)).tolist(), (-size * np.sin(angle)).tolist(), strict=True))
    return Outline([[(x + a, y + b) for a, b in outline] for x, y in at], fill=colour)
