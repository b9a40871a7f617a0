"""Free-path samplers against the oracle's transmittance: a density before the surface, a probability at it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import transmittance
from fogproof.catalogue.cases import Altered, SamplerCase, Twin
from fogproof.contracts import Draw, Reference
from fogproof.estimators import HomogeneousFreePath
from fogproof.scene import Medium, Ray

_FORWARD = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def _transmittance(sigma_t: float, t: np.ndarray) -> Reference:
    """Return the oracle's transmittance to distances t (n,), 1 at t = 0."""
    positive = np.maximum(t, np.finfo(float).tiny)
    return transmittance(Medium(sigma_t, 0.0), Ray(*_FORWARD, positive))


def _density(sigma_t: float) -> Callable[[np.ndarray], Reference]:
    """The density of collisions is sigma_t T(t): minus the derivative of the transmittance."""

    def reference(t: np.ndarray) -> Reference:
        through = _transmittance(sigma_t, t)
        value = sigma_t * through.value
        return Reference(value, sigma_t * through.error + 2e-16 * value, through.method, through.source)

    return reference


def _cdf(sigma_t: float, surface: float) -> Callable[[np.ndarray], np.ndarray]:
    def cdf(t: np.ndarray) -> np.ndarray:
        return np.where(t >= surface, 1.0, 1 - _transmittance(sigma_t, np.minimum(t, 1e300)).value)

    return cdf


def _case(
    name: str, title: str, sigma_t: float, surface: float, error: str, sample: Any = None, pdf: Any = None
) -> SamplerCase:
    def make() -> HomogeneousFreePath:
        return HomogeneousFreePath(sigma_t, surface)

    return SamplerCase(
        name=f"free-path/{name}",
        title=title,
        make=make,
        reference=_density(sigma_t),
        oracle="transmittance",
        source="Beer-Lambert law",
        twin=Twin(error, lambda: Altered(make(), sample, pdf)),
        options={"cdf": _cdf(sigma_t, surface)},
    )


def _log10(sampler: HomogeneousFreePath, u: np.ndarray) -> np.ndarray:
    return -np.log10(1 - u[:, 0]) / sampler.sigma_t


def _log_of_zero(sampler: HomogeneousFreePath, u: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return -np.log(u[:, 0]) / sampler.sigma_t


def _without_sigma(sampler: HomogeneousFreePath, t: np.ndarray) -> np.ndarray:
    return np.exp(-sampler.sigma_t * t)


def _density_at_surface(sampler: HomogeneousFreePath, u: np.ndarray) -> Draw:
    draw = sampler.sample(u)
    return draw._replace(pdf=sampler.sigma_t * np.exp(-sampler.sigma_t * draw.x))


def _leaky_surface(sampler: HomogeneousFreePath, u: np.ndarray) -> np.ndarray:
    t = sampler.sample(u).x
    stopped = (t == sampler.surface) & (u[:, 0] > 1 - 0.05 * np.exp(-sampler.sigma_t * sampler.surface))
    return np.where(stopped, 0.5 * sampler.surface, t)


def _thinned(sampler: HomogeneousFreePath, u: np.ndarray) -> np.ndarray:
    return HomogeneousFreePath(0.9 * sampler.sigma_t, sampler.surface).sample(u).x


def cases() -> list[SamplerCase]:
    """Return the free-path cases."""
    return [
        _case("unbounded", "Free path, no surface", 2.5, np.inf, "log10 instead of the natural logarithm", _log10),
        _case(
            "dense",
            "Free path, mean free path of a micrometre",
            1e6,
            np.inf,
            "-log(xi), infinite at xi = 0",
            _log_of_zero,
        ),
        _case(
            "thin",
            "Free path, mean free path of 10^9 m",
            1e-9,
            np.inf,
            "the density lacks the factor sigma_t",
            None,
            _without_sigma,
        ),
        _case(
            "surface",
            "Free path before a surface at tau = 0.7",
            1.4,
            0.5,
            "at the surface the density is returned in place of the probability",
            _density_at_surface,
        ),
        _case(
            "surface/far",
            "Free path before a surface at tau = 2",
            0.4,
            5.0,
            "5 % of the surface events are moved",
            _leaky_surface,
        ),
        _case(
            "surface/near", "Free path before a surface at tau = 0.05", 0.1, 0.5, "extinction 10 % too small", _thinned
        ),
    ]
