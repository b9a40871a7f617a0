"""Estimators of emission against closed forms and quadrature."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    emitted_radiance,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.catalogue.rays.builders import (
    ray_to,
)
from fogproof.contracts import Draws, Reference
from fogproof.estimators import (
    UniformEmission,
)
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium


def _doubled(medium: Medium, length: float) -> Reference:
    """Variance of emission at a uniform place; E[X^2] = length q^2 int T^2 dt, and T^2 is that of a medium twice as dense."""
    q = np.asarray(medium.emission)
    dense = Medium(0.0, 2 * float(medium.sigma_t), emission=1.0)
    integral = emitted_radiance(dense, ray_to(length), times_sigma_a=False)
    mean = emitted_radiance(medium, ray_to(length), times_sigma_a=False)
    value = length * q * q * integral.value - mean.value**2
    error = length * q * q * integral.error + 2 * mean.value * mean.error + 1e-15 * mean.value**2
    return Reference(value, error, integral.method, integral.source)


def _emission_case(
    name: str,
    title: str,
    medium: AnyMedium,
    length: float,
    error: str,
    twin: Callable[[], Any],
    *,
    times_sigma_a: bool = True,
    variance: Callable[[], Reference | float] | None = None,
) -> EstimatorCase:
    return EstimatorCase(
        name=f"emission/{name}",
        title=title,
        make=lambda: UniformEmission(medium, ray_to(length), times_sigma_a),
        reference=lambda: emitted_radiance(medium, ray_to(length), times_sigma_a=times_sigma_a),
        variance=variance,
        oracle="emitted_radiance",
        source="volume rendering equation with emission alone",
        twin=Twin(error, twin),
    )


def _times_sigma_t(medium: LinearMedium, length: float) -> Drawn:
    """Emission multiplied by the extinction, not by the absorption coefficient."""
    glow = UniformEmission(medium, ray_to(length))

    def draw(rng: np.random.Generator, n: int) -> Draws:
        return Draws(np.asarray(glow.draw(rng, n).value) / (1 - float(np.asarray(medium.albedo))))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of emission."""
    hot = LinearMedium(1.2, (0, 0, -0.3), 0.3, emission=2.0)
    flame = Medium(0.5, 0.2, emission=3.0)
    gas = Medium(0.0, 0.0, emission=0.7)
    return [
        _emission_case(
            name="flame",
            title="Emission at a uniform place, per volume",
            medium=flame,
            length=3.0,
            error="only absorption is counted as extinction",
            twin=lambda: UniformEmission(Medium(0.5, 0.0, emission=3.0), ray_to(3.0), False),
            times_sigma_a=False,
            variance=lambda: _doubled(flame, 3.0),
        ),
        _emission_case(
            name="gas",
            title="Gas that glows and does not absorb",
            medium=gas,
            length=4.0,
            error="the emission is multiplied by an absorption coefficient of 0",
            twin=lambda: UniformEmission(gas, ray_to(4.0), True),
            times_sigma_a=False,
            variance=lambda: 0.0,
        ),
        _emission_case(
            name="hot",
            title="Emission of a medium that thins out linearly",
            medium=hot,
            length=6.0,
            error="the emission is multiplied by sigma_t, not by sigma_a",
            twin=lambda: _times_sigma_t(hot, 6.0),
        ),
        _emission_case(
            name="atmosphere",
            title="Emission of an atmosphere",
            medium=ExponentialMedium(0.8, (0, 0, -0.2), 0.9, emission=1.0),
            length=10.0,
            error="the extinction at the ground is taken for the whole path",
            twin=lambda: UniformEmission(Medium(0.08, 0.72, emission=1.0), ray_to(10.0)),
        ),
    ]
