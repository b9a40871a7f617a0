"""Protects: walking through a voxel grid gives the optical depth of the oracle on every ray, and its inverse is a free path."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tracker_media import OBLIQUE, rays, unit, voxels

from fogproof import check_sampler
from fogproof.analytic import (
    optical_thickness,
    transmittance,
)
from fogproof.errors import FogproofError, InvalidValueError, UnsupportedError
from fogproof.estimators import (
    RegularFreePath,
    RegularTransmittance,
    regular_tracking,
)
from fogproof.scene import LinearMedium, Ray, VoxelGrid

INTERPOLATIONS = ["nearest", "trilinear"]


def dyadic(interpolation: str, seed: int = 0) -> VoxelGrid:
    """Return a grid whose planes are exact binary numbers, so that a ray can lie in them."""
    sigma = np.random.default_rng(seed).random((8, 4, 6)) * 5
    return VoxelGrid(np.where(sigma < 0.5, 0.0, sigma), (-1, -0.5, -0.75), (1, 0.5, 0.75), interpolation)


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
@settings(max_examples=300, deadline=None)
@given(ray=rays(), seed=st.integers(0, 10))
def test_the_optical_depth_is_the_oracles(interpolation: str, ray: Ray, seed: int) -> None:
    grid = dyadic(interpolation, seed)
    reference = optical_thickness(grid, ray)
    walk = regular_tracking(grid, ray)
    assert abs(walk.tau[0] - reference.value) <= reference.error + 1e-13
    assert walk.cells[0] <= 2 + sum(grid.sigma_t.shape) + 3


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
@settings(max_examples=100, deadline=None)
@given(ray=rays(), seed=st.integers(0, 10))
def test_on_grids_of_any_size(interpolation: str, ray: Ray, seed: int) -> None:
    """The planes are rounded numbers here; a ray within rounding of one may see either side, so it is turned a little."""
    turned = ray.direction + np.array([1e-3, -2e-3, 3e-3])
    ray = Ray(ray.origin + 1e-3, turned / np.linalg.norm(turned), ray.length)
    grid = voxels((3, 7, 5), interpolation, seed)
    reference = optical_thickness(grid, ray)
    assert abs(regular_tracking(grid, ray).tau[0] - reference.value) <= reference.error + 1e-12


EDGE_CASES = {
    "along a face": ((-2, 0.0, 0.1), (1, 0, 0), 2.0),
    "along an edge": ((-2, 0.0, 0.25), (1, 0, 0), 2.0),
    "in the lower face of the box": ((-2, -0.5, 0.1), (1, 0, 0), 2.0),
    "in the upper face of the box": ((-2, 0.5, 0.1), (1, 0, 0), 0.0),
    "backward along an edge": ((2, 0.0, 0.25), (-1, 0, 0), 2.0),
    "from a corner outward": ((1, 0.5, 0.75), unit(1, 1, 1), 0.0),
    "from a corner inward": ((1, 0.5, 0.75), unit(-2, -1, -1.5), None),
    "from an inner corner, up": ((0, 0, 0), unit(2, 1, 1.5), None),
    "from an inner corner, down": ((0, 0, 0), unit(-2, -1, -1.5), None),
    "through corners all the way": ((-1, -0.5, -0.75), unit(1, 1, 1), None),
    "misses": ((-2, 3, 0), (1, 0, 0), 0.0),
    "touches an edge of the box": ((-2, 0.5, 0), unit(1, 1, 0), 0.0),
    "away from the box": ((2, 0, 0), (1, 0, 0), 0.0),
}


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
@pytest.mark.parametrize("name", EDGE_CASES)
def test_faces_edges_and_corners(interpolation: str, name: str) -> None:
    origin, direction, inside = EDGE_CASES[name]
    ray = Ray(origin, direction)
    reference = optical_thickness(dyadic(interpolation), ray)
    assert abs(regular_tracking(dyadic(interpolation), ray).tau[0] - reference.value) <= reference.error + 1e-13
    if inside is not None:  # of a uniform grid the length inside is known without any oracle
        uniform = VoxelGrid(np.full((8, 4, 6), 1.5), (-1, -0.5, -0.75), (1, 0.5, 0.75), interpolation)
        assert regular_tracking(uniform, ray).tau[0] == pytest.approx(1.5 * inside, abs=1e-14)


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_rays_of_hardly_any_length(interpolation: str) -> None:
    for length in (0.0, 5e-324, 1e-300, 1e-16):
        walk = regular_tracking(dyadic(interpolation), Ray((0.1, 0.1, 0.1), unit(1, 2, 3), length))
        assert 0 <= walk.tau[0] <= 5 * length
        assert walk.distance[0] == length
    with pytest.raises(InvalidValueError, match="length"):
        Ray((0, 0, 0), (0, 0, 1), -1e-300)


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_a_free_path_stops_where_the_depth_is_reached(interpolation: str) -> None:
    grid = voxels((9, 8, 7), interpolation)
    depth = np.random.default_rng(2).exponential(size=2000)
    walk = regular_tracking(grid, OBLIQUE, depth)
    stopped = walk.tau == depth
    assert 0.2 < stopped.mean() < 1
    reached = optical_thickness(grid, Ray(OBLIQUE.origin, OBLIQUE.direction, np.maximum(walk.distance, 1e-300)))
    assert np.all(np.abs(reached.value - walk.tau) <= reached.error + 3e-14)
    assert np.all(walk.distance[~stopped] == 1.5)


def test_nothing_collides_in_vacuum() -> None:
    """The depth 0, which a uniform of 0 asks for, must not stop in the empty cells before the medium begins."""
    sigma = np.zeros((8, 1, 1))
    sigma[4] = 2.0
    grid = VoxelGrid(sigma, (0, 0, 0), (8, 1, 1), "nearest")
    ray = Ray((-1, 0.5, 0.5), (1, 0, 0), 20.0)
    walk = regular_tracking(grid, ray, np.array([0.0, 1e-300, 0.5, 1.9999, 2.0, 2.1]))
    assert np.all((walk.distance[:4] >= 5) & (walk.distance[:4] <= 6))
    assert walk.distance[4:].tolist() == [20.0, 20.0]


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_the_free_path_samples_its_density(interpolation: str) -> None:
    sampler = RegularFreePath(voxels((3, 3, 3), interpolation), OBLIQUE)

    def cdf(t: np.ndarray) -> np.ndarray:
        through = transmittance(sampler.medium, Ray(OBLIQUE.origin, OBLIQUE.direction, np.maximum(t, 1e-300)))
        return np.where(t >= 1.5, 1.0, 1 - through.value)

    verdict = check_sampler(
        sampler.sample,
        sampler.pdf,
        sampler.domain,
        dimensions=1,
        atoms=sampler.atoms,
        cdf=cdf,
        samples=200_000,
    )
    assert verdict.outcome == "not rejected", str(verdict)


def test_a_density_that_jumps_from_cell_to_cell_is_never_rejected() -> None:
    """A jump between the outermost node and the end of a panel is invisible to quadrature alone."""
    sampler = RegularFreePath(voxels((8, 9, 7), "nearest"), OBLIQUE)
    for _ in range(12):
        verdict = check_sampler(
            sampler.sample, sampler.pdf, sampler.domain, dimensions=1, atoms=sampler.atoms, samples=20_000
        )
        assert verdict.outcome != "rejected", str(verdict)


def test_channels_and_batches() -> None:
    grid = voxels((4, 4, 4, 3))
    draws = RegularTransmittance(grid, OBLIQUE).draw(np.random.default_rng(0), 5)
    assert np.allclose(draws.value, transmittance(grid, OBLIQUE).value, rtol=1e-13)
    assert draws.value.shape == (5, 3)
    many = Ray(np.zeros((50, 3)), np.array([unit(*v) for v in np.random.default_rng(1).normal(size=(50, 3))]))
    for channel in range(3):
        assert np.allclose(
            regular_tracking(grid, many, channel=channel).tau,
            optical_thickness(grid, many).value[:, channel],
            rtol=1e-12,
        )


def test_what_it_cannot_do_is_said() -> None:
    with pytest.raises(UnsupportedError, match="VoxelGrid"):
        regular_tracking(LinearMedium(1.0, (0, 0, 1)), OBLIQUE)
    with pytest.raises(FogproofError, match="channels"):
        RegularFreePath(voxels((4, 4, 4, 3)), OBLIQUE)
    with pytest.raises(UnsupportedError, match="one ray"):
        RegularTransmittance(voxels(), Ray(np.zeros((2, 3)), (0, 0, 1))).draw(np.random.default_rng(0), 2)
