"""Invariant: a picture of the sky is the sum of its pixels, for the oracle and for who draws from it."""

import numpy as np
import pytest

from fogproof.analytic import single_scattering
from fogproof.analytic.airlight.incident import NODES
from fogproof.analytic.lights.environment_map import incident
from fogproof.checks import check_estimator, fresh_seed
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators import Airlight, PathTracer
from fogproof.estimators.lights.environment_map import sample
from fogproof.oracle import answer
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, Ray
from fogproof.scene.lights import DirectionalLight, Environment, EnvironmentMap
from fogproof.scene.shapes import Ball, HalfSpace, Slab

FOG = Medium(0.1, 0.4, HenyeyGreenstein(0.4))
RAY = Ray((0.1, -2.0, -3.0), (0.0, 0.6, 0.8), np.inf)
BALL, LAYER = Ball((0.0, 0.0, 0.0), 0.3), Slab((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.0)
IMAGE = np.random.default_rng(6).uniform(0, 1, (4, 6)) ** 4
ALPHA = 1e-9


@pytest.mark.parametrize("shape", [LAYER, HalfSpace((0, 0, 0), (0.0, 0.0, -1.0))], ids=repr)
def test_a_constant_picture_is_the_constant_environment(shape):
    ray = Ray((0.1, -2.0, -3.0), (0.0, 0.6, 0.8), 6.0)
    one = single_scattering(FOG, ray, EnvironmentMap(np.full((4, 8), 0.5), 4.0), shape=shape)
    other = single_scattering(FOG, ray, Environment(2.0), shape=shape)
    assert abs(one.value - other.value) <= one.error + other.error
    assert one.error < 1e-2 * one.value


def test_it_is_the_sum_of_its_directions():
    """Each direction of a rule of its own is the sun, whose airlight is found along one ray without directions to sum over."""
    y, weights = np.polynomial.legendre.leggauss(5)
    rows, columns = IMAGE.shape
    total = 0.0
    for r in range(rows):
        low, high = np.cos(np.pi * (r + 1) / rows), np.cos(np.pi * r / rows)
        for c in range(columns):
            if IMAGE[r, c] < 0.3:
                continue
            for z, dz in zip(low + (high - low) * (y + 1) / 2, weights * (high - low) / 2, strict=True):
                for phi, dphi in zip(2 * np.pi / columns * (c + (y + 1) / 2), weights * np.pi / columns, strict=True):
                    sine = np.sqrt(1 - z * z)
                    to = np.array([sine * np.cos(phi), sine * np.sin(phi), z])
                    sun = DirectionalLight(tuple((-to / np.linalg.norm(to)).tolist()), IMAGE[r, c] * dz * dphi)
                    total += float(single_scattering(FOG, RAY, sun, shape=LAYER).value)
    found = single_scattering(FOG, RAY, EnvironmentMap(np.where(IMAGE < 0.3, 0, IMAGE)), shape=LAYER)
    assert abs(float(found.value) - total) <= float(found.error) + 1e-5 * total
    assert found.error < 1e-2 * found.value


def test_forward_scattering_sees_the_picture_the_right_way_up():
    """Looking along a direction, the lit pixel ahead is brighter than the one behind, on every axis."""
    medium = Medium(0.0, 0.2, HenyeyGreenstein(0.9))
    places = {(0, 0, 1): (0, 0), (0, 0, -1): (3, 0), (1, 0, 0): (1, 0), (0, 1, 0): (1, 2), (-1, 0, 0): (1, 4)}
    for axis, (row, column) in places.items():
        image = np.zeros((4, 8))
        image[row, column] = 1.0
        d = np.array(axis, float)
        ahead, behind = (
            single_scattering(medium, Ray(tuple(-3 * s * d), tuple(s * d), np.inf), EnvironmentMap(image), shape=BALL)
            for s in (1.0, -1.0)
        )
        assert ahead.value > 5 * behind.value


def test_drawn_directions_have_the_density_of_the_picture():
    light = EnvironmentMap(IMAGE, 2.0)
    rows, columns = IMAGE.shape
    u = np.random.default_rng(7).random((200_000, 2))
    drawn = sample(light, np.zeros((3, len(u))), u)
    assert np.allclose(np.linalg.norm(drawn.w, axis=0), 1, atol=1e-14)
    edges = np.cos(np.pi * np.arange(rows + 1) / rows)
    power = IMAGE * -np.diff(edges)[:, None] * 2 * np.pi / columns
    assert np.allclose(drawn.arriving, 2 * power.sum(), rtol=1e-13)
    r = np.minimum((np.arccos(drawn.w[2]) / np.pi * rows).astype(int), rows - 1)
    c = np.minimum((np.arctan2(drawn.w[1], drawn.w[0]) % (2 * np.pi) / (2 * np.pi) * columns).astype(int), columns - 1)
    found = np.bincount(r * columns + c, minlength=rows * columns)
    expected = (power / power.sum()).ravel() * len(u)
    some = expected > 50
    assert np.all(np.abs(found - expected)[some] < 7 * np.sqrt(expected[some]))
    for edge in ([0.0, 0.0], [1 - 2**-53, 1 - 2**-53]):
        assert np.isfinite(sample(light, np.zeros((3, 1)), np.array([edge])).w).all()


def test_the_estimator_finds_the_same():
    light = EnvironmentMap(IMAGE, 2.0)
    right = single_scattering(FOG, RAY, light, shape=LAYER)
    drawn = Airlight(FOG, RAY, light, "distance", shape=LAYER)
    check_estimator(drawn.draw, right, samples=40_000, alpha=ALPHA, seed=fresh_seed()).raise_if_rejected()


def test_dark_pictures():
    dark = EnvironmentMap(np.zeros((2, 4)))
    assert single_scattering(FOG, RAY, dark, shape=LAYER).value == 0
    assert np.all(Airlight(FOG, RAY, dark, "distance", shape=LAYER).draw(np.random.default_rng(0), 9).value == 0)


REFUSED = [
    (lambda: EnvironmentMap(np.ones(3)), "image must be a grey picture"),
    (lambda: EnvironmentMap(np.ones((2, 4, 3))), "a picture in colour is one light a channel"),
    (lambda: EnvironmentMap(np.ones((0, 4))), "image must be a grey picture"),
    (lambda: EnvironmentMap([[1.0, np.nan]]), "image must be finite and >= 0"),
    (lambda: EnvironmentMap([[1.0, -1.0]]), "image must be finite and >= 0"),
    (lambda: EnvironmentMap([[1.0]], -1.0), "radiance must be finite and >= 0"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_bad_pictures_are_refused(make, message):
    with pytest.raises(InvalidValueError, match=message):
        make()


def test_rules_with_more_nodes_have_more_in_each_pixel():
    """Otherwise two rules would be one, and their difference, the error, 0."""
    for shape in ((1, 1), (4, 8), (30, 60)):
        sizes = [incident(EnvironmentMap(np.ones(shape)), np.zeros((1, 3)), n).weight.shape[1] for n in NODES]
        assert np.all(np.diff(sizes) > 0)
    fine = EnvironmentMap(np.ones((12, 24)), 2.0)
    right = single_scattering(FOG, RAY, Environment(2.0), shape=LAYER)
    found = single_scattering(FOG, RAY, fine, shape=LAYER)
    assert abs(found.value - right.value) <= found.error + right.error


def test_what_is_not_followed_is_refused_by_name():
    with pytest.raises(UnsupportedError, match="at most 2048 lit pixels, and this picture has 8192: take means"):
        single_scattering(FOG, RAY, EnvironmentMap(np.ones((64, 128))), shape=LAYER)
    with pytest.raises(UnsupportedError, match="EnvironmentMap"):
        PathTracer(Medium(0.1, 0.9, Isotropic()), BALL, RAY, EnvironmentMap(IMAGE)).draw(np.random.default_rng(0), 10)


def test_requests():
    request = {
        "quantity": "single_scattering",
        "medium": {"sigma_a": 0.1, "sigma_s": 0.4},
        "light": {"kind": "environment-map", "image": [[1, 0.5], [0.2, 0]], "radiance": 2},
        "ray": {"origin": [0.1, 0.2, -3], "direction": [0, 0, 1]},
        "shape": {"kind": "slab", "point": [0, 0, 0], "normal": [0, 0, 1], "thickness": 1},
    }
    assert answer(request)["value"] > 0
