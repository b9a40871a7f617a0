"""Observed shares against expected probabilities of the bins of one coordinate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.reports.pictures import EXPECTED, OBSERVED
from fogproof.reports.text import label

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Bins:
    """`edges` (n + 1,) never fall and may end in +-inf; `expected`, `observed` (n,) are probabilities and shares."""

    edges: tuple[float, ...]
    label: str
    expected: tuple[float, ...]
    observed: tuple[float, ...]

    def __post_init__(self) -> None:
        n = len(self.edges) - 1
        for name in ("expected", "observed"):
            got = len(getattr(self, name))
            if n < 1 or got != n:
                raise InvalidValueError(name, f"must have one number for each of the {max(n, 0)} bins", got)

    def draw(self, figure: Figure) -> str:
        """Draw densities above and the relative misfit of each bin below.

        An open outer bin is drawn as wide as its neighbour. Bins without width (atoms) leave no density to draw: then
        the shares stand over the number of the bin.
        """
        edges, opened = closed(np.array(self.edges))
        expected, observed = np.array(self.expected), np.array(self.observed)
        width = np.diff(edges)
        if np.all(np.isfinite(width) & (width > 0)):
            across = label(self.label) + (" (the outermost bin is open)" if opened else "")
            what = f"density over {label(self.label.partition('[')[0])}"
        else:
            edges, width = np.arange(edges.size) - 0.5, np.ones(expected.size)
            across, what = f"number of the bin of {label(self.label)}", "share"
        low = figure.add_axes((0.15, 0.16, 0.83, 0.23))
        top = figure.add_axes((0.15, 0.44, 0.83, 0.53), sharex=low)
        top.tick_params(labelbottom=False)
        top.stairs(observed / width, edges, fill=True, color=OBSERVED, alpha=0.35)
        top.stairs(observed / width, edges, color=OBSERVED, label="observed")
        top.stairs(expected / width, edges, color=EXPECTED, linestyle="--", label="expected")
        top.set_ylim(bottom=0)
        top.set_ylabel(what)
        top.legend(loc="upper right")
        with np.errstate(divide="ignore", invalid="ignore"):
            misfit = np.where(expected > 0, observed / expected - 1, np.nan)
        low.axhline(0, color=EXPECTED, linestyle="--")
        low.stairs(100 * misfit, edges, color=OBSERVED, baseline=None)
        reach = np.nanmax(np.abs(100 * misfit), initial=0)
        low.set_ylim(*(np.array([-1.15, 1.15]) * (reach or 1)))
        low.set_ylabel("misfit [%]")
        low.set_xlabel(across)
        top.locator_params("y", nbins=5)
        low.locator_params("y", nbins=3)
        worst = int(np.argmax(np.abs(observed - expected)))
        return (
            f"Observed shares of {expected.size} bins of {label(self.label)} against their probabilities; the largest "
            f"difference is {observed[worst] - expected[worst]:+.2g} in the bin from {self.edges[worst]:.4g} to "
            f"{self.edges[worst + 1]:.4g} (expected {expected[worst]:.3g})."
        )


def closed(edges: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return `edges` with an infinite outer one moved to a bin's width from its neighbour, and if there was one."""
    edges = edges.copy()
    ends = [(0, 1, 2), (-1, -2, -3)]
    opened = [end for end in ends if np.isinf(edges[end[0]])]
    for end, first, second in opened:
        step = edges[first] - edges[second] if edges.size > 2 and np.isfinite(edges[second]) else 0.0
        edges[end] = edges[first] + (step or np.sign(edges[end]))
    return edges, bool(opened)
