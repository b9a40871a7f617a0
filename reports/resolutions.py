"""What the passes could not have missed: the smallest error each would have caught."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.reports.axes import Axes, Key, Marker, Scale, legend, spanning
from fogproof.reports.colours import EXPECTED, OBSERVED, THIRD
from fogproof.reports.sheet import Sheet
from fogproof.reports.text import label

_NAMED = 48


@dataclass(frozen=True)
class Resolutions:
    """One (case name, kind of error, smallest error caught) for each pass that states one."""

    passes: tuple[tuple[str, str, float], ...]

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [px]: a line for each named case."""
        return 560.0, 90.0 + 20 * min(len(self.passes), _NAMED) + 20 * len(self._kinds)

    @property
    def _kinds(self) -> list[str]:
        return sorted({kind for _, kind, _ in self.passes})

    def draw(self, sheet: Sheet) -> str:
        """Draw one mark a pass, sorted by kind and value, a colour and shape for each kind; names while they fit."""
        kinds = self._kinds
        rows = sorted(self.passes, key=lambda row: (kinds.index(row[1]), row[2]))
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
        keys = [Key(label(kind, 60), *chosen[kind]) for kind in kinds]
        top = legend(sheet, keys, 8, 0, sheet.width - 8) + 4
        left = 0.42 * sheet.width if named else 46.0
        x = spanning([value for _, _, value in rows], log=True)
        axes = Axes(sheet, (left, top, sheet.width - left - 20, sheet.height - top - 50), x, Scale(len(rows), -1))
        axes.frame("smallest error that would have been caught", "" if named else "passes, sorted", (6, 0))
        for kind in kinds:
            at = np.array([(value, y) for y, (_, its_kind, value) in enumerate(rows) if its_kind == kind])
            axes.points(at[:, 0], at[:, 1], *chosen[kind])
        if named:
            axes.names([label(name, 30) for name, _, _ in rows])
        values = [value for _, _, value in rows]
        named_kinds = ", ".join(label(kind) for kind in kinds)
        return (
            f"{len(rows)} passes: errors above {min(values):.2g} to {max(values):.2g} ({named_kinds}) would have shown."
        )
