"""Analog estimators of transmittance against the closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    transmittance,
    transmittance_variance,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.catalogue.rays.builders import (
    ray_to,
)
from fogproof.contracts import Draws, Reference
from fogproof.estimators import (
    AnalogTransmittance,
    SpectralTransmittance,
    along,
)
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, OpenGLFog


def _transmittance_case(
    name: str, title: str, medium: AnyMedium, length: float, error: str, twin: Callable[[], Any]
) -> EstimatorCase:
    return EstimatorCase(
        name=f"transmittance/analog/{name}",
        title=title,
        make=lambda: AnalogTransmittance(along(medium, ray_to(length)), length),
        reference=lambda: transmittance(medium, ray_to(length)),
        variance=lambda: transmittance_variance(medium, ray_to(length), "delta"),
        cost=lambda: 1.0,
        oracle="transmittance, transmittance_variance",
        source="Beer-Lambert law",
        twin=Twin(error, twin),
    )


def _spectral_variance(sigma_t: tuple[float, ...], length: float) -> Reference:
    """T_i^2 (1/P - 1), P the mean of all T: of two values, T_i/P with probability P and 0."""
    through = transmittance(Medium(sigma_t, (0.0,) * len(sigma_t)), ray_to(length))
    T = through.value
    return Reference(T * T * (1 / T.mean() - 1), 1e-14 * T, "T^2 (1/P - 1)", "second moment of importance sampling")


def _chosen_channel_only(sigma_t: tuple[float, ...], length: float) -> Drawn:
    """Every channel is divided by the probability of the drawn channel: the mean is right, the variance is not."""

    def draw(rng: np.random.Generator, n: int) -> Draws:
        sigma = np.array(sigma_t)
        chosen = sigma[rng.integers(len(sigma), size=n)]
        reached = -np.log1p(-rng.random(n)) / chosen >= length
        return Draws(np.where(reached[:, None], np.exp(-(sigma - chosen[:, None]) * length), 0.0), cost=np.ones(n))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of transmittance."""
    medium = Medium(0.3, 0.5)
    rising = LinearMedium(0.1, (0, 0, 0.4), 0.6, emission=1.5)
    air = ExponentialMedium(0.8, (0, 0, -0.2), 0.9)
    blood = (0.2, 0.6, 2.0)
    half = 0.7
    return [
        _transmittance_case(
            name="thin",
            title="Transmittance by free paths, tau = 0.4",
            medium=medium,
            length=0.5,
            error="only absorption is counted as extinction",
            twin=lambda: AnalogTransmittance(0.3, 0.5),
        ),
        _transmittance_case(
            name="dense",
            title="Transmittance by free paths, tau = 6.4",
            medium=medium,
            length=8.0,
            error="the path is measured along an unnormalised direction, 10 % too long",
            twin=lambda: AnalogTransmittance(0.8, 8.8),
        ),
        _transmittance_case(
            name="linear",
            title="Transmittance by free paths, extinction that grows linearly",
            medium=rising,
            length=2.0,
            error="the extinction at the start is taken for the whole path",
            twin=lambda: AnalogTransmittance(0.1, 2.0),
        ),
        _transmittance_case(
            name="exponential",
            title="Transmittance by free paths through an atmosphere",
            medium=air,
            length=5.0,
            error="the extinction at the ground is taken for the whole path",
            twin=lambda: AnalogTransmittance(0.8, 5.0),
        ),
        _transmittance_case(
            name="opengl-exp2",
            title="Transmittance by free paths in OpenGL's squared exponential fog",
            medium=OpenGLFog("exp2", density=0.3),
            length=3.0,
            error="the exponent is not squared",
            twin=lambda: AnalogTransmittance(0.3, 3.0),
        ),
        EstimatorCase(
            name="transmittance/spectral",
            title="Transmittance of three channels by one free path",
            make=lambda: SpectralTransmittance(blood, half),
            reference=lambda: transmittance(Medium(blood, (0.0,) * 3), ray_to(half)),
            variance=lambda: _spectral_variance(blood, half),
            cost=lambda: 1.0,
            oracle="transmittance",
            source="Veach & Guibas 1995, balance heuristic of one sample",
            twin=Twin(
                "every channel is divided by the probability of the drawn channel alone",
                lambda: _chosen_channel_only(blood, half),
            ),
        ),
    ]
