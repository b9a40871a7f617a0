"""All p-values that are uniform for right subjects: their histogram, and one by one against the uniform distribution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.reports.charts.axes import DASHED, Axes, Marker
from fogproof.reports.charts.colours import EXPECTED, GRID, OBSERVED
from fogproof.reports.charts.legend import Key, legend
from fogproof.reports.charts.scale import Scale
from fogproof.reports.charts.sheet import Sheet
from fogproof.text import p_value


@dataclass(frozen=True)
class PValues:
    """`p` are exact p-values of findings, in any order."""

    p: tuple[float, ...]

    HOW: ClassVar[str] = (
        "Each p-value, the smallest at the left, against where it should lie if every subject is right: on the dashed "
        "line, within the grey band. Points below the band are smaller than chance makes them; look at the smallest "
        "first."
    )

    def draw(self, sheet: Sheet) -> str:
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
        keys = [Key("99.9% of right subjects", GRID, "area"), Key("uniform", EXPECTED, dash=DASHED)]
        marks: list[tuple[np.ndarray, Marker, str]] = [
            (inside, "dot", "observed"),
            (~inside & ~tiny, "cross", "outside"),
            (tiny, "triangle", f"below {floor:.0e}"),
        ]
        marks = [one for one in marks if one[0].any()]
        keys += [Key(name, OBSERVED, marker) for _, marker, name in marks]
        top = legend(sheet, keys, 20, 0, sheet.width - 20) + 4
        lowest = max(floor, min(float(low[0]), float(p[0])))
        x, y = Scale(middle[0] / 1.3, 1.1, True), Scale(lowest / 2, 1.5, True)
        axes = Axes(sheet, (78, top, sheet.width - 92, sheet.height - top - 50), x, y)
        axes.frame("expected p-value of this rank", "p-value")
        axes.band(middle, low, high, GRID, 1)
        axes.line(middle, middle, EXPECTED, DASHED)
        for where, marker, _ in marks:
            axes.points(middle[where], np.maximum(p[where], floor), OBSERVED, marker, 3 if marker == "dot" else 5)
        return (
            f"{n} p-values that are uniform for right subjects, sorted, against their expectation; the smallest is "
            f"{p_value(min(self.p), 2)}; {int(np.sum(~inside))} lie outside the range that holds each with probability 99.9%."
        )


FEWEST = 10
"""Fewer p-values make no histogram."""
_A_BIN = 4
"""P-values that are expected in each bin, if they are enough."""


@dataclass(frozen=True)
class PValueHistogram:
    """How many of the exact p-values fall into each part of [0, 1]: a twentieth, or more where they are few."""

    p: tuple[float, ...]

    HOW: ClassVar[str] = (
        "If every subject is right, all p-values are equally likely and the bars are level, but for chance: the grey "
        "band. A high bar at the left means that something is wrong, even where no single check was sure. A slope to "
        "the right means that checks are duller than they say."
    )

    def draw(self, sheet: Sheet) -> str:
        """Draw the counts, and the range that holds each with probability 99.9% if all subjects are right: binomial."""
        from scipy.special import bdtrik

        n = len(self.p)
        bins = next((bins for bins in (20, 10) if n >= _A_BIN * bins), 5)
        share = 1 / bins
        counts, edges = np.histogram(self.p, bins, (0.0, 1.0))
        low, high = (float(np.ceil(max(bdtrik(q, n, share), 0.0))) for q in (0.0005, 0.9995))
        keys = [Key("observed", OBSERVED, "area"), Key("expected", EXPECTED, dash=DASHED)]
        top = legend(sheet, [*keys, Key("99.9% of right subjects", GRID, "area")], 20, 0, sheet.width - 20) + 4
        y = Scale(0, 1.08 * max(high, float(counts.max()), 1.0), whole=True)
        axes = Axes(sheet, (64, top, sheet.width - 80, sheet.height - top - 50), Scale(0, 1), y)
        axes.frame("p-value", "findings")
        axes.band([0, 1], [low, low], [high, high], GRID, 1)
        axes.stairs(counts, edges, OBSERVED, fill=True)
        axes.line([0, 1], [n * share, n * share], EXPECTED, DASHED)
        outside = int(np.sum((counts < low) | (counts > high)))
        lie = "1 bin lies" if outside == 1 else f"{outside} bins lie"
        return (
            f"Histogram of {n} p-values that are uniform for right subjects: {n * share:.1f} are expected in each of {bins} "
            f"bins, {counts.min()} to {counts.max()} are there; {lie} outside the range of 99.9%."
        )
