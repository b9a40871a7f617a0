"""Free paths where the extinction changes along the ray against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.free_paths.builders import (
    density_at_surface,
    graded,
    nobody_escapes,
    pole_clipped,
)
from fogproof.estimators import FreePath, Linear
from fogproof.scene import ExponentialMedium, LinearMedium, OpenGLFog


def _doubled_slope(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The optical depth is taken for sigma_0 t + slope t^2, without the half."""
    assert isinstance(sampler.extinction, Linear)
    return FreePath(Linear(sampler.extinction.sigma_0, 2 * sampler.extinction.slope), sampler.surface).sample(u).x


def _constant_from_start(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The extinction at the start is taken for the whole path."""
    assert not isinstance(sampler.extinction, int | float)
    return FreePath(float(sampler.extinction.sigma(np.zeros(1))[0]), sampler.surface).sample(u).x


def _from_eye(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The fog is taken to start at the eye."""
    return np.minimum(12.0 * u[:, 0], 12.0)


def cases() -> list[SamplerCase]:
    """Return the cases of extinction that changes."""
    rising = LinearMedium(0.2, (0, 0, 0.8))
    falling = LinearMedium(1.0, (0, 0, -0.25))
    late = LinearMedium(-0.5, (0, 0, 0.5))
    atmosphere = ExponentialMedium(0.4, (0, 0, -0.3))
    sinking = ExponentialMedium(0.05, (0, 0, 0.9))
    return [
        graded(
            name="linear/rising",
            title="Free path, extinction that grows linearly",
            medium=rising,
            surface=np.inf,
            error="the optical depth lacks the half of the quadratic term",
            sample=_doubled_slope,
        ),
        graded(
            name="linear/falling",
            title="Free path, extinction that falls linearly to vacuum",
            medium=falling,
            surface=np.inf,
            error="paths that escape are stopped where the medium ends",
            sample=nobody_escapes,
        ),
        graded(
            name="linear/late",
            title="Free path, vacuum first, a surface last",
            medium=late,
            surface=2.5,
            error="at the surface the density is returned in place of the probability",
            sample=density_at_surface,
        ),
        graded(
            name="exponential/up",
            title="Free path upwards through an atmosphere",
            medium=atmosphere,
            surface=np.inf,
            error="nobody escapes: the logarithm is clipped",
            sample=pole_clipped,
        ),
        graded(
            name="exponential/down",
            title="Free path down through an atmosphere to the ground",
            medium=sinking,
            surface=6.0,
            error="the extinction at the start is taken for the whole path",
            sample=_constant_from_start,
        ),
        graded(
            name="opengl/linear",
            title="Free path in OpenGL's linear fog",
            medium=OpenGLFog("linear", start=2.0, end=12.0),
            surface=9.0,
            error="the fog is taken to start at the eye",
            sample=_from_eye,
        ),
        graded(
            name="opengl/exp2",
            title="Free path in OpenGL's squared exponential fog",
            medium=OpenGLFog("exp2", density=0.4),
            surface=np.inf,
            error="the optical depth lacks the half of the quadratic term",
            sample=_doubled_slope,
        ),
    ]
