"""How estimators near the reference: error over samples, over steps, or over time, both logarithmic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fogproof.reports.charts.axes import DASHED, Axes, Marker
from fogproof.reports.charts.colours import EXPECTED, FIFTH, FOURTH, GRID, INK, OBSERVED, SIXTH, THIRD
from fogproof.reports.charts.direct_labels import EndLabel, height_of, write_labels
from fogproof.reports.charts.scale import Scale, spanning
from fogproof.reports.charts.sheet import FONT_SIZE, Sheet
from fogproof.reports.charts.sheet_png import text_width
from fogproof.reports.text import label

_COLOURS = (OBSERVED, EXPECTED, THIRD, FOURTH, FIFTH, SIXTH)
_MARKERS: tuple[Marker, ...] = ("dot", "square", "triangle", "diamond", "cross")
_DOTTED = (2.0, 3.0)
_LOWEST = 3e-6
"""Relative errors below are nobody's question, and would flatten all others; their curves leave the picture."""
_LEAST = 10.0
"""The factor that errors span in a picture at least."""
_DEPTH = 1e3
"""How far below the largest error a picture shows in any case."""
_LETTERS = 28
"""In a line of a curve's name."""
_SIDE = 258.0
_NAMED = 6
"""Curves that keep their colour and name in a crowd: more colours than these nobody tells apart."""
_CROWD = 13
"""So many curves are one."""


@dataclass(frozen=True)
class ErrorCurve:
    """One estimator: `error` in [low, high] after `effort` samples, steps or seconds; `predicted` is the oracle's, NaN if unknown.

    look    number of its colour and mark; a curve and its relatives share one
    dashed  whether it is a relative: Sobol points, marching
    """

    name: str
    look: int
    effort: tuple[float, ...]
    error: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    predicted: tuple[float, ...]
    dashed: bool = False


@dataclass(frozen=True)
class Convergence:
    """Curves of one scene. `across` labels the effort, `up` the error, with units; `slope` is drawn for comparison, 0: none.

    errorless  names of what has no error at all, which no logarithm shows
    """

    across: str
    up: str
    curves: tuple[ErrorCurve, ...]
    confidence: float
    slope: float = 0.0
    errorless: tuple[str, ...] = ()

    HOW: ClassVar[str] = (
        "Lower is better, and further left is sooner. Choose the error you can live with on the left, follow it to "
        "the right: the curve met first is the estimator to take. A curve of slope one half needs a hundred times the "
        "samples for a tenth of the error. The band around a curve holds the truth; where bands overlap, the data do "
        "not tell. Dashed: Sobol points, or steps of a march in place of random samples. Dotted: what the oracle "
        "predicts. A curve that becomes level has a bias, which no time takes away, or is at rounding; one that jumps has "
        "a heavy tail. Of many curves the few with the least squared error times effort at their end are named, all "
        "others grey."
    )

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [px]: room for the names beside the curves."""
        return 700.0, max(380.0, 70.0 + height_of([curve.name for curve in self._named()], _LETTERS))

    def _named(self) -> tuple[ErrorCurve, ...]:
        """Return the curves that keep their names: all, or the best of a crowd."""
        if len(self.curves) < _CROWD:
            return self.curves
        best = sorted(self.curves, key=lambda curve: curve.error[-1] ** 2 * curve.effort[-1])[:_NAMED]
        return tuple(curve for curve in self.curves if curve in best)

    def draw(self, sheet: Sheet) -> str:
        """Draw each curve with its confidence band and name, the oracle's prediction dotted, and a line of the expected slope."""
        across = spanning(np.concatenate([np.array(c.effort) for c in self.curves]), log=True)
        every = np.concatenate([np.array(c.error) for c in self.curves])
        up = _room(spanning(np.maximum(every, min(_LOWEST, every.max() / _DEPTH)), log=True, margin=0.08))
        right, bottom = sheet.width - _SIDE, sheet.height - 50
        left = max(84.0, 38 + max((text_width(name, FONT_SIZE) for _, name in up.ticks(5)), default=0))
        axes = Axes(sheet, (left, 10, right - left, bottom - 10), across, up)
        axes.frame(self.across, self.up)
        named = self._named()
        for curve in self.curves:
            if curve not in named:
                axes.line(curve.effort, curve.error, GRID, DASHED if curve.dashed else None, 1.5)
        for curve in named:
            opacity = 0.12 * min(1.0, 3 / len(named))  # bands that lie on each other add up
            axes.band(curve.effort, np.maximum(curve.low, up.low), curve.high, _look(curve.look)[0], opacity)
        for curve in named:
            colour, marker = _look(curve.look)
            axes.line(curve.effort, curve.predicted, colour, _DOTTED)
            axes.line(curve.effort, curve.error, colour, DASHED if curve.dashed else None)
            axes.points(curve.effort, curve.error, colour, marker)
        if self.slope:
            start = max(float(np.nanmax(c.error)) for c in self.curves)
            ends = np.array([across.low, across.high])
            axes.line(ends, 1.3 * start * (ends / across.low) ** self.slope, INK, (9, 5), 1)
        labels = [_end_of(curve, axes, up) for curve in named]
        write_labels(sheet, labels, right, 4, bottom + FONT_SIZE, _LETTERS)
        return self._words(up.low)

    def _words(self, floor: float) -> str:
        lowest = min(self.curves, key=lambda curve: curve.error[-1])
        where = self.across.partition(" [")[0]
        guide = f" The long dashes fall with the power {self.slope:g}." if self.slope else ""
        grey = (
            f" The {len(self.curves) - len(self._named())} others are grey."
            if len(self._named()) < len(self.curves)
            else ""
        )
        n, lowest_at = len(self.curves), f"{label(lowest.name, 90)}: {lowest.error[-1]:.2g}"
        missing = f" Without any error, and so not drawn: {', '.join(label(name, 90) for name in self.errorless)}."
        under = [f"{label(c.name, 90)}, down to {min(c.error):.2g}" for c in self.curves if min(c.error) < floor]
        below = f" Below the picture, where an arrow points: {'; '.join(under)}." if under else ""
        return (
            f"Error over {where} of {n} estimator{'' if n == 1 else 's'}, both logarithmic, with {self.confidence:.0%} confidence"
            f" bands. The lowest at its end is {lowest_at}.{grey}{guide}{below}{missing if self.errorless else ''}"
        )


def _room(scale: Scale) -> Scale:
    """Return a scale of errors that spans a factor `_LEAST` at least: less makes noise of a thousandth look like a fall."""
    more = max(1.0, np.sqrt(_LEAST * scale.low / scale.high))
    return Scale(float(scale.low / more), float(scale.high * more), True)


def _end_of(curve: ErrorCurve, axes: Axes, up: Scale) -> EndLabel:
    """Return the name of a curve, tied to its last point that can be seen, or to where it leaves the picture."""
    x, y = np.log(np.array(curve.effort)), np.log(np.array(curve.error))
    floor, below = np.log(up.low), np.flatnonzero(np.array(curve.error) < up.low)
    at = x[-1], y[-1]
    if len(below):
        k = int(below[0])
        share = 0.0 if k == 0 else (y[k - 1] - floor) / (y[k - 1] - y[k])
        at = (x[0], floor) if k == 0 else (x[k - 1] + share * (x[k] - x[k - 1]), floor)
    colour, marker = _look(curve.look)
    (end,) = axes.at([float(np.exp(at[0]))], [float(np.exp(at[1]))])
    name = label(curve.name, 90) + (" ↓" if len(below) else "")
    return EndLabel(name, colour, end, marker, DASHED if curve.dashed else None)


def _look(number: int) -> tuple[str, Any]:
    return _COLOURS[number % len(_COLOURS)], _MARKERS[number % len(_MARKERS)]
