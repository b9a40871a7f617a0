"""What the passes could not have missed: the smallest error each would have caught."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.reports.pictures import EXPECTED, OBSERVED, THIRD
from fogproof.reports.text import label

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

_NAMED = 48


@dataclass(frozen=True)
class Resolutions:
    """One (case name, kind of error, smallest error caught) for each pass that states one."""

    passes: tuple[tuple[str, str, float], ...]

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [inch]: a line for each named case."""
        return 5.6, 0.9 + 0.2 * min(len(self.passes), _NAMED) + 0.22 * len(self._kinds)

    @property
    def _kinds(self) -> list[str]:
        return sorted({kind for _, kind, _ in self.passes})

    def draw(self, figure: Figure) -> str:
        """Draw one mark a pass, sorted by kind and value, a colour and shape for each kind; names while they fit."""
        kinds = self._kinds
        rows = sorted(self.passes, key=lambda row: (kinds.index(row[1]), row[2]))
        named = len(rows) <= _NAMED
        height = self.size[1]
        axes = figure.add_axes(
            (0.42 if named else 0.09, 0.62 / height, 0.54 if named else 0.87, 1 - (0.75 + 0.22 * len(kinds)) / height)
        )
        looks = [(OBSERVED, "o"), (EXPECTED, "s"), (THIRD, "^"), (OBSERVED, "x"), (EXPECTED, "+")]
        marks: list[Line2D] = []
        for index, kind in enumerate(kinds):
            colour, marker = looks[index % len(looks)]
            at = [(value, y) for y, (_, its_kind, value) in enumerate(rows) if its_kind == kind]
            marks += axes.plot(*np.transpose(at), marker, color=colour, markersize=5)
        if named:
            axes.set_yticks(range(len(rows)), [label(name, 30) for name, _, _ in rows], fontsize=9)
        else:
            axes.set_ylabel("passes, sorted")
        axes.set_ylim(len(rows) - 0.4, -0.6)
        axes.set_xscale("log")
        axes.set_xlabel("smallest error that would have been caught", x=0.3 if named else 0.5)
        names = [label(kind, 60) for kind in kinds]
        figure.legend(marks, names, loc="upper left", borderaxespad=0.1, handletextpad=0.2, labelspacing=0.3)
        values = [value for _, _, value in rows]
        named_kinds = ", ".join(label(kind) for kind in kinds)
        return (
            f"{len(rows)} passes: errors above {min(values):.2g} to {max(values):.2g} ({named_kinds}) would have shown."
        )
