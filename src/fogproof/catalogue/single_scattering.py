"""Single-scattering estimators against the oracle's airlight."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import single_scattering
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.estimators import EquiangularAirlight, FreePathAirlight
from fogproof.scene import HenyeyGreenstein, Medium, PhaseFunction, PointLight, Ray, Rayleigh

_RAY = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 5.0)
_LIGHT = PointLight((0.6, -0.8, 0.5), 3.0)
_CLOSE = PointLight((0.0, 0.01, 0.5), 3.0)


def _case(
    name: str,
    title: str,
    make: Any,
    medium: Medium,
    light: PointLight,
    error: str,
    twin: Callable[[], Any],
    samples: int,
    ray: Ray = _RAY,
) -> EstimatorCase:
    return EstimatorCase(
        name=f"airlight/{name}",
        title=title,
        make=lambda: make(medium, ray, light),
        reference=lambda: single_scattering(medium, ray, light),
        oracle="single_scattering",
        source="Kulla & Fajardo 2012"
        if make is EquiangularAirlight
        else "volume rendering equation, one-sample estimator",
        twin=Twin(error, twin),
        samples=samples,
    )


def _scaled(original: Any, factor: Callable[[np.random.Generator, int], Any]) -> Drawn:
    return Drawn(lambda rng, n: np.asarray(original.draw(rng, n).value) * factor(rng, n))


def cases() -> list[EstimatorCase]:
    """Return the single-scattering cases."""

    def medium(phase: PhaseFunction | None = None) -> Medium:
        return Medium(0.1, 0.4, phase) if phase else Medium(0.1, 0.4)

    forward, backward, rayleigh = medium(HenyeyGreenstein(0.6)), medium(HenyeyGreenstein(-0.7)), medium(Rayleigh())
    endless = Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0))
    equiangular, free_path = EquiangularAirlight, FreePathAirlight
    return [
        _case(
            "equiangular/isotropic",
            "Airlight, equiangular, isotropic",
            equiangular,
            medium(),
            _LIGHT,
            "sigma_s is missing",
            lambda: _scaled(equiangular(medium(), _RAY, _LIGHT), lambda rng, n: 1 / 0.4),
            1_000_000,
        ),
        _case(
            "equiangular/forward",
            "Airlight, equiangular, Henyey-Greenstein g = 0.6",
            equiangular,
            forward,
            _LIGHT,
            "the sign of the scattering cosine",
            lambda: equiangular(medium(HenyeyGreenstein(-0.6)), _RAY, _LIGHT),
            1_000_000,
        ),
        _case(
            "equiangular/backward",
            "Airlight, equiangular, Henyey-Greenstein g = -0.7",
            equiangular,
            backward,
            _LIGHT,
            "isotropic scattering for g < 0",
            lambda: equiangular(medium(), _RAY, _LIGHT),
            1_000_000,
        ),
        _case(
            "equiangular/rayleigh",
            "Airlight, equiangular, Rayleigh",
            equiangular,
            rayleigh,
            _LIGHT,
            "the segment starts a metre late",
            lambda: equiangular(rayleigh, Ray((0.0, 0.0, -1.0), (0.0, 0.0, 1.0), 4.0), _LIGHT),
            1_000_000,
        ),
        _case(
            "equiangular/close",
            "Airlight, equiangular, light a centimetre from the ray",
            equiangular,
            medium(),
            _CLOSE,
            "the light is two centimetres away",
            lambda: equiangular(medium(), _RAY, PointLight((0.0, 0.02, 0.5), 3.0)),
            1_000_000,
        ),
        _case(
            "equiangular/endless",
            "Airlight, equiangular, ray without end",
            equiangular,
            forward,
            _LIGHT,
            "the ray is cut at the light",
            lambda: equiangular(forward, Ray((0.0, 0.0, -2.0), (0.0, 0.0, 1.0), 2.5), _LIGHT),
            1_000_000,
            endless,
        ),
        _case(
            "free-path/isotropic",
            "Airlight, free path, isotropic",
            free_path,
            medium(),
            _LIGHT,
            "the flux is taken for the intensity",
            lambda: _scaled(free_path(medium(), _RAY, _LIGHT), lambda rng, n: 4 * np.pi),
            2_000_000,
        ),
        _case(
            "free-path/forward",
            "Airlight, free path, Henyey-Greenstein g = 0.6",
            free_path,
            forward,
            _LIGHT,
            "a branch taken half the time is not divided by its probability",
            lambda: _scaled(free_path(forward, _RAY, _LIGHT), lambda rng, n: rng.random(n) < 0.5),
            4_000_000,
        ),
        _case(
            "free-path/rayleigh",
            "Airlight, free path, Rayleigh",
            free_path,
            rayleigh,
            _LIGHT,
            "the albedo is applied twice",
            lambda: _scaled(free_path(rayleigh, _RAY, _LIGHT), lambda rng, n: 0.8),
            2_000_000,
        ),
    ]
