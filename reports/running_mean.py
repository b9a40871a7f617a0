"""The running mean of an estimator on its way to the reference, or past it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.reports.pictures import EXPECTED, OBSERVED

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class RunningMean:
    """After `n` realisations the mean was `mean` +- `stderr`; the truth lies within `error` of `reference`."""

    reference: float
    error: float
    n: tuple[float, ...]
    mean: tuple[float, ...]
    stderr: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("mean", "stderr"):
            got = len(getattr(self, name))
            if not self.n or got != len(self.n):
                raise InvalidValueError(name, f"must have one number for each of the {len(self.n)} sample counts", got)

    def draw(self, figure: Figure) -> str:
        """Draw mean and two standard errors over n; the height fits the later half, where a bias would show."""
        n, mean, stderr = np.array(self.n), np.array(self.mean), np.array(self.stderr)
        axes = figure.add_axes((0.17, 0.17, 0.80, 0.72))
        if np.isfinite([self.reference, self.error]).all():
            low, high = self.reference - self.error, self.reference + self.error
            axes.axhspan(low, high, color=EXPECTED, alpha=0.25, linewidth=0)
            axes.axhline(self.reference, color=EXPECTED, linestyle="--", label="reference and its error bound")
        axes.fill_between(n, mean - 2 * stderr, mean + 2 * stderr, color=OBSERVED, alpha=0.25, linewidth=0)
        axes.plot(n, mean, color=OBSERVED, marker="o", markersize=4, label="mean ± 2 standard errors")
        if n[0] > 0 and n[-1] > n[0]:
            axes.set_xscale("log")
        late = slice(len(n) // 2, None)
        with np.errstate(invalid="ignore"):
            reach = np.append(np.abs(mean[late] - self.reference) + 2.5 * stderr[late], self.error)
        reach = reach[np.isfinite(reach)].max(initial=0)
        if np.isfinite(self.reference) and reach > 0:
            axes.set_ylim(self.reference - 1.1 * reach, self.reference + 1.1 * reach)
        axes.set_xlabel("realisations n")
        axes.set_ylabel("estimate")
        axes.legend(loc="lower center", bbox_to_anchor=(0.45, 1.0), ncols=2, borderaxespad=0.2, handlelength=1.4)
        return (
            f"After {n[-1]:,.0f} realisations the mean is {mean[-1]:.6g} ± {stderr[-1]:.2g} (one standard error); the "
            f"reference is {self.reference:.6g}, known within {self.error:.1g}."
        )
