"""SciPy's tests of one number against a distribution function: `kstest`, and `goodness_of_fit` with simulated p-values.

The distribution function is the integral of the claimed pdf, by the trapezoidal rule on 200 001 places between extreme samples of a
pilot, as users without a closed form write it; where the pdf does not integrate to one, neither does this.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.domains import HalfLine, Interval, RealLine
from fogproof.zoo.others.test import OtherTest, drawn

SAMPLES, FEW, SIMULATED, PLACES = 1_000_000, 1_000, 999, 200_001


def _applies(sampler: Any) -> bool:
    return isinstance(sampler.domain, Interval | HalfLine | RealLine) and not getattr(sampler, "atoms", {})


def _cdf(sampler: Any, x: np.ndarray) -> np.ndarray:
    """Return the integral of the pdf up to each of the samples."""
    low, high = float(x.min()), float(x.max())
    grid = np.concatenate([np.linspace(low, high, PLACES), np.quantile(x, np.linspace(0, 1, 2001))])
    grid = np.unique(grid)
    p = np.asarray(sampler.pdf(grid), dtype=float)
    steps = np.diff(grid) * 0.5 * (p[1:] + p[:-1])
    return np.interp(x, grid, np.concatenate([[0.0], np.cumsum(steps)]))


def _kstest(sampler: Any, rng: np.random.Generator) -> float:
    from scipy.stats import kstest

    x = drawn(sampler, rng, SAMPLES)
    if not np.all(np.isfinite(x)):
        return 0.0
    return float(kstest(_cdf(sampler, x), "uniform", method="asymp").pvalue)


def _goodness_of_fit(sampler: Any, rng: np.random.Generator) -> float:
    from scipy.stats import goodness_of_fit, uniform

    x = drawn(sampler, rng, SAMPLES)
    if not np.all(np.isfinite(x)):
        return 0.0
    values = np.clip(_cdf(sampler, x)[:FEW], 1e-12, 1 - 1e-12)
    known = {"loc": 0.0, "scale": 1.0}
    result = goodness_of_fit(uniform, values, known_params=known, statistic="ad", n_mc_samples=SIMULATED, rng=rng)
    return float(result.pvalue)


TESTS = (
    OtherTest("kstest", "SciPy: kstest", "scipy.stats.kstest", 0.01, SAMPLES, _applies, _kstest),
    OtherTest(
        "goodness-of-fit", "SciPy: goodness_of_fit (Anderson & Darling, 999 simulations)", "scipy.stats.goodness_of_fit",
        0.01, FEW, _applies, _goodness_of_fit,
    ),
)  # fmt: skip
