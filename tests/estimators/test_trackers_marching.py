"""Protects: what is said of ray marching is true: how large its bias is, how fast it falls, and what step a medium needs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tracker_media import MEDIA, OBLIQUE, unit, voxels, waves

from fogproof import check_sampler
from fogproof.analytic import (
    optical_thickness,
    transmittance,
)
from fogproof.errors import FogproofError
from fogproof.estimators import MarchedFreePath, MarchedTransmittance, RayMarch, feature_size
from fogproof.scene import ExponentialMedium, LinearMedium, Medium, OpenGLFog, Procedural, Ray, VoxelGrid

UP = Ray((0, 0, 0), (0, 0, 1), 2.0)


def depth(medium: Any, ray: Ray, steps: int, rule: Any = "midpoint") -> float:
    return float(RayMarch(medium, ray, float(ray.length) / steps, rule).depths[-1, 0])


@pytest.mark.parametrize("steps", [1, 7, 64])
@pytest.mark.parametrize("k", [-3.0, 0.7])
def test_the_bias_in_an_exponential_medium_is_a_geometric_sum(k: float, steps: int) -> None:
    medium = ExponentialMedium(0.8, (0.0, 0.0, k))
    x, tau = k * 2.0 / steps, float(optical_thickness(medium, UP).value)
    assert depth(medium, UP, steps) == pytest.approx(tau * (x / 2) / np.sinh(x / 2), rel=1e-13)
    assert depth(medium, UP, steps, "right") == pytest.approx(tau * x / -np.expm1(-x), rel=1e-13)


@pytest.mark.parametrize("name", ["exponential", "waves"])
def test_the_order_of_the_bias(name: str) -> None:
    tau = float(optical_thickness(MEDIA[name], OBLIQUE).value)
    for rule, order in (("midpoint", 2), ("right", 1)):
        bias = [abs(depth(MEDIA[name], OBLIQUE, steps, rule) - tau) for steps in (256, 512, 1024)]
        assert np.log2(np.divide(bias[:-1], bias[1:])) == pytest.approx(order, abs=0.02)


def test_midpoints_are_exact_in_linear_extinction() -> None:
    medium = LinearMedium(0.5, (0.1, 0.2, 0.3))
    draws = MarchedTransmittance(medium, OBLIQUE).draw(np.random.default_rng(0), 3)
    assert np.allclose(draws.value, transmittance(medium, OBLIQUE).value, rtol=1e-15)
    assert draws.cost.tolist() == [1, 1, 1]


def test_the_step_follows_from_what_the_medium_holds() -> None:
    grid = VoxelGrid(np.ones((4, 8, 16)), (0, 0, 0), (1, 1, 1))
    assert feature_size(grid, Ray((0, 0, 0), (1, 0, 0))) == 0.25
    assert feature_size(grid, Ray((0, 0, 0), (0, 0, -1))) == 1 / 16
    assert feature_size(grid, Ray((0, 0, 0), unit(1, 1, 1))) == pytest.approx(3**0.5 / 28)
    assert feature_size(ExponentialMedium(1.0, (0, 0, 4.0)), UP) == 0.25
    assert feature_size(ExponentialMedium(1.0, (0, 4.0, 0)), UP) == np.inf
    assert feature_size(Medium(1.0, 0.0), UP) == np.inf
    assert feature_size(Procedural(waves, 1.8, detail=0.3), UP) == 0.3
    assert feature_size(MEDIA["layers"], UP) == pytest.approx(0.3)


def test_at_the_sampling_limit_the_sum_sees_a_wave_and_below_it_does_not() -> None:
    """Two steps a period sum a sine to nothing, as they should; one step a period sums it to a constant."""
    period = 0.25
    medium = Procedural(lambda x: 1 + np.sin(2 * np.pi * x[..., 2] / period + 0.4), 2.0, detail=period / 2)
    tau = float(optical_thickness(medium, UP).value)
    assert tau == pytest.approx(2.0, rel=1e-12)
    assert float(RayMarch(medium, UP).depths[-1, 0]) == pytest.approx(tau, rel=1e-12)
    assert abs(float(RayMarch(medium, UP, period).depths[-1, 0]) - tau) > 0.3


@pytest.mark.parametrize("name", ["linear", "layers", "nearest", "trilinear", "noise", "waves in a box"])
@pytest.mark.parametrize("rule", ["midpoint", "right"])
def test_the_free_path_samples_the_steps(name: str, rule: Any) -> None:
    sampler = MarchedFreePath(MEDIA[name], OBLIQUE, 0.25, rule)

    def cdf(t: np.ndarray) -> np.ndarray:
        march = RayMarch(MEDIA[name], OBLIQUE, 0.25, rule)
        inside = np.exp(-np.interp(t, march.edges, march.depths[:, 0]))
        return np.where(t >= 1.5, 1.0, 1 - inside)

    verdict = check_sampler(
        sampler.sample,
        sampler.pdf,
        sampler.domain,
        dimensions=1,
        atoms=sampler.atoms,
        cdf=cdf,
        samples=100_000,
    )
    assert verdict.outcome == "not rejected", str(verdict)


def test_the_free_path_converges_to_the_medium() -> None:
    t = np.linspace(0.01, 1.49, 200)
    truth = transmittance(MEDIA["waves"], Ray(OBLIQUE.origin, OBLIQUE.direction, t)).value
    x = OBLIQUE.origin + t[:, None] * OBLIQUE.direction
    off = [
        np.abs(MarchedFreePath(MEDIA["waves"], OBLIQUE, h).pdf(t) - waves(x) * truth).max() for h in (0.1, 0.05, 0.025)
    ]
    assert off[0] / off[1] == pytest.approx(
        2, rel=0.2
    )  # constant steps: the density is off by order h, its integral by h^2
    assert off[1] / off[2] == pytest.approx(2, rel=0.2)


def test_rays_that_miss_cost_nothing() -> None:
    missed = Ray((5, 5, 5), (1, 0, 0), 2.0)
    draws = MarchedTransmittance(voxels(), missed).draw(np.random.default_rng(0), 2)
    assert draws.value.tolist() == [1, 1]
    assert draws.cost.tolist() == [0, 0]
    sampler = MarchedFreePath(voxels(), missed)
    assert sampler.atoms == {2.0: 1.0}
    assert sampler.sample(np.array([[0.0], [0.5], [1 - 2**-53]])).x.tolist() == [2, 2, 2]
    assert sampler.pdf(np.array([0.5, 1.0])).tolist() == [0, 0]


def test_many_colours() -> None:
    medium = LinearMedium((0.5, 0.2), ((0.1, 0.2, 0.3), (0.0, -0.1, 0.1)))
    draws = MarchedTransmittance(medium, OBLIQUE).draw(np.random.default_rng(0), 4)
    assert np.allclose(draws.value, transmittance(medium, OBLIQUE).value, rtol=1e-14)
    assert draws.value.shape == (4, 2)


BAD = {
    "no detail": (lambda: RayMarch(Procedural(waves, 1.8), UP), "detail"),
    "step 0": (lambda: RayMarch(MEDIA["linear"], UP, 0.0), "step"),
    "too many steps": (lambda: RayMarch(MEDIA["linear"], UP, 1e-12).depths, "steps"),
    "unknown rule": (lambda: RayMarch(MEDIA["linear"], UP, 0.1, "left"), "rule"),
    "infinite ray": (lambda: RayMarch(MEDIA["linear"], Ray((0, 0, 0), (0, 0, 1)), 0.1).depths, "length"),
    "unknown medium": (lambda: feature_size(OpenGLFog("exp2"), UP), "OpenGLFog"),
    "channels": (lambda: MarchedFreePath(Medium((1.0, 2.0), 0.0), UP), "channels"),
    "free path without end": (lambda: MarchedFreePath(voxels(), Ray((0, 0, 0), (0, 0, 1))), "length"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused_with_a_reason(name: str) -> None:
    make, words = BAD[name]
    with pytest.raises(FogproofError, match=words):
        make()
