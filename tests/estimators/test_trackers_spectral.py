"""Protects: one path serves all channels, each with its own exact transmittance, and no weight above the number of channels."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest
from tracker_media import OBLIQUE, voxels, waves

from fogproof import check_estimator, check_sampler
from fogproof.analytic import (
    ambient_fog,
    coefficients,
    optical_thickness,
    transmittance,
)
from fogproof.errors import FogproofError, InvalidValueError
from fogproof.estimators import (
    CompiledField,
    MajorantGrid,
    RatioTransmittance,
    SpectralFog,
    SpectralFreePath,
    spectral_tracking,
)
from fogproof.scene import ExponentialMedium, LinearMedium, Procedural, Ray, VoxelGrid

colours = CompiledField(
    numba.njit(lambda x, y, z, c: (1 + 0.8 * np.sin(3 * x + 1) * np.sin(2 * y + z)) * (0.4 + 0.3 * c)), 3
)
MEDIA = {
    "linear": LinearMedium((0.5, 1.5, 0.1), ((0.1, 0.2, 0.3), (0.0, -0.1, 0.1), (0, 0, 0)), (0.9, 0.5, 0.2)),
    "exponential": ExponentialMedium((0.5, 0.2), (0.1, 0.3, -0.8), 0.7),
    "nearest": VoxelGrid(voxels((4, 5, 6, 3)).sigma_t, (-1, -0.7, -1.3), (0.9, 1.1, 1.2), "nearest", 0.8),
    "trilinear": voxels((4, 5, 6, 3)),
    "compiled": Procedural(colours, 1.8, channels=3, detail=0.5),
    "one channel": voxels((4, 5, 6, 1)),
}


@pytest.mark.parametrize("name", MEDIA)
def test_weights_make_every_channel_right(name: str) -> None:
    medium = MEDIA[name]
    ambient, background = np.linspace(0.5, 2.0, medium.channels), np.linspace(1.0, 0.2, medium.channels)
    for ambient_, background_ in ((0.0, 1.0), (tuple(ambient), tuple(background))):
        reference = ambient_fog(medium, OBLIQUE, ambient_, background_)
        estimator = SpectralFog(medium, OBLIQUE, ambient_, background_)
        verdict = check_estimator(estimator.draw, reference, samples=300_000, alpha=1e-9)
        assert verdict.outcome == "not rejected", str(verdict)


def test_with_blocks_and_with_a_loose_majorant() -> None:
    medium = MEDIA["trilinear"]
    reference = transmittance(medium, OBLIQUE)
    for majorant in (MajorantGrid.of(medium, 2), 8.0):
        verdict = check_estimator(
            SpectralFog(medium, OBLIQUE, 0.0, 1.0, majorant).draw, reference, samples=300_000, alpha=1e-9
        )
        assert verdict.outcome == "not rejected", str(verdict)


@pytest.mark.parametrize("name", ["linear", "trilinear", "compiled"])
def test_no_weight_exceeds_the_number_of_channels(name: str) -> None:
    flights = spectral_tracking(
        MEDIA[name], Ray(OBLIQUE.origin, OBLIQUE.direction, np.full(50_000, 1.5)), np.random.default_rng(3)
    )
    assert np.all((flights.weight >= 0) & (flights.weight <= 3 * (1 + 1e-12)))
    assert np.allclose(flights.weight.mean(axis=-1), 1, rtol=1e-12)


def test_distances_come_from_the_mean_density() -> None:
    medium = MEDIA["linear"]
    sampler = SpectralFreePath(medium, OBLIQUE)

    def cdf(t: np.ndarray) -> np.ndarray:
        through = transmittance(medium, Ray(OBLIQUE.origin, OBLIQUE.direction, np.maximum(t, 1e-300))).value
        return np.where(t >= 1.5, 1.0, 1 - through.mean(axis=-1))

    verdict = check_sampler(
        sampler.sample, sampler.pdf, sampler.domain, dimensions=None, atoms=sampler.atoms, cdf=cdf, samples=200_000
    )
    assert verdict.outcome == "not rejected", str(verdict)


def test_equal_channels_are_grey() -> None:
    """With nothing to tell the channels apart every weight is 1, and ratio tracking multiplies the same factors."""
    grey = voxels((4, 5, 6))
    three = VoxelGrid(np.repeat(grey.sigma_t[..., None], 3, axis=-1), grey.lower, grey.upper)
    draw = SpectralFreePath(three, OBLIQUE).sample(np.random.default_rng(0), 1000)
    assert np.allclose(draw.weight, 1, rtol=1e-12)
    one, many = (RatioTransmittance(m, OBLIQUE).draw(np.random.default_rng(1), 1000) for m in (grey, three))
    assert np.array_equal(np.repeat(one.value[:, None], 3, axis=-1), many.value)
    assert np.array_equal(one.cost, many.cost)


def test_ratio_tracking_in_all_channels_has_the_variance_of_each() -> None:
    medium, majorant = MEDIA["linear"], 2.0
    reference = transmittance(medium, OBLIQUE)
    variance = []
    for c in range(3):

        def integrand(x: np.ndarray, c: int = c) -> np.ndarray:
            return coefficients(medium, x, OBLIQUE.direction).sigma_t[..., c] ** 2 / majorant

        excess = optical_thickness(Procedural(integrand, 1e3, detail=0.1), OBLIQUE).value
        variance.append(reference.value[c] ** 2 * np.expm1(excess))
    exact: Any = type(reference)(np.array(variance), np.zeros(3), "", "")
    estimator = RatioTransmittance(medium, OBLIQUE, majorant)
    verdict = check_estimator(estimator.draw, reference, variance=exact, cost=3.0, samples=1_000_000, alpha=1e-9)
    assert verdict.outcome == "not rejected", str(verdict)


def test_what_it_cannot_do_is_said() -> None:
    rng = np.random.default_rng(0)
    with pytest.raises(FogproofError, match="CompiledField"):
        SpectralFog(Procedural(lambda x: np.stack([waves(x)] * 2, axis=-1), 1.8, channels=2), OBLIQUE, 0.0, 1.0).draw(
            rng, 2
        )
    with pytest.raises(InvalidValueError, match="majorant must bound"):
        SpectralFog(MEDIA["linear"], OBLIQUE, 0.0, 1.0, 0.6).draw(rng, 1000)
    uneven = VoxelGrid(np.ones((2, 2, 2, 2)), (-1, -1, -1), (1, 1, 1), albedo=np.full((2, 2, 2), 0.5))
    with pytest.raises(FogproofError, match="albedo"):
        SpectralFog(uneven, OBLIQUE, 0.0, 1.0).draw(rng, 10)
