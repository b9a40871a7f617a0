"""Where on two coordinates a sampler puts too much or too little."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.reports.charts.axes import Axes
from fogproof.reports.charts.bins import closed
from fogproof.reports.charts.colours import diverging
from fogproof.reports.charts.scale import Scale
from fogproof.reports.charts.sheet import Sheet
from fogproof.reports.text import label


@dataclass(frozen=True)
class ZMap:
    """`z` (n, m) is (observed - expected)/sigma of each cell; `edges` (n + 1,) and (m + 1,) bound them."""

    edges: tuple[tuple[float, ...], tuple[float, ...]]
    labels: tuple[str, str]
    z: tuple[tuple[float, ...], ...]

    HOW: ClassVar[str] = (
        "The domain cut into cells. Red: more samples fell there than the pdf says; blue: fewer. A right sampler "
        "gives pale speckles without shape; a stripe, a ramp or a patch is an error, and its shape says of what kind."
    )

    def __post_init__(self) -> None:
        n, m = (len(axis) - 1 for axis in self.edges)
        shape = [len(self.z), sorted({len(row) for row in self.z})]
        if n < 1 or m < 1 or shape != [n, [m]]:
            raise InvalidValueError("z", f"must have {n} rows of {m} cells, as its edges say", shape)

    def draw(self, sheet: Sheet) -> str:
        """Draw the map: blue too few, red too many, colours ending at the largest |z| and not below 5."""
        z = np.array(self.z)
        known = np.abs(z[np.isfinite(z)])
        reach = max(5.0, float(known.max(initial=0)))
        grid = [_increasing(np.array(axis)) for axis in self.edges]
        x, y = (Scale(float(axis[0]), float(axis[-1])) for axis in grid)
        low, high, height = 70.0, sheet.width - 190, sheet.height - 64
        axes = Axes(sheet, (low, 10, high, height), x, y)
        axes.frame(label(self.labels[0]), label(self.labels[1]), rules=False)
        axes.cells((grid[0], grid[1]), [[diverging(value / reach) for value in column] for column in z.tolist()])
        bar = Axes(sheet, (low + high + 22, 10, 16, height), Scale(0, 1), Scale(-reach, reach))
        shades = np.linspace(-reach, reach, 42)
        bar.cells(((0, 1), shades), [[diverging(value) for value in np.linspace(-1, 1, 41)]])
        bar.colour_scale("z = (observed − expected) / σ")
        if not known.size:
            return f"z of {z.size} cells over {label(self.labels[0])} and {label(self.labels[1])}; none is finite."
        i, j = np.unravel_index(int(np.argmax(np.where(np.isfinite(z), np.abs(z), -1))), z.shape)
        place = " and ".join(
            f"{label(name)} from {axis[k]:.3g} to {axis[k + 1]:.3g}"
            for name, axis, k in zip(self.labels, self.edges, (i, j), strict=True)
        )
        over = np.mean(known > 3)
        return (
            f"Misfit of {z.size} cells in standard deviations; the largest is {z[i, j]:+.3g} at {place}; "
            f"{over:.1%} of the cells lie beyond 3, where chance puts about 0.3%."
        )


def _increasing(edges: np.ndarray) -> np.ndarray:
    """Return edges fit to draw: open ends closed, and the cell's number where cells have no width."""
    edges, _ = closed(edges)
    return edges if np.all(np.isfinite(edges)) and np.all(np.diff(edges) > 0) else np.arange(edges.size) - 0.5
