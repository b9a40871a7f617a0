"""One number of every case in two runs, one against the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.reports.pictures import EXPECTED, GRID, OBSERVED
from fogproof.reports.text import label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_NAMED = 3


@dataclass(frozen=True)
class BeforeAfter:
    """`what` [unit] was `before` and is `after` for the case of that name; all numbers are positive."""

    what: str
    names: tuple[str, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]

    def draw(self, figure: Figure) -> str:
        """Draw after over before, both logarithmic, with the factor of two around no change; name what lies far out."""
        before, after = np.array(self.before), np.array(self.after)
        ratio = after / before
        axes = figure.add_axes((0.16, 0.15, 0.81, 0.82))
        both = np.concatenate([before, after])
        ends = np.array([both.min() / 1.5, both.max() * 1.5])
        axes.fill_between(ends, ends / 2, ends * 2, color=GRID, alpha=0.6, linewidth=0, label="within a factor of 2")
        axes.plot(ends, ends, color=EXPECTED, linestyle="--", label="no change")
        axes.plot(before, after, "o", color=OBSERVED, markersize=5, label="a case")
        axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
        axes.set_xlabel(f"{self.what}, before")
        axes.set_ylabel(f"{self.what}, after")
        far = np.argsort(-np.abs(np.log(ratio)), kind="stable")[:_NAMED]
        for index in far[np.abs(np.log2(ratio[far])) > 1]:
            axes.annotate(
                label(self.names[index], 24),
                (before[index], after[index]),
                textcoords="offset points",
                xytext=(6, 4) if before[index] < np.sqrt(ends.prod()) else (-6, 4),
                ha="left" if before[index] < np.sqrt(ends.prod()) else "right",
                fontsize=9,
            )
        axes.legend(loc="best")
        middle = float(np.exp(np.median(np.log(ratio))))
        return (
            f"{self.what} of {ratio.size} cases after against before: the middle ratio is {middle:.2f}, the smallest "
            f"{ratio.min():.2g}, the largest {ratio.max():.2g}."
        )
