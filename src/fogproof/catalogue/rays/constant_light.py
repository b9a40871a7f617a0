"""Ambient fog: estimators in constant in-scattered light against the closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    ambient_fog,
    ambient_fog_variance,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.catalogue.rays.builders import (
    ray_to,
)
from fogproof.estimators import (
    AnalogFog,
    CertainCollisionFog,
    HomogeneousSpectralFog,
    along,
)
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, OpenGLFog

_EQUATION = "volume rendering equation with constant in-scattered radiance"


def _fog_case(
    name: str,
    title: str,
    medium: AnyMedium,
    length: float,
    ambient: float,
    background: float,
    error: str,
    twin: Callable[[], Any],
    *,
    make: Any = AnalogFog,
    variance: float | None = None,
) -> EstimatorCase:
    """Return a case of fog; the variance is that of analog paths unless given."""
    kind = {AnalogFog: "analog", CertainCollisionFog: "certain-collision"}[make]
    return EstimatorCase(
        name=f"fog/{kind}/{name}",
        title=title,
        make=lambda: make(medium, ray_to(length), ambient, background),
        reference=lambda: ambient_fog(medium, ray_to(length), ambient, background),
        variance=lambda: (
            ambient_fog_variance(medium, ray_to(length), ambient, background) if variance is None else variance
        ),
        oracle="ambient_fog, ambient_fog_variance",
        source=_EQUATION,
        twin=Twin(error, twin),
    )


def _swapped(medium: Medium, length: float, ambient: float, background: float) -> Drawn:
    """The lerp with its weights exchanged: fog where the background should be."""
    turned = AnalogFog(Medium(medium.sigma_a, medium.sigma_s), ray_to(length), 0.0, 1.0)

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        reached = np.asarray(turned.draw(rng, n).value)
        return np.where(reached == 1, float(medium.albedo) * ambient, background)

    return Drawn(draw)


def _every_channel_is_the_first(fog: HomogeneousSpectralFog) -> Drawn:
    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        value = np.asarray(fog.draw(rng, n).value)
        return np.repeat(value[:, :1], value.shape[1], axis=1)

    return Drawn(draw)


def _not_renormalised(fog: CertainCollisionFog) -> Drawn:
    """The collision is certain, but its density is taken for that of a path that need not collide."""
    extinction, length = along(fog.medium, fog.ray), float(fog.ray.length)
    T = float(np.exp(-extinction.depth(np.array(length))))

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        through = T * fog.background
        return through + (np.asarray(fog.draw(rng, n).value) - through) / (1 - T)

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of fog."""
    medium = Medium(0.3, 0.5)
    haze = Medium(0.02, 0.08)
    glowing = Medium(0.4, 0.6, emission=2.0)
    rising = LinearMedium(0.1, (0, 0, 0.4), 0.6, emission=1.5)
    air = ExponentialMedium(0.8, (0, 0, -0.2), 0.9)
    milk = Medium((0.1, 0.2, 0.8), (0.7, 1.0, 1.7), emission=(0.5, 0.0, 0.2))
    endless = np.inf
    return [
        _fog_case(
            name="haze",
            title="Fog before a bright background",
            medium=haze,
            length=7.0,
            ambient=0.8,
            background=1.5,
            error="the weights of the lerp are exchanged",
            twin=lambda: _swapped(haze, 4.0, 0.8, 1.5),
        ),
        _fog_case(
            name="glowing",
            title="Fog that emits",
            medium=glowing,
            length=1.5,
            ambient=0.5,
            background=0.1,
            error="emission lacks the factor sigma_a",
            twin=lambda: AnalogFog(Medium(0.4, 0.6, emission=5.0), ray_to(1.5), 0.5, 0.1),
        ),
        _fog_case(
            name="endless",
            title="Fog on a ray without end",
            medium=medium,
            length=endless,
            ambient=1.0,
            background=9.0,
            error="the albedo is forgotten",
            twin=lambda: AnalogFog(Medium(0.0, 0.8), ray_to(endless), 1.0, 9.0),
            variance=0.0,
        ),
        _fog_case(
            name="furnace",
            title="Furnace: albedo 1, ambient = background = 1",
            medium=Medium(0.0, 0.7),
            length=2.0,
            ambient=1.0,
            background=1.0,
            error="a tenth of the scattering is lost",
            twin=lambda: AnalogFog(Medium(0.07, 0.63), ray_to(2.0), 1.0, 1.0),
            variance=0.0,
        ),
        _fog_case(
            name="thermal-furnace",
            title="Thermal furnace: emission = ambient = background = 1, extinction that grows",
            medium=LinearMedium(0.1, (0, 0, 0.4), 0.6, emission=1.0),
            length=2.0,
            ambient=1.0,
            background=1.0,
            error="the emission is multiplied by the albedo",
            twin=lambda: AnalogFog(LinearMedium(0.1, (0, 0, 0.4), 0.6, emission=0.6 / 0.4), ray_to(2.0), 1.0, 1.0),
            variance=0.0,
        ),
        _fog_case(
            name="linear",
            title="Fog that grows linearly, and emits",
            medium=rising,
            length=2.5,
            ambient=0.4,
            background=2.0,
            error="the optical depth lacks the half of the quadratic term",
            twin=lambda: AnalogFog(LinearMedium(0.1, (0, 0, 0.8), 0.6, emission=1.5), ray_to(2.5), 0.4, 2.0),
        ),
        _fog_case(
            name="exponential",
            title="Atmosphere before the sky",
            medium=air,
            length=endless,
            ambient=1.0,
            background=0.02,
            error="the scale height is halved",
            twin=lambda: AnalogFog(ExponentialMedium(0.8, (0, 0, -0.4), 0.9), ray_to(endless), 1.0, 0.02),
        ),
        _fog_case(
            name="opengl-exp",
            title="OpenGL fog, mode EXP",
            medium=OpenGLFog("exp", density=0.35),
            length=2.0,
            ambient=0.7,
            background=0.1,
            error="the factor of mode EXP2",
            twin=lambda: AnalogFog(OpenGLFog("exp2", density=0.35), ray_to(2.0), 0.7, 0.1),
        ),
        _fog_case(
            name="opengl-exp2",
            title="OpenGL fog, mode EXP2",
            medium=OpenGLFog("exp2", density=0.35),
            length=2.0,
            ambient=0.7,
            background=0.1,
            error="2^-x in place of e^-x",
            twin=lambda: AnalogFog(OpenGLFog("exp2", density=0.35 * np.sqrt(np.log(2))), ray_to(2.0), 0.7, 0.1),
        ),
        _fog_case(
            name="opengl-linear",
            title="OpenGL fog, mode LINEAR",
            medium=OpenGLFog("linear", start=1.0, end=9.0),
            length=4.0,
            ambient=0.7,
            background=0.1,
            error="the start of the fog is ignored",
            twin=lambda: AnalogFog(OpenGLFog("linear", start=0.0, end=9.0), ray_to(4.0), 0.7, 0.1),
        ),
        _fog_case(
            name="haze",
            title="Fog by a collision that is certain, no noise left",
            medium=haze,
            length=7.0,
            ambient=0.8,
            background=1.5,
            error="the density of the collision is not renormalised",
            twin=lambda: _not_renormalised(CertainCollisionFog(haze, ray_to(7.0), 0.8, 1.5)),
            make=CertainCollisionFog,
            variance=0.0,
        ),
        EstimatorCase(
            name="fog/spectral",
            title="Fog of three channels that emits, by one free path",
            make=lambda: HomogeneousSpectralFog(milk, ray_to(0.8), (0.3, 0.6, 0.9), (1.0, 0.2, 0.5)),
            reference=lambda: ambient_fog(milk, ray_to(0.8), (0.3, 0.6, 0.9), (1.0, 0.2, 0.5)),
            oracle="ambient_fog",
            source=_EQUATION,
            twin=Twin(
                "all channels are computed from the first",
                lambda: _every_channel_is_the_first(
                    HomogeneousSpectralFog(milk, ray_to(0.8), (0.3, 0.6, 0.9), (1.0, 0.2, 0.5))
                ),
            ),
        ),
    ]
