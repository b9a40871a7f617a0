"""Estimators of transmittance and of ambient fog against the oracle's closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import ambient_fog, transmittance
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.estimators import AnalogFog, AnalogTransmittance
from fogproof.scene import Medium, Ray

_START = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def _transmittance_case(name: str, title: str, medium: Medium, length: float, twin: Twin) -> EstimatorCase:
    return EstimatorCase(
        name=f"transmittance/analog/{name}",
        title=title,
        make=lambda: AnalogTransmittance(float(medium.sigma_t), length),
        reference=lambda: transmittance(medium, Ray(*_START, length)),
        oracle="transmittance",
        source="Beer-Lambert law",
        twin=twin,
    )


def _fog_case(
    name: str,
    title: str,
    medium: Medium,
    length: float,
    ambient: float,
    background: float,
    error: str,
    twin: Callable[[], Any],
    **more: Any,
) -> EstimatorCase:
    return EstimatorCase(
        name=f"fog/analog/{name}",
        title=title,
        make=lambda: AnalogFog(medium, length, ambient, background),
        reference=lambda: ambient_fog(medium, Ray(*_START, length), ambient, background),
        oracle="ambient_fog",
        source="volume rendering equation with constant in-scattered radiance",
        twin=Twin(error, twin),
        **more,
    )


def _swapped(fog: AnalogFog) -> Drawn:
    """The lerp with its weights exchanged: fog where the background should be."""
    turned = AnalogFog(Medium(fog.medium.sigma_a, fog.medium.sigma_s), fog.length, 0.0, 1.0)

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        reached = np.asarray(turned.draw(rng, n).value)
        albedo = float(fog.medium.albedo)
        return np.where(reached == 1, albedo * fog.ambient, fog.background)

    return Drawn(draw)


def cases() -> list[EstimatorCase]:
    """Return the cases of transmittance and fog."""
    medium = Medium(0.3, 0.5)
    glowing = Medium(0.4, 0.6, emission=2.0)
    haze = Medium(0.02, 0.08)
    return [
        _transmittance_case(
            "thin",
            "Transmittance by free paths, tau = 0.4",
            medium,
            0.5,
            Twin("only absorption is counted as extinction", lambda: AnalogTransmittance(0.3, 0.5)),
        ),
        _transmittance_case(
            "dense",
            "Transmittance by free paths, tau = 6.4",
            medium,
            8.0,
            Twin(
                "the path is measured along an unnormalised direction, 10 % too long",
                lambda: AnalogTransmittance(0.8, 8.8),
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
            lambda: _swapped(AnalogFog(haze, 4.0, 0.8, 1.5)),
        ),
        _fog_case(
            "glowing",
            "Fog that emits",
            glowing,
            1.5,
            0.5,
            0.1,
            "emission lacks the factor sigma_a",
            lambda: AnalogFog(Medium(0.4, 0.6, emission=5.0), 1.5, 0.5, 0.1),
        ),
        _fog_case(
            "endless",
            "Fog on a ray without end",
            medium,
            np.inf,
            1.0,
            9.0,
            "the albedo is forgotten",
            lambda: AnalogFog(Medium(0.0, 0.8), np.inf, 1.0, 9.0),
            options={"variance": 0.0},
        ),
        _fog_case(
            "furnace",
            "Furnace: albedo 1, ambient = background = 1",
            Medium(0.0, 0.7),
            2.0,
            1.0,
            1.0,
            "a tenth of the scattering is lost",
            lambda: AnalogFog(Medium(0.07, 0.63), 2.0, 1.0, 1.0),
            options={"variance": 0.0},
        ),
    ]
