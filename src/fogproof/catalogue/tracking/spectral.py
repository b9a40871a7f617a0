"""Trackers that follow all channels of a medium at once."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import (
    ambient_fog,
    transmittance,
    transmittance_variance,
)
from fogproof.catalogue.cases import Case, Drawn, EstimatorCase, Twin
from fogproof.catalogue.tracking.scenes import COLOURS, MILLER, NOVAK, RAY, cloud, distance_case
from fogproof.contracts import Draws
from fogproof.estimators import DeltaFreePath, RatioTransmittance, SpectralFog, SpectralFreePath
from fogproof.scene import LinearMedium


def cases() -> list[Case]:
    """Return the cases of many colours at once."""
    grid, channels = cloud("trilinear", 3), 3
    ambient, background = (0.8, 1.0, 1.3), (1.5, 0.5, 0.1)

    def hero_for_all(rng: np.random.Generator, n: int) -> np.ndarray:
        value = np.asarray(SpectralFog(grid, RAY, 0.0, 1.0).draw(rng, n).value)
        return np.repeat(value[:, :1], channels, axis=1)

    def without_weights(rng: np.random.Generator, n: int) -> np.ndarray:
        draw = SpectralFreePath(COLOURS, RAY).sample(rng, n)
        assert draw.event is not None
        return np.where(draw.event[:, None] == 1, background, np.multiply(COLOURS.albedo, ambient))

    def densest_only(rng: np.random.Generator, n: int) -> np.ndarray:
        first = LinearMedium(0.9, (0.3, 0.2, 0.4))
        return DeltaFreePath(first, RAY).sample(rng, n).x

    def ratio_twin(rng: np.random.Generator, n: int) -> Draws:
        draws = RatioTransmittance(COLOURS, RAY, 2.0).draw(rng, n)
        return draws._replace(value=np.asarray(draws.value)[:, ::-1])

    return [
        EstimatorCase(
            name="tracking/spectral/transmittance",
            title="Spectral tracking, trilinear voxels of three channels",
            make=lambda: SpectralFog(grid, RAY, 0.0, 1.0),
            reference=lambda: transmittance(grid, RAY),
            oracle="transmittance",
            source=MILLER,
            twin=Twin("all channels have the weight of the first", lambda: Drawn(hero_for_all)),
        ),
        EstimatorCase(
            name="tracking/spectral/fog",
            title="Fog of three colours by spectral tracking, linear extinction",
            make=lambda: SpectralFog(COLOURS, RAY, ambient, background),
            reference=lambda: ambient_fog(COLOURS, RAY, ambient, background),
            oracle="ambient_fog",
            source=MILLER,
            twin=Twin("the weights are left out", lambda: Drawn(without_weights)),
        ),
        EstimatorCase(
            name="tracking/spectral/ratio",
            title="Ratio tracking of three channels at once",
            make=lambda: RatioTransmittance(COLOURS, RAY, 2.0),
            reference=lambda: transmittance(COLOURS, RAY),
            variance=lambda: transmittance_variance(COLOURS, RAY, "ratio", 2.0),
            cost=lambda: 2.0 * 1.75,
            oracle="transmittance, transmittance_variance",
            source=NOVAK,
            twin=Twin("channels in the opposite order", lambda: Drawn(ratio_twin)),
        ),
        distance_case(
            "spectral/free-path",
            "Distances of spectral tracking: the mean of the channels' densities",
            lambda: SpectralFreePath(COLOURS, RAY),
            COLOURS,
            RAY,
            MILLER,
            "the first channel decides always",
            densest_only,
        ),
    ]
