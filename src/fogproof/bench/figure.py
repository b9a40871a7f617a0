"""The time-error plane: a point for each way, the front through those that none beats in both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fogproof.bench.measuring import WayTime
from fogproof.reports.charts.colours import EXPECTED, INK, OBSERVED

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SMALLEST = 1e-17
"""Errors of 0, and less than this, are drawn here."""


@dataclass(frozen=True)
class TimeErrorPlane:
    """Error over time of the ways of one benchmark."""

    title: str
    rows: tuple[WayTime, ...]

    def draw(self, figure: Figure) -> str:
        """Draw it."""
        axes: Any = figure.add_axes((0.14, 0.16, 0.82, 0.74))
        points = [
            (row.median * 1e6, max(row.error or 0.0, SMALLEST), row) for row in self.rows if row.error is not None
        ]
        front = sorted((time, error) for time, error, row in points if row.front)
        axes.plot(*zip(*front, strict=True), color=EXPECTED, linestyle="--", drawstyle="steps-post")
        for time, error, row in points:
            axes.plot([time], [error], marker="o", color=OBSERVED if row.front else INK)
            axes.annotate(row.way, (time, error), textcoords="offset points", xytext=(6, 4), fontsize=9)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel(f"time of the processor per {self.rows[0].unit} [us]")
        axes.set_ylabel("relative error, median")
        axes.margins(0.18)
        figure.text(0.14, 0.93, self.title, fontsize=11)
        best = ", ".join(row.way for _, _, row in points if row.front)
        return f"{self.title}: relative error over time per {self.rows[0].unit}; none is both faster and more accurate than {best}."


def drawable(rows: tuple[WayTime, ...]) -> bool:
    """Return whether there is a plane to draw: two ways with an error."""
    return sum(row.error is not None for row in rows) > 1
