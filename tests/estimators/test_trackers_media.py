"""Protects: a tracker sees the extinction that the scene describes, at every point, and the optical depth that follows from it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tracker_media import MEDIA, OBLIQUE, unit, voxels, waves

from fogproof.analytic import (
    coefficients,
    optical_thickness,
    transmittance,
)
from fogproof.checks import check_estimator
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators import CompiledField, DeltaTransmittance, FractalNoise, MajorantGrid, RatioTransmittance
from fogproof.estimators.tracking.medium_data import extremes, look_ups, medium_data
from fogproof.estimators.tracking.noise import HIGHEST
from fogproof.estimators.tracking.optical_depth import optical_depth, path_density
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
    Isotropic,
    LinearMedium,
    OpenGLFog,
    Procedural,
    Ray,
    VoxelGrid,
)

CHROMATIC = {
    "linear": LinearMedium((0.5, 0.2), ((0.1, 0.2, 0.3), (0.0, -0.1, 0.1))),
    "exponential": ExponentialMedium((0.5, 0.2), (0.1, 0.2, 0.3)),
    "grid": voxels((3, 4, 5, 2)),
}
rng = np.random.default_rng(11)
INSIDE = rng.uniform((-0.99, -0.69, -1.29), (0.89, 1.09, 1.19), (500, 3))


@pytest.mark.parametrize("medium", [*MEDIA.values(), *CHROMATIC.values()], ids=[*MEDIA, *(f"{n} 2" for n in CHROMATIC)])
def test_look_ups_agree_with_the_oracles_coefficients(medium) -> None:
    x = INSIDE if not hasattr(medium, "lower") else np.clip(INSIDE, medium.lower, np.nextafter(medium.upper, -np.inf))
    w = np.broadcast_to(unit(1, 2, 3), x.shape)
    expected = coefficients(medium, x, w).sigma_t.reshape(len(x), -1)
    assert np.allclose(look_ups(medium)(x, w), expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize(
    "name", ["linear", "linear to vacuum", "exponential", "layers", "nearest", "trilinear", "waves"]
)
def test_optical_depth_agrees_with_the_oracle(name: str) -> None:
    t = np.linspace(1e-6, 1.5, 60)
    reference = optical_thickness(MEDIA[name], Ray(OBLIQUE.origin, OBLIQUE.direction, t))
    depth = optical_depth(MEDIA[name], OBLIQUE, t)[:, 0]
    assert np.all(np.abs(depth - reference.value) <= reference.error + 2e-14)


def test_path_density_is_the_derivative_of_the_transmittance() -> None:
    t, h = np.linspace(0.1, 1.4, 50), 1e-6
    for name in ("linear", "exponential", "waves"):
        through = [np.exp(-optical_depth(MEDIA[name], OBLIQUE, t + s))[:, 0] for s in (-h, h)]
        assert np.allclose(path_density(MEDIA[name], OBLIQUE, t)[:, 0], (through[0] - through[1]) / (2 * h), rtol=1e-7)


@pytest.mark.parametrize("name", MEDIA)
def test_extremes_hold_along_the_ray(name: str) -> None:
    medium = MEDIA[name]
    ends = [np.array(a.reshape(-1, n)) for a, n in ((OBLIQUE.origin, 3), (OBLIQUE.direction, 3))]
    low, high = extremes(medium, *ends, np.array([1.5]))
    x = OBLIQUE.origin + np.linspace(0, 1.5, 400)[:, None] * OBLIQUE.direction
    if hasattr(medium, "lower"):
        x = x[np.all((x >= medium.lower) & (x < medium.upper), axis=-1)]
    sigma = look_ups(medium)(x, np.broadcast_to(OBLIQUE.direction, x.shape))
    assert low[0] - 1e-12 <= sigma.min()
    assert sigma.max() <= high[0] + 1e-12


@pytest.mark.parametrize("interpolation", ["nearest", "trilinear"])
@settings(deadline=None)
@given(block=st.integers(1, 7), seed=st.integers(0, 2**32))
def test_blocks_bound_the_grid_everywhere(interpolation: str, block: int, seed: int) -> None:
    grid = voxels((5, 4, 7), interpolation, seed)
    bounds = MajorantGrid.of(grid, block)
    assert bounds.high.shape == tuple(-(-n // block) for n in (5, 4, 7))
    x = np.random.default_rng(seed).uniform(grid.lower, grid.upper, (400, 3))
    sigma = look_ups(grid)(x, x)[:, 0]
    low, high = bounds.at(x)
    assert np.all((low <= sigma + 1e-12) & (sigma <= high + 1e-12))


def test_the_bound_of_noise_is_the_least_round_number_above_its_greatest_value() -> None:
    """At offsets u the noise is at most sum of w_c(u) max_g g.(u - c): the two largest components of |u - c|."""
    from scipy.optimize import minimize

    corners = np.array(np.meshgrid(*[(0, 1)] * 3)).reshape(3, -1).T

    def most(u: np.ndarray) -> np.ndarray:
        fade = u**3 * (u * (6 * u - 15) + 10)
        weight = np.prod(np.where(corners, fade[..., None, :], 1 - fade[..., None, :]), axis=-1)
        off = np.sort(np.abs(u[..., None, :] - corners), axis=-1)
        return np.sum(weight * (off[..., 1] + off[..., 2]), axis=-1)

    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, 41)] * 3, indexing="ij"), axis=-1)
    start = grid.reshape(-1, 3)[np.argmax(most(grid))]
    best = -minimize(
        lambda u: -float(most(u)), start, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-14}
    ).fun
    assert best < HIGHEST < best + 1e-4


def test_noise_fills_its_range_and_repeats_with_its_seed() -> None:
    noise = FractalNoise(2.0, 3.0, octaves=1, seed=3)
    sigma = noise(np.random.default_rng(0).uniform(-30, 30, (200_000, 3)))
    assert sigma.min() >= 0 <= 2.0 - sigma.max()
    assert sigma.max() - sigma.min() > 1.8
    assert abs(sigma.mean() - 1.0) < 0.02
    assert np.array_equal(
        sigma[:10],
        FractalNoise(2.0, 3.0, octaves=1, seed=3)(np.random.default_rng(0).uniform(-30, 30, (200_000, 3))[:10]),
    )
    assert not np.array_equal(noise(INSIDE), FractalNoise(2.0, 3.0, octaves=1, seed=4)(INSIDE))


def test_a_compiled_field_is_an_array_function() -> None:
    field = CompiledField(numba.njit(lambda x, y, z: 1 + 0.8 * np.sin(3 * x + 1) * np.sin(2 * y + z)))
    assert np.allclose(field(INSIDE), waves(INSIDE), rtol=1e-14)
    assert field(INSIDE.reshape(5, 100, 3)).shape == (5, 100)
    colours = CompiledField(numba.njit(lambda x, y, z, c: 1.0 + c), channels=3)
    assert np.array_equal(colours(INSIDE[:2]), [[1, 2, 3], [1, 2, 3]])


@numba.njit
def text(x: float, y: float, z: float) -> str:
    return "a"


@numba.njit
def two(x: float, y: float) -> float:
    return x + y


BAD_FIELDS = {
    "python function": (lambda: CompiledField(lambda x, y, z: 1.0), "numba.njit"),
    "number": (lambda: CompiledField(2.0), "numba.njit"),
    "wrong arguments": (lambda: CompiledField(two), r"f\(x, y, z\)"),
    "wrong result": (lambda: CompiledField(text), "one number"),
    "no wrapper": (lambda: medium_data(Procedural(two, 1.0)), "CompiledField"),
    "no density": (lambda: FractalNoise(0.0, 1.0), "density"),
    "no octaves": (lambda: FractalNoise(1.0, 1.0, octaves=0), "octaves"),
    "infinite frequency": (lambda: FractalNoise(1.0, np.inf), "frequency"),
    "empty grid": (lambda: VoxelGrid(np.ones((0, 2, 2)), (0, 0, 0), (1, 1, 1)), "at least one voxel"),
    "grid with NaN": (lambda: VoxelGrid(np.full((2, 2, 2), np.nan), (0, 0, 0), (1, 1, 1)), "finite"),
    "negative grid": (lambda: VoxelGrid(np.full((2, 2, 2), -1.0), (0, 0, 0), (1, 1, 1)), ">= 0"),
    "block 0": (lambda: MajorantGrid.of(voxels(), 0), "block"),
    "infinite block": (lambda: MajorantGrid(np.full((1, 1, 1), np.inf), (0, 0, 0), (1, 1, 1)), "finite"),
    "low above high": (lambda: MajorantGrid(np.ones((1, 1, 1)), (0, 0, 0), (1, 1, 1), 2 * np.ones((1, 1, 1))), "low"),
}


@pytest.mark.parametrize("name", BAD_FIELDS)
def test_bad_media_are_refused_with_a_reason(name: str) -> None:
    make, words = BAD_FIELDS[name]
    with pytest.raises(InvalidValueError, match=words):
        make()


@dataclass(frozen=True)
class Unheard:
    """A medium that has no module anywhere."""

    channels: None = None
    albedo: float = 0.0
    phase: Isotropic = field(default_factory=Isotropic)
    emission: float = 0.0


def test_what_trackers_do_not_know_is_said() -> None:
    with pytest.raises(UnsupportedError, match="Unheard"):
        medium_data(Unheard())
    with pytest.raises(InvalidValueError, match="majorant must be finite"):  # it ends in infinite extinction
        RatioTransmittance(OpenGLFog("linear"), Ray((0, 0, 0), (0, 0, 1), 1.5)).draw(rng, 1)


def test_flakes_are_tracked_by_the_direction() -> None:
    flakes, w = AnisotropicMedium(2.0, np.diag([1.0, 0.25, 4.0])), unit(1, 2, 3)
    ray = Ray((0, 0, 0), w, 0.7)
    loose = DeltaTransmittance(flakes, ray, 9.0)
    check_estimator(loose.draw, transmittance(flakes, ray), samples=200_000).raise_unless_passed()
    assert np.allclose(optical_depth(flakes, ray, np.array([0.7])), optical_thickness(flakes, ray).value)


@pytest.mark.parametrize("mode", ["exp", "exp2", "linear"])
def test_fog_of_opengl_is_tracked(mode) -> None:
    fog, ray = OpenGLFog(mode, 0.8, 0.2, 2.0), Ray((0, 0, 0), unit(1, 2, 3), 1.1)
    ratio = RatioTransmittance(fog, ray)
    check_estimator(ratio.draw, transmittance(fog, ray), samples=200_000).raise_unless_passed()


@pytest.mark.parametrize("tracker", [DeltaTransmittance, RatioTransmittance])
@pytest.mark.parametrize("compiled", [True, False], ids=["kernel", "arrays"])
def test_a_majorant_that_is_barely_too_small_is_refused_where_it_is_met(tracker, compiled) -> None:
    """A band too thin for a first look is denser than the bound, by less than anybody would see in a mean."""
    excess = 1e-4

    def banded(x: np.ndarray) -> np.ndarray:
        return np.where(np.abs(x[..., 2] - 0.5) < 0.005, 1.0 + excess, 1.0)

    field = CompiledField(numba.njit(lambda x, y, z: 1.0 + excess * (abs(z - 0.5) < 0.005))) if compiled else banded
    ray, generator = Ray((0, 0, 0), (0, 0, 1), 1.0), np.random.default_rng(1)
    tracker(Procedural(field, 1.0 + excess), ray).draw(generator, 20_000)
    with pytest.raises(InvalidValueError, match=r"must bound sigma_t = 1\.0001 .*met at t = 0\.(49|50)"):
        tracker(Procedural(field, 1.0), ray).draw(generator, 20_000)
