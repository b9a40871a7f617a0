"""Spacings of samples, as Pyro, numpyro and goftests test densities, with p-values that are right.

Where n points have density p, the empty room beside one of them, times n p, follows the exponential law: in one dimension the gap
to the next point (with the mean density at its ends), in more the ball or cap to the nearest one. 1 - exp(-room) is then uniform,
which a chi-square test with m^(1/3) bins of m rooms looks at. The libraries ask p > 2e-5 of a few ten thousand samples. Two things
differ from theirs: the p-value is the chi-square law's, where theirs is a series that ends too soon; and only one point in sixteen
is asked for its neighbour, because two that are each other's count the same room twice, which rejects right samplers.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.domains import Box, HalfLine, Interval, RealLine, UnitHemisphere, UnitSphere, UnitSquare
from fogproof.zoo.others.test import OtherTest, drawn

SAMPLES, ASKED = 100_000, 16
_LINES, _PLACES = (Interval, HalfLine, RealLine), (UnitSphere, UnitHemisphere, UnitSquare, Box)


def _applies(sampler: Any) -> bool:
    return isinstance(sampler.domain, (*_LINES, *_PLACES)) and not getattr(sampler, "atoms", {})


def _p_value(sampler: Any, rng: np.random.Generator) -> float:
    from scipy.stats import chi2

    x = drawn(sampler, rng, SAMPLES)
    if not np.all(np.isfinite(x)):
        return 0.0
    room = _gaps(sampler, x) if x.ndim == 1 else _balls(sampler, x)
    if not np.all(room >= 0):  # a density below 0, or none
        return 0.0
    bins = round(len(room) ** (1 / 3))
    counts = np.bincount(np.minimum((-np.expm1(-room) * bins).astype(int), bins - 1), minlength=bins)
    mean = len(room) / bins
    return float(chi2.sf(np.sum((counts - mean) ** 2) / mean, bins - 1))


def _gaps(sampler: Any, x: np.ndarray) -> np.ndarray:
    x = np.sort(x)
    p = np.asarray(sampler.pdf(x), dtype=float)
    return np.diff(x) * 0.5 * (p[1:] + p[:-1]) * len(x)


def _balls(sampler: Any, x: np.ndarray) -> np.ndarray:
    from scipy.spatial import cKDTree

    asked = x[::ASKED]
    distance = cKDTree(x).query(asked, k=2)[0][:, 1]
    k = x.shape[1]
    if isinstance(sampler.domain, UnitSphere | UnitHemisphere):
        volume = np.pi * distance**2  # of a cap, by the chord, exactly
    else:
        volume = math.pi ** (k / 2) / math.gamma(k / 2 + 1) * distance**k
    return volume * np.asarray(sampler.pdf(asked), dtype=float) * len(x)


TESTS = (
    OtherTest(
        "spacings", "numpyro: spacings and nearest neighbours", "numpyro, test_distributions; goftests", 2e-5, SAMPLES,
        _applies, _p_value,
    ),
)  # fmt: skip
