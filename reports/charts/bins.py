"""Observed shares against expected probabilities of the bins of one coordinate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.reports.charts.axes import DASHED, Axes
from fogproof.reports.charts.colours import EXPECTED, OBSERVED
from fogproof.reports.charts.legend import Key, legend
from fogproof.reports.charts.scale import Scale
from fogproof.reports.charts.sheet import Sheet
from fogproof.reports.text import label

ENDLESS = 1e300  # edges beyond are those of numbers, not of a domain
FAR = 10  # an outer bin so many times as wide as all inner ones together is drawn as if it were open
WIDEST = 100  # where the range is so many times as wide as all bins would be, were they like the median one, no axis shows them


@dataclass(frozen=True)
class Bins:
    """`edges` (n + 1,) never fall and may end in +-inf; `expected`, `observed` (n,) are probabilities and shares."""

    edges: tuple[float, ...]
    label: str
    expected: tuple[float, ...]
    observed: tuple[float, ...]

    HOW: ClassVar[str] = (
        "Above: how often samples fell into each bin, against what the pdf says. Where the two part, the sampler "
        "draws too many or too few. Below: the same as a relative misfit. Of n samples, chance explains about "
        "2/sqrt(n p) of it in a bin of probability p; a step beyond that is a place to look at."
    )

    def __post_init__(self) -> None:
        n = len(self.edges) - 1
        for name in ("expected", "observed"):
            got = len(getattr(self, name))
            if n < 1 or got != n:
                raise InvalidValueError(name, f"must have one number for each of the {max(n, 0)} bins", got)

    def draw(self, sheet: Sheet) -> str:
        """Draw densities above and the relative misfit of each bin below.

        An open outer bin is drawn as wide as its neighbour. Bins without width (atoms), or of widths that no axis can
        show together, leave no density to draw: then the shares stand over the number of the bin.
        """
        edges, opened = closed(np.array(self.edges))
        expected, observed = np.array(self.expected), np.array(self.observed)
        width = np.diff(edges)
        if np.all(np.isfinite(width) & (width > 0)) and width.sum() < WIDEST * width.size * np.median(width):
            across = label(self.label) + (" (the outermost bin is open)" if opened else "")
            what = "density"
        else:
            edges, width = np.arange(edges.size) - 0.5, np.ones(expected.size)
            across, what = f"number of the bin of {label(self.label)}", "share"
        with np.errstate(divide="ignore", invalid="ignore"):
            misfit = np.where(expected > 0, 100 * (observed / expected - 1), np.nan)
        keys = [Key("observed", OBSERVED, "area"), Key("expected", EXPECTED, dash=DASHED)]
        left, right = 76.0, sheet.width - 90
        top = legend(sheet, keys, left, 0, right) + 4
        x, middle = Scale(float(edges[0]), float(edges[-1])), 0.62 * sheet.height
        high = np.append(observed, expected) / np.append(width, width)
        high = high[np.isfinite(high)]
        upper = Axes(sheet, (left, top, right, middle - top - 14), x, Scale(0, 1.06 * high.max(initial=0) or 1.0))
        upper.frame(up=what)
        upper.stairs(observed / width, edges, OBSERVED, fill=True)
        upper.stairs(expected / width, edges, EXPECTED, DASHED)
        reach = np.abs(misfit[np.isfinite(misfit)]).max(initial=0) * 1.15 or 1.0
        lower = Axes(sheet, (left, middle, right, sheet.height - middle - 50), x, Scale(-reach, reach))
        lower.frame(across, "misfit [%]", ticks=(6, 4))
        lower.line(edges[[0, -1]], [0, 0], EXPECTED, DASHED)
        lower.stairs(misfit, edges, OBSERVED)
        worst = int(np.argmax(np.abs(observed - expected)))
        return (
            f"Observed shares of {expected.size} bins of {label(self.label)} against their probabilities; the largest "
            f"difference is {observed[worst] - expected[worst]:+.2g} in the bin {_within(*self.edges[worst : worst + 2])} "
            f"(expected {expected[worst]:.3g})."
        )


def _within(low: float, high: float) -> str:
    """Return in words where a bin lies."""
    if abs(low) > ENDLESS or abs(high) > ENDLESS:
        return f"beyond {high if abs(low) > ENDLESS else low:.4g}"
    return f"from {low:.4g} to {high:.4g}"


def closed(edges: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return `edges` with an endless outer one moved to a bin's width from its neighbour, and if there was one.

    A far tail counts as endless: to its scale all other bins would be a single line.
    """
    edges = edges.copy()
    ends = [(0, 1, 2), (-1, -2, -3)]
    inner = edges[-2] - edges[1] if edges.size > 3 else np.inf
    opened = [end for end in ends if np.isinf(edges[end[0]]) or abs(edges[end[0]] - edges[end[1]]) > FAR * inner]
    for end, first, second in opened:
        step = edges[first] - edges[second] if edges.size > 2 and np.isfinite(edges[second]) else 0.0
        edges[end] = edges[first] + (step or np.sign(edges[end]))
    return edges, bool(opened)
