"""Every look-up is paid for: the mean cost of a realisation is what its ways through the medium cost."""

import math

import numpy as np
import pytest

from fogproof.estimators import Equiangular
from fogproof.estimators.airlight.shadow_rays import by_marching, by_ratio_tracking, exact
from fogproof.estimators.airlight.single_scattering import Airlight
from fogproof.scene import ExponentialMedium, Medium, PointLight, Ray, Scene, VoxelGrid
from fogproof.scene_estimator import SceneEstimator, estimator_for

GRID = VoxelGrid(np.full((4, 4, 4), 1.5), (-2, -2, -2), (2, 2, 2), "nearest")


def ways(n):
    x, w = np.zeros((3, n)), np.zeros((3, n))
    w[2] = 1.0
    return x, w, np.full(n, 1.9)


def test_tracked_shadow_rays_look_as_often_as_their_majorant_says():
    n = 20_000
    value, cost = by_ratio_tracking(GRID, *ways(n), np.random.default_rng())
    assert abs(cost.mean() - 1.5 * 1.9) < 6 * math.sqrt(1.5 * 1.9 / n), "a Poisson process of rate 1.5 over 1.9 m"
    assert abs(value.mean() - math.exp(-1.5 * 1.9)) < 1e-12 + 6 * value.std() / math.sqrt(n)


def test_shadow_rays_cost_what_they_look_at():
    assert np.all(exact(GRID, *ways(3))[1] == 2), "from the middle, two cells"
    assert np.all(by_marching(GRID, *ways(3), 7)[1] == 7)
    assert np.all(by_marching(GRID, *ways(3), 7)[0] == pytest.approx(math.exp(-1.5 * 1.9)))


def test_an_estimate_pays_for_its_shadow_ray():
    medium, ray = ExponentialMedium(0.5, (0, 0, 0.3), albedo=0.5), Ray((0, 0, 0), (0, 0, 1), 2.0)
    light = PointLight((0.5, 0.5, 1.0), 1.0)
    plain, tracked = (
        np.mean(Airlight(medium, ray, light, shadow_rays=how).draw(np.random.default_rng(), 4000).cost)
        for how in ("exact", "ratio")
    )
    assert plain >= 1
    assert tracked > 0.2


def test_a_scene_pays_for_all_its_parts():
    scene = Scene(
        Medium(0.3, 0.4, emission=0.5),
        Ray((0, 0, 0), (0, 0, 1), 2.0),
        "single",
        PointLight((1, 1, 1), 1.0),
        background=1.0,
    )
    estimator = estimator_for(scene)
    assert len(estimator.parts) == 2
    each = [
        np.mean(SceneEstimator({name: part}).draw(np.random.default_rng(), 500).cost)
        for name, part in estimator.parts.items()
    ]
    assert np.mean(estimator.draw(np.random.default_rng(), 500).cost) == pytest.approx(sum(each), rel=0.2)
    assert min(each) >= 1


def test_positions_stay_on_the_segment_in_single_precision():
    """Thousands of segments, each at its last uniforms: rounding leaves it, and is clipped."""
    rng = np.random.default_rng()
    u = np.array([0.0, 0.5, 1 - 2.0**-23, 1 - 2.0**-24], dtype=np.float32)[:, None]
    for h, a, length in zip(
        10 ** rng.uniform(-3, 2, 3000), rng.normal(0, 10, 3000), 10 ** rng.uniform(-3, 3, 3000), strict=True
    ):
        x = Equiangular(h, a, a + length).sample(u).x
        assert np.all((x >= np.float32(a)) & (x <= np.float32(a + length))), (h, a, length)
