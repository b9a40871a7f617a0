"""How estimators near the reference: error over samples, over steps, or over time, both logarithmic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.reports.charts.axes import DASHED, Axes, Key, Marker, legend, spanning
from fogproof.reports.charts.colours import EXPECTED, FIFTH, FOURTH, INK, OBSERVED, SIXTH, THIRD
from fogproof.reports.charts.sheet import FONT_SIZE, Sheet
from fogproof.reports.text import label

_COLOURS = (OBSERVED, EXPECTED, THIRD, FOURTH, FIFTH, SIXTH)
_MARKERS: tuple[Marker, ...] = ("dot", "square", "triangle", "diamond", "cross")
_DOTTED = (2.0, 3.0)


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
    """Curves of one scene. `across` labels the effort, `up` the error, with units; `slope` is drawn for comparison, 0: none."""

    across: str
    up: str
    curves: tuple[ErrorCurve, ...]
    confidence: float
    slope: float = -0.5

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [px]: a line of the legend for each curve."""
        return 560.0, 330.0 + 1.4 * FONT_SIZE * (len(self.curves) + 2)

    def draw(self, sheet: Sheet) -> str:
        """Draw each curve with its confidence band, the oracle's prediction dotted, and a line of the expected slope."""
        keys = [Key(label(c.name, 62), *_look(c.look), DASHED if c.dashed else None, joined=True) for c in self.curves]
        known = any(np.isfinite(curve.predicted).any() for curve in self.curves)
        keys += [Key("predicted by the oracle", INK, dash=_DOTTED)] if known else []
        keys += [Key(f"slope −{abs(self.slope):g}", INK, dash=(9, 5))] if self.slope else []
        y = 0.0
        for key in keys:
            y += legend(sheet, [key], 20, y, sheet.width) - 0.3 * FONT_SIZE
        every = [np.array(values) for c in self.curves for values in (c.error, c.predicted)]
        across = spanning(np.concatenate([np.array(c.effort) for c in self.curves]), log=True)
        up = spanning(np.concatenate(every), log=True, margin=0.08)
        axes = Axes(sheet, (92, y + 8, sheet.width - 108, sheet.height - y - 58), across, up)
        axes.frame(self.across, self.up)
        for curve in self.curves:
            axes.band(curve.effort, np.maximum(curve.low, up.low), curve.high, _look(curve.look)[0], 0.12)
        for curve in self.curves:
            colour, marker = _look(curve.look)
            axes.line(curve.effort, curve.predicted, colour, _DOTTED)
            axes.line(curve.effort, curve.error, colour, DASHED if curve.dashed else None)
            axes.points(curve.effort, curve.error, colour, marker)
        if self.slope:
            start = max(float(np.nanmax(c.error)) for c in self.curves)
            ends = np.array([across.low, across.high])
            axes.line(ends, 1.3 * start * (ends / across.low) ** self.slope, INK, (9, 5), 1)
        return self._words()

    def _words(self) -> str:
        lowest = min(self.curves, key=lambda curve: curve.error[-1])
        where = self.across.partition(" [")[0]
        return (
            f"Error over {where} of {len(self.curves)} estimators, both logarithmic, with {self.confidence:.0%} confidence bands. "
            f"The lowest at its end is {label(lowest.name, 60)}: {lowest.error[-1]:.2g}."
        )


def _look(number: int) -> tuple[str, Any]:
    return _COLOURS[number % len(_COLOURS)], _MARKERS[number % len(_MARKERS)]
