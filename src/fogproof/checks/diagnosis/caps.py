"""Rejection under a bound that is too low: where the density is larger, all proposals are accepted, and the peak is flat."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_BELOW = (0.03, 0.1, 0.25, 0.5, 0.75, 0.9, 0.97)  # shares of the claim that lie below a bound
_POINTS = 2048  # that tell such levels
_EVEN = 1e-6  # relative difference of densities that are one


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that the samples have the density min(p, c): their proposals were even, or went with what p is a multiple of."""
    p = setting.p(setting.claimed_points(_POINTS))
    p = p[(p > 0) & np.isfinite(p)]
    if len(p) == 0 or np.ptp(p) <= _EVEN * p.max():
        return
    top = float(p.max())
    levels = np.unique(np.quantile(p, _BELOW) / top)
    trials = tuple(levels[levels < 1 - _EVEN].tolist())
    if trials:
        yield Hypothesis(
            "capped peak",
            f"the peak of the pdf is cut off, at {{value}} of {top:.4g}: as of rejection with a bound that is too low",
            lambda s, c: lambda x: np.minimum(s.p(x), c * top),
            trials,
        )
