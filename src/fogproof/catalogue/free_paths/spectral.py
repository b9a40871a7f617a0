"""Free paths of several channels at once against the oracle."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.free_paths.builders import (
    free_path_case,
)
from fogproof.contracts import Draw
from fogproof.estimators import FreePath, HomogeneousSpectralFreePath
from fogproof.scene import Medium


def _spectral(
    name: str,
    title: str,
    sigma_t: tuple[float, ...],
    surface: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
) -> SamplerCase:
    medium = Medium(sigma_t, (0.0,) * len(sigma_t))

    def make() -> HomogeneousSpectralFreePath:
        return HomogeneousSpectralFreePath(sigma_t, surface)

    source = "Veach & Guibas 1995, balance heuristic of one sample"
    return free_path_case(f"spectral/{name}", title, medium, make, error, sample, pdf, source=source)


def _chosen_channel(sampler: HomogeneousSpectralFreePath, u: np.ndarray) -> Draw:
    """Everything is divided by the density of the channel that was drawn."""
    draw = sampler.sample(u)
    sigma = np.array(sampler.sigma_t)[(u[:, 0] * len(sampler.sigma_t)).astype(int)]
    pdf = np.where(draw.event == 1, np.exp(-sigma * draw.x), sigma * np.exp(-sigma * draw.x))
    return draw._replace(pdf=pdf, weight=sampler.eval(draw.x) / pdf[:, None])


def _channel_zero(sampler: HomogeneousSpectralFreePath, u: np.ndarray) -> Draw:
    draw = sampler.sample(u)
    assert draw.weight is not None
    return draw._replace(weight=np.repeat(draw.weight[:, :1], draw.weight.shape[1], axis=1))


def _mean_extinction(sampler: HomogeneousSpectralFreePath, u: np.ndarray) -> np.ndarray:
    return FreePath(float(np.mean(sampler.sigma_t)), sampler.surface).sample(u[:, 1:]).x


def cases() -> list[SamplerCase]:
    """Return the cases of several channels."""
    milk = (0.8, 1.5, 4.0)
    return [
        _spectral(
            name="unbounded",
            title="Free path of three channels, no surface",
            sigma_t=milk,
            surface=np.inf,
            error="the path is drawn with the mean extinction",
            sample=_mean_extinction,
        ),
        _spectral(
            name="surface",
            title="Free path of three channels before a surface",
            sigma_t=milk,
            surface=0.9,
            error="the density is that of the chosen channel, not the mean of all",
            sample=_chosen_channel,
        ),
        _spectral(
            name="weights",
            title="Free path of three channels, one of them clear",
            sigma_t=(0.0, 0.7, 2.0),
            surface=1.6,
            error="the weights of all channels are those of the first",
            sample=_channel_zero,
        ),
    ]
