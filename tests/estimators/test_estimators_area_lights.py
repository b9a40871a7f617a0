"""Invariant: directions to a light with extent fill its solid angle with the weight they say, in float64 for every place."""

import numpy as np
import pytest

from fogproof.analytic.lights import disk as oracle_disk
from fogproof.analytic.lights import rectangle as oracle_rectangle
from fogproof.analytic.lights import sphere as oracle_sphere
from fogproof.estimators import Airlight
from fogproof.estimators.airlight.lighting import met, sampler
from fogproof.scene import Medium, Ray
from fogproof.scene.lights import DiskLight, RectangleLight, SphereLight

BALL = SphereLight((0.6, -0.8, 0.5), 0.4, 1.0)
PANE = RectangleLight((0.4, -0.8, 0.2), (0.0, 0.0, 0.6), (0.3, 0.4, 0.0), 1.0)
PLATE = DiskLight((0.6, -0.8, 0.5), (-0.6, 0.8, 0.0), 0.4, 1.0)
PAIRS = [(BALL, oracle_sphere), (PANE, oracle_rectangle), (PLATE, oracle_disk)]
IDS = ["sphere", "rectangle", "disk"]


@pytest.mark.parametrize(("light", "oracle"), PAIRS, ids=IDS)
@pytest.mark.parametrize(
    "place", [(0.0, 0.0, 0.0), (-3.0, 2.0, 8.0), (0.3, -0.2, 0.4), (0.5, -0.4, 0.5), (-200.0, 300.0, 50.0)]
)
def test_moments_over_the_solid_angle(light, oracle, place):
    """int g dw of a few polynomials g of the direction and the distance, by samples and by the oracle's rule."""
    n = 100_000
    x = np.array(place)
    w, distance, arriving = sampler(light)(np.tile(x[:, None], n), np.random.default_rng().random((n, 2)))
    assert np.allclose(np.sum(w * w, axis=0), 1)
    rule = oracle.incident(light, x[None], 40)
    for name, of in (
        ("1", lambda d, r: np.ones(len(r))),
        ("w", lambda d, r: d[:, 0]),
        ("w2", lambda d, r: d[:, 1] * d[:, 2]),
        ("T", lambda d, r: np.exp(-0.3 * r)),
    ):
        truth = float(rule.weight[0] @ of(rule.direction[0], rule.distance[0]))
        got = of(w.T, distance) * arriving
        spread = got.std() / np.sqrt(n)
        assert abs(got.mean() - truth) <= 6.5 * spread + 1e-7 * abs(truth), (name, light, place)


@pytest.mark.parametrize(("light", "oracle"), PAIRS, ids=IDS)
def test_the_edges_of_the_unit_square(light, oracle):
    u = np.array([(a, b) for a in (0.0, 1 - 2**-53, 0.5) for b in (0.0, 1 - 2**-53, 0.5)])
    for place in ((0.0, 0.0, 0.0), (-200.0, 300.0, 50.0), (0.4, -0.4, 0.5)):
        w, distance, arriving = sampler(light)(np.tile(np.array(place)[:, None], len(u)), u)
        assert np.isfinite(w).all()
        assert np.isfinite(arriving).all()
        assert (distance > 0).all()


def test_nothing_comes_from_behind_or_from_inside():
    u = np.random.default_rng().random((100, 2))
    behind = np.tile(np.array([[1.2], [-1.6], [0.5]]), 100)
    assert (sampler(PANE)(behind, u).arriving == 0).all()
    assert (sampler(PLATE)(behind, u).arriving == 0).all()
    assert (sampler(BALL)(np.tile(np.array([[0.6], [-0.8], [0.4]]), 100), u).arriving == 0).all()


def test_where_rays_meet_lights():
    towards = np.array([0.6, -0.8, 0.5]) / np.sqrt(1.25)
    ray = Ray((0.0, 0.0, 0.0), towards)
    assert met(BALL, ray) == pytest.approx(np.sqrt(1.25) - 0.4)
    assert met(PLATE, ray) == pytest.approx(np.sqrt(1.25))
    assert met(PANE, Ray((0.0, 0.0, 0.4), (0.6, -0.8, 0.0))) == pytest.approx(5 / 6)  # the plane of 0.8 x - 0.6 y = 0.8
    assert met(BALL, Ray((0.0, 0.0, 0.0), -towards)) == np.inf
    assert met(BALL, Ray(BALL.center, towards)) == 0
    estimator = Airlight(Medium(0.1, 0.4), Ray(BALL.center, towards), BALL)
    assert (estimator.draw(np.random.default_rng(1), 10).value == 0).all()
