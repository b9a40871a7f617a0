"""All p-values that are uniform for right subjects, against the uniform distribution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fogproof.reports.pictures import EXPECTED, GRID, OBSERVED

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PValues:
    """`p` are exact p-values of findings, in any order."""

    p: tuple[float, ...]

    def draw(self, figure: Figure) -> str:
        """Draw sorted p-values over their expectation i/(n + 1), both logarithmic, with 99.9% of each rank's range.

        The i-th smallest of n uniform numbers follows the Beta(i, n - i + 1) distribution.
        """
        from scipy.special import betaincinv

        n = len(self.p)
        rank = np.arange(1, n + 1)
        middle = rank / (n + 1)
        low, high = (betaincinv(rank, n - rank + 1, q) for q in (0.0005, 0.9995))
        floor = low[0] / 100
        p = np.sort(self.p)
        inside, tiny = (p >= low) & (p <= high), p < floor
        axes = figure.add_axes((0.17, 0.15, 0.80, 0.74))
        axes.fill_between(middle, low, high, color=GRID, linewidth=0, label="99.9% of right subjects")
        axes.plot(middle, middle, color=EXPECTED, linestyle="--", label="uniform")
        looks: Any = {"markersize": 7, "markeredgewidth": 2, "linestyle": "none", "color": OBSERVED}
        for where, marker, name in (
            (inside, ".", "observed"),
            (~inside & ~tiny, "x", "outside"),
            (tiny, "v", f"below {floor:.0e}"),
        ):
            if where.any():
                axes.plot(middle[where], np.maximum(p[where], floor), marker=marker, label=name, **looks)
        axes.set(xscale="log", yscale="log", xlabel="expected p-value of this rank", ylabel="p-value")
        axes.set_ylim(floor / 2, 1.5)
        axes.legend(loc="best", borderaxespad=0.4)
        return (
            f"{n} p-values that are uniform for right subjects, sorted, against their expectation; the smallest is "
            f"{min(self.p):.2g}; {int(np.sum(~inside))} lie outside the range that holds each with probability 99.9%."
        )
