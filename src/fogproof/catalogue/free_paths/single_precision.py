"""Free paths in single precision against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.free_paths.builders import (
    graded,
    homogeneous,
    leaky_surface,
    nobody_escapes,
    pole_clipped,
    truncated,
)
from fogproof.estimators import FreePath, TruncatedFreePath
from fogproof.scene import ExponentialMedium, LinearMedium, Medium


def _coarse(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """Uniforms of 12 bits."""
    return sampler.sample(np.floor(4096 * u) / 4096).x


def _cancelling(sampler: TruncatedFreePath, u: np.ndarray) -> np.ndarray:
    """The probability of a collision as 1 - exp(-depth), which is a multiple of the roundoff."""
    sigma = np.float32(sampler.extinction.sigma(np.zeros(1, u.dtype))[0])  # type: ignore[union-attr]
    share = 1 - np.exp(-sigma * np.float32(sampler.length))
    return np.minimum(-np.log(1 - u[:, 0] * share) / sigma, sampler.length)


def cases() -> list[SamplerCase]:
    """Return the cases of single precision."""
    falling = LinearMedium(1.0, (0, 0, -0.25))
    atmosphere = ExponentialMedium(0.4, (0, 0, -0.3))
    return [
        homogeneous(
            name="float32",
            title="Free path in single precision, no surface",
            sigma_t=2.5,
            surface=np.inf,
            error="uniforms of 12 bits, which cut the tail off",
            sample=_coarse,
            with_cdf=False,
            precision="float32",
        ),
        homogeneous(
            name="float32/surface",
            title="Free path in single precision before a surface at tau = 2",
            sigma_t=0.4,
            surface=5.0,
            error="5 % of the surface events are moved",
            sample=leaky_surface,
            with_cdf=False,
            precision="float32",
        ),
        graded(
            name="float32/linear",
            title="Free path in single precision, extinction that falls linearly to vacuum",
            medium=falling,
            surface=np.inf,
            error="paths that escape are stopped where the medium ends",
            sample=nobody_escapes,
            with_cdf=False,
            precision="float32",
        ),
        graded(
            name="float32/exponential",
            title="Free path in single precision, upwards through an atmosphere",
            medium=atmosphere,
            surface=np.inf,
            error="nobody escapes: the logarithm is clipped",
            sample=pole_clipped,
            with_cdf=False,
            precision="float32",
        ),
        truncated(
            name="float32",
            title="Free path in single precision that ends before tau = 1e-6",
            medium=Medium(1e-6, 0.0),
            length=1.0,
            error="1 - exp(-depth), whose digits cancel",
            sample=_cancelling,
            with_cdf=False,
            precision="float32",
        ),
    ]
