"""Free paths in a homogeneous medium, with and without a surface, against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.free_paths.builders import (
    density_at_surface,
    homogeneous,
    leaky_surface,
)
from fogproof.estimators import Constant, FreePath


def _sigma(sampler: FreePath) -> float:
    assert isinstance(sampler.extinction, Constant)
    return sampler.extinction.sigma_t


def _log10(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    return -np.log10(1 - u[:, 0]) / _sigma(sampler)


def _log_of_zero(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return -np.log(u[:, 0]) / _sigma(sampler)


def _without_sigma(sampler: FreePath, t: np.ndarray) -> np.ndarray:
    return np.exp(-_sigma(sampler) * t)


def _cdf_without_sigma(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    return -np.log1p(-_sigma(sampler) * u[:, 0]) / _sigma(sampler)


def _thinned(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    return FreePath(0.9 * _sigma(sampler), sampler.surface).sample(u).x


def cases() -> list[SamplerCase]:
    """Return the cases of constant extinction."""
    return [
        homogeneous(
            name="unbounded",
            title="Free path, no surface",
            sigma_t=2.5,
            surface=np.inf,
            error="log10 instead of the natural logarithm",
            sample=_log10,
        ),
        homogeneous(
            name="dense",
            title="Free path, mean free path of a micrometre",
            sigma_t=1e6,
            surface=np.inf,
            error="-log(xi), infinite at xi = 0",
            sample=_log_of_zero,
        ),
        homogeneous(
            name="thin",
            title="Free path, mean free path of 10^9 m",
            sigma_t=1e-9,
            surface=np.inf,
            error="the density lacks the factor sigma_t",
            pdf=_without_sigma,
        ),
        homogeneous(
            name="haze",
            title="Free path, mean free path of 1.25 m",
            sigma_t=0.8,
            surface=np.inf,
            error="the cdf that is inverted lacks the factor sigma_t",
            sample=_cdf_without_sigma,
        ),
        homogeneous(
            name="surface",
            title="Free path before a surface at tau = 0.7",
            sigma_t=1.4,
            surface=0.5,
            error="at the surface the density is returned in place of the probability",
            sample=density_at_surface,
        ),
        homogeneous(
            name="surface/far",
            title="Free path before a surface at tau = 2",
            sigma_t=0.4,
            surface=5.0,
            error="5 % of the surface events are moved",
            sample=leaky_surface,
        ),
        homogeneous(
            name="surface/near",
            title="Free path before a surface at tau = 0.05",
            sigma_t=0.1,
            surface=0.5,
            error="extinction 10 % too small",
            sample=_thinned,
        ),
    ]
