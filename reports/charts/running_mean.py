"""The running mean of an estimator on its way to the reference, or past it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.reports.charts.axes import DASHED, Axes
from fogproof.reports.charts.colours import EXPECTED, OBSERVED
from fogproof.reports.charts.legend import Key, legend
from fogproof.reports.charts.scale import Scale, spanning
from fogproof.reports.charts.sheet import Sheet


@dataclass(frozen=True)
class RunningMean:
    """After `n` realisations the mean was `mean` +- `stderr`; the truth lies within `error` of `reference`."""

    reference: float
    error: float
    n: tuple[float, ...]
    mean: tuple[float, ...]
    stderr: tuple[float, ...]

    HOW: ClassVar[str] = (
        "The mean after so many realisations, with two standard errors. It should close in on the line, which is the "
        "oracle's value, and wander about it less and less. A mean that settles beside the line is biased; one that "
        "jumps late has a heavy tail."
    )

    def __post_init__(self) -> None:
        for name in ("mean", "stderr"):
            got = len(getattr(self, name))
            if not self.n or got != len(self.n):
                raise InvalidValueError(name, f"must have one number for each of the {len(self.n)} sample counts", got)

    def draw(self, sheet: Sheet) -> str:
        """Draw mean and two standard errors over n; the height fits the later half, where a bias would show."""
        n, mean, stderr = np.array(self.n), np.array(self.mean), np.array(self.stderr)
        known = bool(np.isfinite([self.reference, self.error]).all())
        late = slice(len(n) // 2, None)
        with np.errstate(invalid="ignore"):
            reach = np.append(np.abs(mean[late] - self.reference) + 2.5 * stderr[late], self.error)
        reach = reach[np.isfinite(reach)].max(initial=0)
        y = spanning(mean)
        if known and reach > 0:
            y = Scale(self.reference - 1.1 * reach, self.reference + 1.1 * reach)
        keys = [Key("mean ± 2 standard errors", OBSERVED)]
        keys += [Key("reference and its error bound", EXPECTED, dash=DASHED)] if known else []
        top = legend(sheet, keys, 20, 0, sheet.width - 20) + 4
        logarithmic = bool(n[0] > 0 and n[-1] > n[0])
        axes = Axes(sheet, (104, top, sheet.width - 118, sheet.height - top - 50), spanning(n, logarithmic), y)
        axes.frame("realisations n", "estimate")
        if known:
            ends, bound = [axes.x.low, axes.x.high], np.full(2, self.error)
            axes.band(ends, self.reference - bound, self.reference + bound, EXPECTED)
            axes.line(ends, [self.reference, self.reference], EXPECTED, DASHED)
        axes.band(n, mean - 2 * stderr, mean + 2 * stderr, OBSERVED)
        axes.line(n, mean, OBSERVED)
        axes.points(n, mean, OBSERVED)
        return (
            f"After {n[-1]:,.0f} realisations the mean is {mean[-1]:.6g} ± {stderr[-1]:.2g} (one standard error); the "
            f"reference is {self.reference:.6g}, known within {self.error:.1g}."
        )
