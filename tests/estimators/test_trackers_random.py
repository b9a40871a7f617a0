"""Protects: delta, ratio and residual ratio tracking have the oracle's mean, variance and look-ups in every medium.

Seeds are drawn afresh, and a failure prints its own; each check has a false-alarm probability of 1e-9.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest
from tracker_media import MEDIA, OBLIQUE, unit, voxels, waves

from fogproof import check_estimator, check_sampler
from fogproof.analytic import (
    coefficients,
    emitted_radiance,
    optical_thickness,
    transmittance,
)
from fogproof.errors import FogproofError, InvalidValueError, UnsupportedError
from fogproof.estimators import (
    CompiledField,
    DeltaFreePath,
    DeltaTransmittance,
    MajorantGrid,
    RatioTransmittance,
    ResidualRatioTransmittance,
    delta_tracking,
    ratio_tracking,
)
from fogproof.scene import ExponentialMedium, LinearMedium, Medium, Procedural, Ray, VoxelGrid

ALPHA = 1e-9
SAMPLES = 200_000
BOUNDS = {
    "homogeneous": 0.8,
    "linear": 1.5,
    "linear to vacuum": 1.2,
    "exponential": 1.2,
    "layers": 2.5,
    "trilinear": 3.5,
}


def passes(estimator: Any, medium: Any, ray: Ray = OBLIQUE, samples: int = SAMPLES, **more: Any) -> None:
    verdict = check_estimator(estimator.draw, transmittance(medium, ray), samples=samples, alpha=ALPHA, **more)
    assert verdict.outcome == "not rejected", str(verdict)


def squared(medium: Any, majorant: float, control: float = 0.0) -> float:
    """Return the oracle's integral of (sigma - control)^2 / majorant along the ray."""

    def integrand(x: np.ndarray) -> np.ndarray:
        return (coefficients(medium, x, OBLIQUE.direction).sigma_t - control) ** 2 / majorant

    return float(optical_thickness(Procedural(integrand, 1e6, detail=0.05), OBLIQUE).value)


def survived(medium: Any) -> float:
    """Return the oracle's integral of T along the ray: the radiance of a source of 1 W/(m^3 sr) everywhere."""

    def sigma_t(x: np.ndarray) -> np.ndarray:
        return coefficients(medium, x, OBLIQUE.direction).sigma_t

    source = Procedural(sigma_t, 1e6, detail=0.05, emission=lambda x: 1 / sigma_t(x))
    return float(emitted_radiance(source, OBLIQUE).value)


@pytest.mark.parametrize("name", MEDIA)
@pytest.mark.parametrize("make", [DeltaTransmittance, RatioTransmittance, ResidualRatioTransmittance])
def test_the_mean_is_the_transmittance(make: Any, name: str) -> None:
    passes(make(MEDIA[name], OBLIQUE), MEDIA[name])


@pytest.mark.parametrize("majorant", [2.0, 6.0])
@pytest.mark.parametrize("name", ["homogeneous", "linear", "exponential", "waves"])
def test_a_loose_majorant_costs_look_ups_and_nothing_else(name: str, majorant: float) -> None:
    through = float(transmittance(MEDIA[name], OBLIQUE).value)
    cost = majorant * survived(MEDIA[name])
    passes(DeltaTransmittance(MEDIA[name], OBLIQUE, majorant), MEDIA[name], variance=through * (1 - through), cost=cost)


@pytest.mark.parametrize("name", ["homogeneous", "linear", "exponential", "waves"])
def test_ratio_tracking_has_the_variance_and_look_ups_of_theory(name: str) -> None:
    medium, majorant = MEDIA[name], 2.0
    through = float(transmittance(medium, OBLIQUE).value)
    variance = through**2 * np.expm1(squared(medium, majorant))
    estimator: Any = RatioTransmittance(medium, OBLIQUE, majorant)
    passes(estimator, medium, samples=1_000_000, variance=variance, cost=1.5 * majorant)
    for control in (0.2, 0.5):
        residual = majorant - control
        variance = through**2 * np.expm1(squared(medium, residual, control))
        estimator = ResidualRatioTransmittance(medium, OBLIQUE, majorant, control)
        passes(estimator, medium, samples=2_000_000, variance=variance, cost=1.5 * residual)


def test_a_control_in_the_middle_halves_the_look_ups() -> None:
    medium, through = MEDIA["linear"], float(transmittance(MEDIA["linear"], OBLIQUE).value)
    ends = coefficients(
        medium, OBLIQUE.origin + np.array([[0.0], [1.5]]) * OBLIQUE.direction, OBLIQUE.direction
    ).sigma_t
    low, range_ = float(ends.min()), float(np.ptp(ends))
    variance = through**2 * np.expm1(squared(medium, range_, low))
    passes(ResidualRatioTransmittance(medium, OBLIQUE), medium, variance=variance, cost=1.5 * range_)
    passes(ResidualRatioTransmittance(medium, OBLIQUE, None, "middle"), medium, samples=1_000_000, cost=0.75 * range_)


def test_a_control_that_is_the_medium_leaves_nothing_to_chance() -> None:
    draws = ResidualRatioTransmittance(Medium(0.3, 0.5), OBLIQUE).draw(np.random.default_rng(0), 100)
    assert np.allclose(draws.value, np.exp(-1.2), rtol=1e-15)
    assert not draws.cost.any()


@pytest.mark.parametrize("interpolation", ["nearest", "trilinear"])
@pytest.mark.parametrize("block", [1, 2, 3])
@pytest.mark.parametrize("make", [DeltaTransmittance, RatioTransmittance, ResidualRatioTransmittance])
def test_majorants_in_blocks(make: Any, block: int, interpolation: str) -> None:
    grid = voxels((6, 7, 8), interpolation)
    passes(make(grid, OBLIQUE, MajorantGrid.of(grid, block)), grid)


def test_blocks_save_look_ups_where_little_is() -> None:
    sigma = np.full((32, 32, 32), 0.01)
    sigma[14:18, 14:18, 14:18] = 10.0
    grid = VoxelGrid(sigma, (-1, -1, -1), (1, 1, 1), "nearest")
    ray = Ray((-2, 0.01, 0.01), (1, 0, 0), 4.0)
    blocks = MajorantGrid.of(grid, 4)
    rng = np.random.default_rng(1)
    whole, parts = (RatioTransmittance(grid, ray, bound).draw(rng, 20_000).cost.mean() for bound in (None, blocks))
    x = np.linspace(-1, 1, 8, endpoint=False)[:, None] * [1, 0, 0] + [0.125, 0.01, 0.01]
    expected = 0.25 * blocks.at(x)[1].sum()
    assert parts == pytest.approx(expected, rel=0.05)
    assert parts < 0.6 * whole


def test_compiled_and_array_functions_follow_one_law() -> None:
    compiled = CompiledField(numba.njit(lambda x, y, z: 1 + 0.8 * np.sin(3 * x + 1) * np.sin(2 * y + z)))
    for make in (DeltaTransmittance, RatioTransmittance, ResidualRatioTransmittance):
        for field in (compiled, waves):
            medium = Procedural(field, 1.8, detail=0.5)
            passes(make(medium, OBLIQUE), medium)
    blocks = MajorantGrid(np.full((2, 2, 2), 1.8), (-2, -2, -2), (2, 2, 2))
    boxed = Procedural(compiled, 1.8, detail=0.5, lower=(-1, -1, -1), upper=(1, 1, 1))
    passes(RatioTransmittance(boxed, OBLIQUE, blocks), boxed)


def test_a_direction_dependent_medium() -> None:
    medium = Procedural(lambda x, w: 1 + 0.5 * w[..., 0] * np.sin(x[..., 2]), 1.5, directional=True, detail=0.5)
    for make in (DeltaTransmittance, RatioTransmittance):
        passes(make(medium, OBLIQUE), medium)


@pytest.mark.parametrize("name", ["linear", "exponential", "trilinear", "waves", "waves in a box"])
def test_the_distance_has_the_density_it_claims(name: str) -> None:
    sampler = DeltaFreePath(MEDIA[name], OBLIQUE)

    def cdf(t: np.ndarray) -> np.ndarray:
        rays = Ray(OBLIQUE.origin, OBLIQUE.direction, np.maximum(t, 1e-300))
        return np.where(t >= 1.5, 1.0, 1 - transmittance(MEDIA[name], rays).value)

    verdict = check_sampler(
        sampler.sample, sampler.pdf, sampler.domain, dimensions=None, atoms=sampler.atoms, cdf=cdf, samples=SAMPLES
    )
    assert verdict.outcome == "not rejected", str(verdict)


def test_a_batch_of_rays() -> None:
    grid, rng = voxels(), np.random.default_rng(4)
    rays = Ray((0.0, 0.1, 0.2), rng.normal(size=(300, 1, 3)) / 1.0 @ np.eye(3) * 0 + unit(1, 2, 2), 3.0)
    through = transmittance(grid, Ray((0.0, 0.1, 0.2), unit(1, 2, 2), 3.0)).value
    flights, draws = delta_tracking(grid, rays, rng), ratio_tracking(grid, rays, rng)
    assert flights.event.shape == draws.value.shape == draws.cost.shape == (300, 1)
    for values in (flights.event, draws.value):
        assert abs(values.mean() - through) < 8 * values.std() / 300**0.5
    chromatic = ratio_tracking(voxels((3, 4, 5, 2)), rays, rng, control="middle")
    assert chromatic.value.shape == (300, 1, 2)


def test_rays_in_faces_and_rays_that_miss() -> None:
    grid = VoxelGrid(np.full((4, 4, 4), 1.5), (-1, -1, -1), (1, 1, 1), "nearest")
    rng = np.random.default_rng(0)
    for bound in (None, 2.0, MajorantGrid.of(grid, 2), MajorantGrid.of(grid, 3)):
        for origin, direction in (((-3, 0, 0), (1, 0, 0)), ((0, 0, -1), (0, 0, 1)), ((1, 1, 1), unit(-1, -1, 0))):
            ray = Ray(origin, direction)
            expected = float(transmittance(grid, ray).value)
            value = RatioTransmittance(grid, ray, bound).draw(rng, 20_000).value
            assert abs(value.mean() - expected) <= 8 * value.std() / 20_000**0.5 + 1e-15
        missed = DeltaTransmittance(grid, Ray((-3, 5, 0), (1, 0, 0)), bound).draw(rng, 100)
        assert np.all(missed.value == 1)
        assert not missed.cost.any()


def test_vacuum_needs_no_look_ups() -> None:
    rng = np.random.default_rng(0)
    for medium in (Medium(0, 0), VoxelGrid(np.zeros((2, 2, 2)), (-1, -1, -1), (1, 1, 1))):
        for make in (DeltaTransmittance, RatioTransmittance, ResidualRatioTransmittance):
            draws = make(medium, OBLIQUE).draw(rng, 100)
            assert np.all(draws.value == 1)
            assert not draws.cost.any()


def spike(x: np.ndarray) -> np.ndarray:
    return np.where(np.abs(x[..., 2]) < 0.05, 5.0, 0.5)


SMALL_MAJORANTS = {
    "linear": (LinearMedium(0.5, (0.1, 0.2, 0.3)), 0.7),
    "exponential": (ExponentialMedium(0.5, (0.1, 0.3, -0.8)), 0.5),
    "grid": (voxels(), 1.0),
    "array function": (Procedural(spike, 1.0, detail=0.5), None),
    "compiled function": (
        Procedural(CompiledField(numba.njit(lambda x, y, z: 5.0 if abs(z) < 0.05 else 0.5)), 1.0),
        None,
    ),
    "so small that nothing is ever looked at": (Procedural(waves, 1e-12, detail=0.5), None),
    "blocks": (voxels(), MajorantGrid(np.ones((2, 2, 2)), (-1.0, -0.7, -1.3), (0.9, 1.1, 1.2))),
}


@pytest.mark.parametrize("make", [DeltaTransmittance, RatioTransmittance, ResidualRatioTransmittance])
@pytest.mark.parametrize("name", SMALL_MAJORANTS)
def test_a_majorant_that_is_too_small_is_reported(make: Any, name: str) -> None:
    medium, majorant = SMALL_MAJORANTS[name]
    with pytest.raises(InvalidValueError, match="majorant must bound sigma_t"):
        make(medium, OBLIQUE, majorant).draw(np.random.default_rng(0), 20_000)


@pytest.mark.parametrize("name", ["array function", "compiled function"])
def test_a_spike_between_the_first_looks_is_reported_by_the_tracker_that_meets_it(name: str) -> None:
    def thin(x: np.ndarray) -> np.ndarray:
        return np.where(np.abs(x[..., 2] - 0.012345) < 1e-3, 5.0, 0.5)

    compiled = CompiledField(numba.njit(lambda x, y, z: 5.0 if abs(z - 0.012345) < 1e-3 else 0.5))
    medium = Procedural({"array function": thin, "compiled function": compiled}[name], 1.0, detail=0.5)
    estimator = RatioTransmittance(medium, OBLIQUE)
    assert estimator._tracked is not None  # the first looks do not meet it
    with pytest.raises(InvalidValueError, match=r"sigma_t = 5 \[1/m\], met at t = "):
        estimator.draw(np.random.default_rng(0), 100_000)


BAD = {
    "majorant 0": (lambda: DeltaTransmittance(MEDIA["linear"], OBLIQUE, 0.0), "majorant"),
    "majorant infinite": (lambda: DeltaTransmittance(MEDIA["linear"], OBLIQUE, np.inf), "majorant"),
    "majorant negative": (lambda: RatioTransmittance(MEDIA["linear"], OBLIQUE, -1.0), "majorant"),
    "majorant NaN": (lambda: RatioTransmittance(MEDIA["linear"], OBLIQUE, np.nan), "majorant"),
    "medium's majorant 0": (lambda: RatioTransmittance(Procedural(waves, 0.0), OBLIQUE), "majorant"),
    "extinction overflows": (lambda: DeltaTransmittance(ExponentialMedium(1.0, (0, 0, 1e4)), OBLIQUE), "overflow"),
    "steps too short to be taken": (lambda: DeltaTransmittance(ExponentialMedium(1, (0, 0, 1e2)), OBLIQUE), "look-ups"),
    "look-ups without end": (lambda: RatioTransmittance(MEDIA["linear"], OBLIQUE, 1e10), "look-ups"),
    "control negative": (lambda: ResidualRatioTransmittance(MEDIA["linear"], OBLIQUE, None, -0.1), "control"),
    "negative extinction": (lambda: RatioTransmittance(Procedural(lambda x: x[..., 0] - 5, 9.0), OBLIQUE), "sigma_t"),
    "NaN": (lambda: DeltaTransmittance(Procedural(lambda x: np.nan * x[..., 0], 9.0), OBLIQUE), "sigma_t"),
    "wrong shape": (lambda: DeltaTransmittance(Procedural(lambda x: x, 9.0), OBLIQUE), "shape"),
    "infinite ray": (lambda: RatioTransmittance(MEDIA["exponential"], Ray((0, 0, 0), (0, 0, 1))), "length"),
    "batch for an estimator": (lambda: RatioTransmittance(voxels(), Ray(np.zeros((2, 3)), (0, 0, 1))), "one ray"),
    "channels for one": (lambda: DeltaTransmittance(Medium((1.0, 2.0), 0.0), OBLIQUE), "channels"),
    "blocks around nothing": (
        lambda: RatioTransmittance(MEDIA["linear"], OBLIQUE, MajorantGrid.of(voxels(), 2)),
        "end",
    ),
    "blocks too small": (
        lambda: RatioTransmittance(MEDIA["trilinear"], OBLIQUE, MajorantGrid(np.ones((1, 1, 1)), (0, 0, 0), (1, 1, 1))),
        "box of the majorant",
    ),
    "python function where a compiled one is needed": (
        lambda: RatioTransmittance(
            MEDIA["waves in a box"], OBLIQUE, MajorantGrid(np.full((1, 1, 1), 1.8), (-1, -1, -1), (1, 1, 1))
        ),
        "CompiledField",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused_with_a_reason(name: str) -> None:
    make, words = BAD[name]
    with pytest.raises((InvalidValueError, UnsupportedError), match=words) as caught:
        make().draw(np.random.default_rng(0), 10)
    assert isinstance(caught.value, FogproofError)
