"""Invariant: a medium that is moved, turned, scaled or sheared is the same medium at the mapped places."""

import numpy as np
import pytest

from fogproof.analytic import coefficients, transmittance
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import CompositeMedium, GaussianPuffs, Medium, Ray, TransformedMedium, VoxelGrid

GRID = VoxelGrid(np.random.default_rng(5).random((3, 4, 5)), (0, 0, 0), (1, 1, 1), albedo=0.5, emission=2.0)
TURN = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
MOVED = np.array([[0.3], [-1.2], [2.5]])
SHEAR = np.array([[1.0, 0.3, 0.0], [0.0, 0.7, 0.2], [0.1, 0.0, 1.9]])
ORIGIN, WAY = np.array([0.1, 0.4, -2.0]), np.array([0.1, 0.05, 0.99]) / np.linalg.norm([0.1, 0.05, 0.99])


def placed(matrix):
    return TransformedMedium(GRID, np.concatenate([matrix, MOVED], axis=1))


@pytest.mark.parametrize("size", [1.0, 3.0, 1e-3])
def test_turned_and_scaled_as_the_ray_is(size):
    """A ray turned along with the grid sees it as before, its optical depth times the size."""
    medium = placed(size * TURN)
    found = transmittance(medium, Ray(size * TURN @ ORIGIN + MOVED[:, 0], TURN @ WAY, size * 5.0))
    depth = -np.log(transmittance(GRID, Ray(ORIGIN, WAY, 5.0)).value)
    assert -np.log(found.value) == pytest.approx(size * depth, rel=1e-12)
    assert found.error <= 1e-12


def test_sheared_by_hand():
    medium = placed(SHEAR)
    ray = Ray(SHEAR @ ORIGIN + MOVED[:, 0], SHEAR @ WAY / np.linalg.norm(SHEAR @ WAY), 9.0)
    found = transmittance(medium, ray)
    depth = -np.log(transmittance(GRID, Ray(ORIGIN, WAY, 5.0)).value)
    assert abs(-np.log(found.value) - np.linalg.norm(SHEAR @ WAY) * depth) <= found.error / found.value + 1e-13
    inside = coefficients(medium, SHEAR @ (0.4, 0.5, 0.6) + MOVED[:, 0], (0, 0, 1))
    assert inside.sigma_t == pytest.approx(coefficients(GRID, (0.4, 0.5, 0.6), (0, 0, 1)).sigma_t, rel=1e-13)


def test_mitsuba_looks_the_same_grid_up():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    medium = placed(SHEAR)
    matrix = np.vstack([medium.to_world, [0, 0, 0, 1]])
    data = np.ascontiguousarray(GRID.sigma_t.transpose(2, 1, 0)[..., None].astype(np.float32))
    volume = mi.load_dict(
        {
            "type": "gridvolume",
            "grid": mi.VolumeGrid(data),
            "to_world": mi.ScalarTransform4f(matrix),
            "wrap_mode": "clamp",
        }
    )
    own = np.random.default_rng(7).uniform(0.01, 0.99, (200, 3))
    points = own @ SHEAR.T + MOVED[:, 0]
    known = coefficients(medium, points, (0, 0, 1)).sigma_t
    looked_up = []
    for point in points:
        at = mi.MediumInteraction3f()
        at.p = mi.ScalarPoint3f(*point.tolist())
        looked_up.append(float(np.ravel(volume.eval(at))[0]))
    assert np.allclose(looked_up, known, atol=2e-5)


def test_puffs_and_media_without_end():
    puffs = TransformedMedium(GaussianPuffs([(0, 0, 0)], 0.5, 1.0), np.eye(4))
    ray = Ray((0.1, 0, -9), (0, 0, 1), 18.0)
    assert transmittance(puffs, ray).value == pytest.approx(transmittance(puffs.medium, ray).value, rel=1e-12)
    assert transmittance(TransformedMedium(Medium(0.1, 0.2), 5 * np.eye(4)[:3]), ray).value == pytest.approx(
        np.exp(-0.3 * 18.0), rel=1e-12
    )


@pytest.mark.parametrize(
    ("matrix", "rule"),
    [
        (np.diag([1.0, 1.0, 0.0, 1.0]), "must be invertible"),
        (np.diag([1.0, 1e-9, 1.0, 1.0]), "must be invertible"),
        (np.diag([1.0, 1.0, 1.0, 2.0]), "must have the last row 0 0 0 1"),
        (np.full((3, 4), np.nan), "must be finite"),
        (np.eye(3), "must be a matrix"),
    ],
)
def test_what_is_no_place_is_named(matrix, rule):
    with pytest.raises(InvalidValueError, match=rule) as raised:
        TransformedMedium(GRID, matrix)
    assert raised.value.argument == "to_world"


def test_parts_are_moved_and_not_wholes():
    with pytest.raises(UnsupportedError, match="transform its parts"):
        TransformedMedium(CompositeMedium((GRID,)), np.eye(4))
