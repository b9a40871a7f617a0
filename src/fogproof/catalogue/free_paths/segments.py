"""Free paths that are sure to end on a segment against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.free_paths.builders import (
    truncated,
)
from fogproof.estimators import FreePath, TruncatedFreePath
from fogproof.scene import LinearMedium, Medium


def _clipped(sampler: TruncatedFreePath, u: np.ndarray) -> np.ndarray:
    return np.minimum(FreePath(sampler.extinction).sample(u).x, sampler.length)


def _not_renormalised(sampler: TruncatedFreePath, x: np.ndarray) -> np.ndarray:
    return FreePath(sampler.extinction).pdf(x)


def cases() -> list[SamplerCase]:
    """Return the cases of a certain collision."""
    rising = LinearMedium(0.2, (0, 0, 0.8))
    return [
        truncated(
            name="dense",
            title="Free path that ends before tau = 2",
            medium=Medium(1.0, 0.0),
            length=2.0,
            error="free paths beyond the end are put there",
            sample=_clipped,
        ),
        truncated(
            name="thin",
            title="Free path that ends before tau = 1e-9",
            medium=Medium(1e-9, 0.0),
            length=1.0,
            error="the density is not divided by the probability of ending there",
            pdf=_not_renormalised,
            with_cdf=False,
        ),
        truncated(
            name="linear",
            title="Free path that ends before tau = 3.6, extinction that grows linearly",
            medium=rising,
            length=2.75,
            error="the density is not divided by the probability of ending there",
            pdf=_not_renormalised,
        ),
    ]
