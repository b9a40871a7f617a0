"""Estimators of transmittance, ambient fog and emission against the oracle's closed forms and quadrature."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    ambient_fog,
    ambient_fog_variance,
    emitted_radiance,
    transmittance,
    transmittance_variance,
)
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws, Reference
from fogproof.estimators import (
    AnalogFog,
    AnalogTransmittance,
    CertainCollisionFog,
    HomogeneousSpectralFog,
    SpectralTransmittance,
    UniformEmission,
    along,
)
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, OpenGLFog, Ray

_START = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
_EQUATION = "volume rendering equation with constant in-scattered radiance"


def _to(length: float) -> Ray:
    return Ray(*_START, length)


def _transmittance_case(
    name: str, title: str, medium: AnyMedium, length: float, error: str, twin: Callable[[], Any]
) -> EstimatorCase:
    return EstimatorCase(
        name=f"transmittance/analog/{name}",
        title=title,
        make=lambda: AnalogTransmittance(along(medium, _to(length)), length),
        reference=lambda: transmittance(medium, _to(length)),
        variance=lambda: transmittance_variance(medium, _to(length), "delta"),
        cost=lambda: 1.0,
        oracle="transmittance, transmittance_variance",
        source="Beer-Lambert law",
        twin=Twin(error, twin),
    )


def _spectral_variance(sigma_t: tuple[float, ...], length: float) -> Reference:
    """T_i^2 (1/P - 1), P the mean of all T: of two values, T_i/P with probability P and 0."""
    through = transmittance(Medium(sigma_t, (0.0,) * len(sigma_t)), _to(length))
    T = through.value
    return Reference(T * T * (1 / T.mean() - 1), 1e-14 * T, "T^2 (1/P - 1)", "second moment of importance sampling")


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
        make=lambda: make(medium, _to(length), ambient, background),
        reference=lambda: ambient_fog(medium, _to(length), ambient, background),
        variance=lambda: (
            ambient_fog_variance(medium, _to(length), ambient, background) if variance is None else variance
        ),
        oracle="ambient_fog, ambient_fog_variance",
        source=_EQUATION,
        twin=Twin(error, twin),
    )


def _swapped(medium: Medium, length: float, ambient: float, background: float) -> Drawn:
    """The lerp with its weights exchanged: fog where the background should be."""
    turned = AnalogFog(Medium(medium.sigma_a, medium.sigma_s), _to(length), 0.0, 1.0)

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        reached = np.asarray(turned.draw(rng, n).value)
        return np.where(reached == 1, float(medium.albedo) * ambient, background)

    return Drawn(draw)


def _chosen_channel_only(sigma_t: tuple[float, ...], length: float) -> Drawn:
    """Every channel is divided by the probability of the drawn channel: the mean is right, the variance is not."""

    def draw(rng: np.random.Generator, n: int) -> Draws:
        sigma = np.array(sigma_t)
        chosen = sigma[rng.integers(len(sigma), size=n)]
        reached = -np.log1p(-rng.random(n)) / chosen >= length
        return Draws(np.where(reached[:, None], np.exp(-(sigma - chosen[:, None]) * length), 0.0), cost=np.ones(n))

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


def _doubled(medium: Medium, length: float) -> Reference:
    """Variance of emission at a uniform place; E[X^2] = length q^2 int T^2 dt, and T^2 is that of a medium twice as dense."""
    q = np.asarray(medium.emission)
    dense = Medium(0.0, 2 * float(medium.sigma_t), emission=1.0)
    integral = emitted_radiance(dense, _to(length), times_sigma_a=False)
    mean = emitted_radiance(medium, _to(length), times_sigma_a=False)
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
        make=lambda: UniformEmission(medium, _to(length), times_sigma_a),
        reference=lambda: emitted_radiance(medium, _to(length), times_sigma_a=times_sigma_a),
        variance=variance,
        oracle="emitted_radiance",
        source="volume rendering equation with emission alone",
        twin=Twin(error, twin),
    )


def _times_sigma_t(medium: LinearMedium, length: float) -> Drawn:
    """Emission multiplied by the extinction, not by the absorption coefficient."""
    glow = UniformEmission(medium, _to(length))

    def draw(rng: np.random.Generator, n: int) -> Draws:
        return Draws(np.asarray(glow.draw(rng, n).value) / (1 - float(np.asarray(medium.albedo))))

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of transmittance, fog and emission."""
    medium, haze = Medium(0.3, 0.5), Medium(0.02, 0.08)
    glowing = Medium(0.4, 0.6, emission=2.0)
    rising, air = LinearMedium(0.1, (0, 0, 0.4), 0.6, emission=1.5), ExponentialMedium(0.8, (0, 0, -0.2), 0.9)
    hot = LinearMedium(1.2, (0, 0, -0.3), 0.3, emission=2.0)
    flame, gas = Medium(0.5, 0.2, emission=3.0), Medium(0.0, 0.0, emission=0.7)
    milk = Medium((0.1, 0.2, 0.8), (0.7, 1.0, 1.7), emission=(0.5, 0.0, 0.2))
    blood, half = (0.2, 0.6, 2.0), 0.7
    endless = np.inf
    return [
        _transmittance_case(
            "thin",
            "Transmittance by free paths, tau = 0.4",
            medium,
            0.5,
            "only absorption is counted as extinction",
            lambda: AnalogTransmittance(0.3, 0.5),
        ),
        _transmittance_case(
            "dense",
            "Transmittance by free paths, tau = 6.4",
            medium,
            8.0,
            "the path is measured along an unnormalised direction, 10 % too long",
            lambda: AnalogTransmittance(0.8, 8.8),
        ),
        _transmittance_case(
            "linear",
            "Transmittance by free paths, extinction that grows linearly",
            rising,
            2.0,
            "the extinction at the start is taken for the whole path",
            lambda: AnalogTransmittance(0.1, 2.0),
        ),
        _transmittance_case(
            "exponential",
            "Transmittance by free paths through an atmosphere",
            air,
            5.0,
            "the extinction at the ground is taken for the whole path",
            lambda: AnalogTransmittance(0.8, 5.0),
        ),
        _transmittance_case(
            "opengl-exp2",
            "Transmittance by free paths in OpenGL's squared exponential fog",
            OpenGLFog("exp2", density=0.3),
            3.0,
            "the exponent is not squared",
            lambda: AnalogTransmittance(0.3, 3.0),
        ),
        EstimatorCase(
            name="transmittance/spectral",
            title="Transmittance of three channels by one free path",
            make=lambda: SpectralTransmittance(blood, half),
            reference=lambda: transmittance(Medium(blood, (0.0,) * 3), _to(half)),
            variance=lambda: _spectral_variance(blood, half),
            cost=lambda: 1.0,
            oracle="transmittance",
            source="Veach & Guibas 1995, balance heuristic of one sample",
            twin=Twin(
                "every channel is divided by the probability of the drawn channel alone",
                lambda: _chosen_channel_only(blood, half),
            ),
        ),
        _fog_case(
            "haze",
            "Fog before a bright background",
            haze,
            7.0,
            0.8,
            1.5,
            "the weights of the lerp are exchanged",
            lambda: _swapped(haze, 4.0, 0.8, 1.5),
        ),
        _fog_case(
            "glowing",
            "Fog that emits",
            glowing,
            1.5,
            0.5,
            0.1,
            "emission lacks the factor sigma_a",
            lambda: AnalogFog(Medium(0.4, 0.6, emission=5.0), _to(1.5), 0.5, 0.1),
        ),
        _fog_case(
            "endless",
            "Fog on a ray without end",
            medium,
            endless,
            1.0,
            9.0,
            "the albedo is forgotten",
            lambda: AnalogFog(Medium(0.0, 0.8), _to(endless), 1.0, 9.0),
            variance=0.0,
        ),
        _fog_case(
            "furnace",
            "Furnace: albedo 1, ambient = background = 1",
            Medium(0.0, 0.7),
            2.0,
            1.0,
            1.0,
            "a tenth of the scattering is lost",
            lambda: AnalogFog(Medium(0.07, 0.63), _to(2.0), 1.0, 1.0),
            variance=0.0,
        ),
        _fog_case(
            "thermal-furnace",
            "Thermal furnace: emission = ambient = background = 1, extinction that grows",
            LinearMedium(0.1, (0, 0, 0.4), 0.6, emission=1.0),
            2.0,
            1.0,
            1.0,
            "the emission is multiplied by the albedo",
            lambda: AnalogFog(LinearMedium(0.1, (0, 0, 0.4), 0.6, emission=0.6 / 0.4), _to(2.0), 1.0, 1.0),
            variance=0.0,
        ),
        _fog_case(
            "linear",
            "Fog that grows linearly, and emits",
            rising,
            2.5,
            0.4,
            2.0,
            "the optical depth lacks the half of the quadratic term",
            lambda: AnalogFog(LinearMedium(0.1, (0, 0, 0.8), 0.6, emission=1.5), _to(2.5), 0.4, 2.0),
        ),
        _fog_case(
            "exponential",
            "Atmosphere before the sky",
            air,
            endless,
            1.0,
            0.02,
            "the scale height is halved",
            lambda: AnalogFog(ExponentialMedium(0.8, (0, 0, -0.4), 0.9), _to(endless), 1.0, 0.02),
        ),
        _fog_case(
            "opengl-exp",
            "OpenGL fog, mode EXP",
            OpenGLFog("exp", density=0.35),
            2.0,
            0.7,
            0.1,
            "the factor of mode EXP2",
            lambda: AnalogFog(OpenGLFog("exp2", density=0.35), _to(2.0), 0.7, 0.1),
        ),
        _fog_case(
            "opengl-exp2",
            "OpenGL fog, mode EXP2",
            OpenGLFog("exp2", density=0.35),
            2.0,
            0.7,
            0.1,
            "2^-x in place of e^-x",
            lambda: AnalogFog(OpenGLFog("exp2", density=0.35 * np.sqrt(np.log(2))), _to(2.0), 0.7, 0.1),
        ),
        _fog_case(
            "opengl-linear",
            "OpenGL fog, mode LINEAR",
            OpenGLFog("linear", start=1.0, end=9.0),
            4.0,
            0.7,
            0.1,
            "the start of the fog is ignored",
            lambda: AnalogFog(OpenGLFog("linear", start=0.0, end=9.0), _to(4.0), 0.7, 0.1),
        ),
        _fog_case(
            "haze",
            "Fog by a collision that is certain, no noise left",
            haze,
            7.0,
            0.8,
            1.5,
            "the density of the collision is not renormalised",
            lambda: _not_renormalised(CertainCollisionFog(haze, _to(7.0), 0.8, 1.5)),
            make=CertainCollisionFog,
            variance=0.0,
        ),
        EstimatorCase(
            name="fog/spectral",
            title="Fog of three channels that emits, by one free path",
            make=lambda: HomogeneousSpectralFog(milk, _to(0.8), (0.3, 0.6, 0.9), (1.0, 0.2, 0.5)),
            reference=lambda: ambient_fog(milk, _to(0.8), (0.3, 0.6, 0.9), (1.0, 0.2, 0.5)),
            oracle="ambient_fog",
            source=_EQUATION,
            twin=Twin(
                "all channels are computed from the first",
                lambda: _every_channel_is_the_first(
                    HomogeneousSpectralFog(milk, _to(0.8), (0.3, 0.6, 0.9), (1.0, 0.2, 0.5))
                ),
            ),
        ),
        _emission_case(
            "flame",
            "Emission at a uniform place, per volume",
            flame,
            3.0,
            "only absorption is counted as extinction",
            lambda: UniformEmission(Medium(0.5, 0.0, emission=3.0), _to(3.0), False),
            times_sigma_a=False,
            variance=lambda: _doubled(flame, 3.0),
        ),
        _emission_case(
            "gas",
            "Gas that glows and does not absorb",
            gas,
            4.0,
            "the emission is multiplied by an absorption coefficient of 0",
            lambda: UniformEmission(gas, _to(4.0), True),
            times_sigma_a=False,
            variance=lambda: 0.0,
        ),
        _emission_case(
            "hot",
            "Emission of a medium that thins out linearly",
            hot,
            6.0,
            "the emission is multiplied by sigma_t, not by sigma_a",
            lambda: _times_sigma_t(hot, 6.0),
        ),
        _emission_case(
            "atmosphere",
            "Emission of an atmosphere",
            ExponentialMedium(0.8, (0, 0, -0.2), 0.9, emission=1.0),
            10.0,
            "the extinction at the ground is taken for the whole path",
            lambda: UniformEmission(Medium(0.08, 0.72, emission=1.0), _to(10.0)),
        ),
    ]
