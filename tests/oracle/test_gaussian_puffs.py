"""Gaussian puffs: erf against quadrature, many digits and proof; trackers, samplers and paths against both."""

import json
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import (
    ambient_fog,
    coefficients,
    free_path,
    optical_thickness,
    radiance,
    radiance_by_ode,
    radiance_by_quadrature,
    transmittance,
)
from fogproof.checks import check_estimator
from fogproof.errors import InvalidValueError
from fogproof.estimators import PathTracer, RatioTransmittance, along
from fogproof.estimators.tracking.medium_data import extremes, look_ups
from fogproof.oracle import answer
from fogproof.scene import PointLight, Ray, Scene
from fogproof.scene.media.gaussian_puffs import GaussianPuffs
from fogproof.scene.shapes import Ball
from fogproof.scene_estimator import estimator_for

PUFFS = GaussianPuffs([(0, 0.1, 1), (0.5, -0.2, 2), (0, 0, -3)], [0.3, 0.7, 1.0], [2.0, 0.8, 5.0], 0.7, emission=0.4)
RAY = Ray((0.1, 0, -0.5), (0, 0.6, 0.8), 3.0)


def exactly(medium, ray):
    """tau along one ray, 50 digits, the direction as stored."""
    with mp.workdps(50):
        o, d = ([mp.mpf(float(x)) for x in v] for v in (ray.origin, ray.direction))
        square, total = mp.fdot(d, d), mp.mpf(0)
        for center, w, density in zip(medium.centers, medium.widths, medium.densities, strict=True):
            offset = [mp.mpf(float(c)) - x for c, x in zip(center, o, strict=True)]
            nearest = mp.fdot(offset, d) / square
            p2, root = mp.fdot(offset, offset) - nearest**2 * square, mp.sqrt(square / 2) / mp.mpf(float(w))
            s = mp.mpf(float(ray.length)) if np.isfinite(ray.length) else mp.inf
            peak = mp.mpf(float(density)) * mp.exp(-p2 / (2 * mp.mpf(float(w)) ** 2)) * mp.sqrt(mp.pi) / 2 / root
            low = -nearest * root
            # erf(high) - erf(low), on one side by erfc, whose digits are relative
            high = mp.inf if s == mp.inf else (s - nearest) * root
            low, high = (low, high) if low > 0 else (-high, -low)
            same = mp.erfc(low) - mp.erfc(high)
            total += peak * same
        return total


@pytest.mark.parametrize("seed", range(60))
def test_the_thickness_is_within_its_bound_and_the_bound_is_tight(seed):
    rng = np.random.default_rng(seed)
    n, far = rng.integers(1, 4), 10.0 ** rng.uniform(-2, 4)
    medium = GaussianPuffs(rng.normal(size=(n, 3)), 10.0 ** rng.uniform(-1, 1, n), 10.0 ** rng.uniform(-3, 3, n))
    w = rng.normal(size=3)
    w /= np.linalg.norm(w)
    target = rng.normal(size=3)
    length = np.inf if seed % 7 == 0 else 10.0 ** rng.uniform(-6, 4)
    ray = Ray(target - far * w, w, length)
    found, truth = optical_thickness(medium, ray), exactly(medium, ray)
    assert abs(mp.mpf(float(found.value)) - truth) <= float(found.error)
    reach = (1 + far + np.abs(medium.centers).max()) / medium.widths.min()
    assert found.error <= 2e-13 * (1 + reach) ** 2 * max(float(truth), 1e-280) + 1e-320


def test_four_ways_agree():
    tau = optical_thickness(PUFFS, RAY)
    proven = optical_thickness(PUFFS, RAY, rigorous=True)
    assert abs(tau.value - proven.value) <= tau.error + proven.error
    assert proven.error <= 1e-15 * proven.value
    ways = [
        ambient_fog(PUFFS, RAY, 0.5, 2.0),
        radiance_by_quadrature(PUFFS, RAY, 0.5, 2.0),
        radiance_by_ode(PUFFS, RAY, 0.5, 2.0),
    ]
    for way in ways[1:]:
        assert abs(way.value - ways[0].value) <= way.error + ways[0].error
    end = optical_thickness(PUFFS, Ray(RAY.origin, RAY.direction))
    assert (
        abs(optical_thickness(PUFFS, Ray(RAY.origin, RAY.direction), rigorous=True).value - end.value) <= 2 * end.error
    )


def test_trackers_and_samplers_agree_with_the_oracle():
    rng = np.random.default_rng()
    x = rng.uniform(-2, 2, (200, 3))
    w = np.broadcast_to(RAY.direction, x.shape)
    assert np.allclose(look_ups(PUFFS)(x, w)[:, 0], coefficients(PUFFS, x, w).sigma_t, rtol=1e-13)
    high = extremes(PUFFS, RAY.origin[None], RAY.direction[None], np.array([3.0]))[1]
    t = np.linspace(0, 3, 1000)
    sigma = along(PUFFS, RAY).sigma(t)
    assert sigma.max() <= high <= 3 * sigma.max()
    depth = optical_thickness(PUFFS, RAY).value * np.array([0.1, 0.3, 0.6, 0.9, 50.0])
    found = free_path(PUFFS, RAY, depth)
    reached = along(PUFFS, RAY).reach(depth)
    assert np.array_equal(np.isinf(found.value), np.isinf(np.where(reached > 3, np.inf, reached)))
    ends = np.isfinite(found.value)
    assert ends.sum() == 4
    assert np.all(np.abs(found.value[ends] - reached[ends]) <= found.error[ends] + 1e-12)
    check_estimator(RatioTransmittance(PUFFS, RAY).draw, transmittance(PUFFS, RAY), samples=100_000).raise_if_rejected()


def test_a_lamp_and_paths_through_puffs():
    scene = Scene(PUFFS, RAY, "single", PointLight((1.0, 1.0, 1.0), 3.0), background=1.0)
    check_estimator(estimator_for(scene).draw, radiance(scene), samples=40_000).raise_if_rejected()
    dark = replace(PUFFS, emission=0.0)
    once = PathTracer(dark, Ball((0, 0, 0), 30.0), RAY, scene.light, deepest=1, majorant=9.0)
    lit = radiance(Scene(dark, Ray(RAY.origin, RAY.direction, 25.0), "single", scene.light))
    check_estimator(once.draw, lit, samples=100_000).raise_if_rejected()


def test_over_json_and_refused():
    request = {"quantity": "transmittance", "medium": {"kind": "gaussian-puffs", "centers": [[0, 0, 1]], "widths": 0.3,
               "densities": 2}, "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 2}}  # fmt: skip
    tau = 2 * 0.3 * np.sqrt(2 * np.pi) * float(mp.erf(1 / 0.3 / mp.sqrt(2)))
    assert np.isclose(answer(json.loads(json.dumps(request)))["value"], np.exp(-tau), rtol=1e-14)
    for bad, name in (
        (((1, 2, 3), 1, 1), "centers"),
        (([(0, 0, 0)], 0.0, 1), "widths"),
        (([(0, 0, 0)], 1, -1), "densities"),
    ):
        with pytest.raises(InvalidValueError, match=name):
            GaussianPuffs(*bad)


def test_far_tails_of_a_puff_glow():
    """Ten widths beside the middle, on both sides: what glows there is e^-50 of the middle, and counts."""
    puff = GaussianPuffs([(0, 0, 0)], [0.5], [1.0], 0.0, emission=2.0)
    for ray in (Ray((0, 0, 5), (0, 0, 1), 1.0), Ray((5, 0, -1), (0, 0, 1), 2.0), Ray((0, 0, -9), (0, 0, 1), 4.5)):
        found = radiance_by_quadrature(puff, ray)
        with mp.workdps(40):
            truth = -2 * mp.expm1(-exactly(puff, ray))
        assert truth > 0
        assert abs(found.value - truth) <= found.error <= 1e-9 * truth
