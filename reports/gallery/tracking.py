"""A picture of delta tracking: where it looks, and which of its tentative collisions are real."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.analytic import transmittance
from fogproof.estimators import DeltaFreePath
from fogproof.reports.charts.colours import EXPECTED, GRID, INK, OBSERVED
from fogproof.scene import Procedural, Ray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LENGTH, _MAJORANT = 6.0, 1.2


def _extinction(points: np.ndarray) -> np.ndarray:
    """Return a thin haze with two puffs of smoke on the way [1/m]."""
    z = points[..., 2]
    return 0.08 + 0.95 * np.exp(-(((z - 1.8) / 0.45) ** 2)) + 0.8 * np.exp(-(((z - 4.4) / 0.25) ** 2))


@dataclass(frozen=True)
class Collisions:
    """Tentative and real collisions of delta tracking along a ray through two puffs of smoke."""

    rng: np.random.Generator
    paths: int = 20_000
    shown: int = 14

    def draw(self, figure: Figure) -> str:
        """Draw both densities over the distance, the oracle's curves on top, and below some paths one by one.

        Whoever looks at the medium comes by its array function, which notes the places.
        """
        seen: list[np.ndarray] = []

        def noted(points: np.ndarray) -> np.ndarray:
            seen.append(points[..., 2].ravel())
            return _extinction(points)

        ray = Ray([0, 0, 0], [0, 0, 1], _LENGTH)
        tracker = DeltaFreePath(Procedural(noted, _MAJORANT, detail=0.05), ray)
        tracker.sample(self.rng, 1)  # what is prepared once looks at the medium, too
        paths: list[tuple[np.ndarray, bool]] = []
        for _ in range(self.shown):
            seen.clear()
            end = float(tracker.sample(self.rng, 1).x[0])
            paths.append((np.concatenate([*seen, np.empty(0)]), end < _LENGTH))
        seen.clear()
        drawn = tracker.sample(self.rng, self.paths)
        tentative, real = np.concatenate(seen), drawn.x[drawn.x < _LENGTH]

        edges = np.linspace(0, _LENGTH, 61)
        each = self.paths * np.diff(edges)
        z = np.linspace(0.001, _LENGTH, 400)
        reached = transmittance(Procedural(_extinction, _MAJORANT, detail=0.05), Ray([0, 0, 0], [0, 0, 1], z)).value
        sigma = _extinction(np.stack([0 * z, 0 * z, z], axis=-1))
        low = figure.add_axes((0.11, 0.14, 0.86, 0.30))
        top = figure.add_axes((0.11, 0.50, 0.86, 0.47), sharex=low)
        top.stairs(np.histogram(tentative, edges)[0] / each, edges, fill=True, color=GRID, label="tentative")
        top.stairs(np.histogram(real, edges)[0] / each, edges, fill=True, color=OBSERVED, alpha=0.5, label="real")
        top.plot(z, _MAJORANT * reached, color=INK, linestyle="--", label="majorant × T, by the oracle")
        top.plot(z, sigma * reached, color=EXPECTED, label="sigma_t × T, by the oracle")
        top.set_ylabel("collisions [1/m]")
        top.set_ylim(0, 1.3)
        top.tick_params(labelbottom=False)
        top.legend(loc="upper right", fontsize=9)
        for row, (places, hit) in enumerate(paths):
            null = places[:-1] if hit else places
            low.plot([0, places[-1] if hit else _LENGTH], [row, row], color=GRID, linewidth=1)
            low.plot(null, np.full(null.size, row), "o", color=INK, markerfacecolor="none", markersize=4)
            if hit:
                low.plot(places[-1], row, "o", color=OBSERVED, markersize=5)
        low.set(xlabel="distance [m]", ylabel="path", yticks=[], ylim=(-0.8, self.shown - 0.2), xlim=(0, _LENGTH))
        low.grid(False)
        return (
            f"Delta tracking through two puffs of smoke under a majorant of {_MAJORANT:g} 1/m. Above: {tentative.size} tentative "
            f"and {real.size} real collisions of {self.paths} paths, with the oracle's densities. Below: {self.shown} paths; "
            f"hollow marks are tentative collisions that were taken back, full ones are real. {tentative.size / self.paths:.2f} "
            "look-ups a path."
        )
