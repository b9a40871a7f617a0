"""Equiangular sampling against the law that defines it: the angle seen from the light is uniform."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import (
    airlight_integral,
    transmittance,
)
from fogproof.catalogue.cases import Altered, SamplerCase, Twin
from fogproof.contracts import Draw, Reference
from fogproof.estimators import Equiangular, LitMedium, placer
from fogproof.scene import Medium, PointLight, Ray


def _density(h: float, a: float, b: float) -> Callable[[np.ndarray], Reference]:
    """The density is the airlight integrand of a medium without extinction, 1 / (h^2 + t^2), over its integral."""

    def reference(t: np.ndarray) -> Reference:
        whole = airlight_integral(0.0, h, a, b)
        value = 1 / (h * h + t * t) / whole.value
        return Reference(value, value * (whole.error / whole.value + 1e-15), whole.method, "Kulla & Fajardo 2012")

    return reference


def _case(
    name: str, title: str, h: float, a: float, b: float, error: str, sample: Any = None, pdf: Any = None, **options: Any
) -> SamplerCase:
    def make() -> Equiangular:
        return Equiangular(h, a, b)

    return SamplerCase(
        name=f"equiangular/{name}",
        title=title,
        make=make,
        reference=_density(h, a, b),
        oracle="airlight_integral at sigma_t = 0",
        source="Kulla & Fajardo 2012",
        twin=Twin(error, lambda: Altered(make(), sample, pdf)),
        options=options,
    )


def _mean_of_both(h: float, a: float, b: float, sigma_t: float) -> Callable[[np.ndarray], Reference]:
    """Half of an equiangular place, half of a free path that ends on the segment, t counted from its start."""

    def reference(t: np.ndarray) -> Reference:
        first, ray = _density(h, a, b)(t + a), Ray((0, 0, 0), (0, 0, 1), np.maximum(t, np.finfo(float).tiny))
        through, whole = transmittance(Medium(sigma_t, 0.0), ray), transmittance(Medium(sigma_t, 0.0), _to(b - a))
        second = sigma_t * through.value / (1 - whole.value)
        error = 0.5 * (first.error + second * (through.error / through.value + whole.error / (1 - whole.value) + 1e-15))
        return Reference(0.5 * (first.value + second), error + 2e-15, first.method, "Veach & Guibas 1995")

    return reference


def _to(length: float) -> Ray:
    return Ray((0, 0, 0), (0, 0, 1), length)


def _mixed(h: float, a: float, b: float, sigma_t: float) -> Any:
    light = PointLight((h, 0.0, -a), 1.0)
    return placer(LitMedium(Medium(0.0, sigma_t), _to(b - a), light), "mixed")


def _chosen_density(sampler: Any, u: np.ndarray) -> Draw:
    """The density of the sampler that the coin chose, as if there were no other."""
    draw = sampler.sample(u)
    chosen = np.where(u[:, 0] < 0.5, sampler.first.pdf(draw.x), sampler.second.pdf(draw.x))
    return draw._replace(pdf=chosen)


def _uniform(sampler: Equiangular, u: np.ndarray) -> np.ndarray:
    return sampler.a + (sampler.b - sampler.a) * u[:, 0]


def _without_h(sampler: Equiangular, t: np.ndarray) -> np.ndarray:
    return sampler.pdf(t) / sampler.h


def _from_camera(sampler: Equiangular, u: np.ndarray) -> np.ndarray:
    return np.minimum(sampler.sample(u).x - sampler.a, sampler.b)


def _mirrored(sampler: Equiangular, u: np.ndarray) -> np.ndarray:
    return np.maximum(-sampler.sample(u).x, sampler.a)


def cases() -> list[SamplerCase]:
    """Return the equiangular cases."""
    return [
        _case("beside", "Equiangular, light beside the ray", 0.5, -1.0, 3.0, "uniform in t", _uniform),
        _case(
            "grazing",
            "Equiangular, light a millimetre from the ray",
            1e-3,
            -1.0,
            2.0,
            "the density lacks the factor h",
            None,
            _without_h,
        ),
        _case("behind", "Equiangular, light far behind the camera", 1e-3, 50.0, 60.0, "uniform in t", _uniform),
        _case(
            "ahead",
            "Equiangular, light beyond the surface",
            0.2,
            -4.0,
            -1.0,
            "t counted from the camera, not the foot",
            _from_camera,
        ),
        _case("infinite", "Equiangular on a ray without end", 2.0, -3.0, np.inf, "the sign of t is lost", _mirrored),
        _case(
            "float32",
            "Equiangular in single precision, light beside the ray",
            0.05,
            -1.0,
            3.0,
            "t counted from the camera, not the foot",
            _from_camera,
            precision="float32",
        ),
        SamplerCase(
            name="equiangular/mixed",
            title="Equiangular or free path by a coin",
            make=lambda: _mixed(0.3, -1.5, 2.5, 0.8),
            reference=_mean_of_both(0.3, -1.5, 2.5, 0.8),
            oracle="airlight_integral at sigma_t = 0, transmittance",
            source="Veach & Guibas 1995; Kulla & Fajardo 2012",
            twin=Twin(
                "the density returned is that of the chosen sampler alone",
                lambda: Altered(_mixed(0.3, -1.5, 2.5, 0.8), _chosen_density),
            ),
        ),
    ]
