"""Invariant: a camera's ray goes where geometry says, right is right, and what makes no camera is refused by name."""

import math

import numpy as np
import pytest

from fogproof import Film, InvalidValueError, OneRay, Orthographic, Perspective
from fogproof.scene import cameras
from fogproof.scene.kinds import given


def rays(camera, x, y):
    return given(camera, "fogproof.analytic.cameras", "rays")(camera, np.asarray(x, float), np.asarray(y, float))


def test_the_edges_of_a_perspective_film_span_the_angle_of_view():
    for axis, cosine in {"x": 2 / math.sqrt(5), "y": 1 / math.sqrt(2), "smaller": 1 / math.sqrt(2)}.items():
        fov = {"x": 2 * math.atan(0.5)}.get(axis, math.pi / 2)
        camera = Perspective((0, 0, 0), (0, 0, -2), fov, Film(40, 20), fov_axis=axis, wall=3)
        edge = rays(camera, [40] if axis == "x" else [20], [10] if axis == "x" else [0])
        assert -edge.direction[0, 2] == pytest.approx(cosine, rel=1e-15)
        assert edge.length[0] == pytest.approx(3 / cosine, rel=1e-15)
    diagonal = Perspective((0, 0, 0), (0, 0, -2), 1.2, Film(40, 30), fov_axis="diagonal")
    corners = rays(diagonal, [0, 40], [0, 30]).direction
    assert corners[0] @ corners[1] == pytest.approx(math.cos(1.2), rel=1e-14)


def test_right_is_right_and_row_0_is_the_upper_one():
    # Looking along -z with y upwards, x grows to the right: the usual right-handed picture.
    for camera in (
        Perspective((0, 0, 0), (0, 0, -1), 1.0, Film(10, 10)),
        Orthographic((0, 0, 0), (0, 0, -1), 2.0, Film(10, 10)),
    ):
        ray = rays(camera, [9.5, 5.0], [5.0, 0.5])
        there = ray.origin + ray.direction
        assert there[0, 0] > 0.1
        assert there[0, 1] == pytest.approx(0, abs=1e-15)
        assert there[1, 1] > 0.1


def test_orthographic_rays_are_parallel_and_a_pixel_apart():
    camera = Orthographic((1, 2, 3), (1, 2, 9), 4.0, Film(8, 2), wall=5)
    ray = rays(camera, [0.5, 1.5], [1, 1])
    assert np.linalg.norm(ray.origin[1] - ray.origin[0]) == pytest.approx(0.5)
    assert (ray.direction == [0, 0, 1]).all()
    assert (ray.length == 5).all()


def test_one_ray_is_everywhere_the_same():
    ray = rays(OneRay((1, 2, 3), (1, 2, 0), Film(4, 4)), [0, 3], [1, 2])
    assert (ray.origin == [1, 2, 3]).all()
    assert (ray.direction == [0, 0, -1]).all()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Perspective((0, 0, 0), (0, 0, 0), 1.0, Film(1, 1)), "target"),
        (lambda: Perspective((0, 0, 0), (0, 1, 0), 1.0, Film(1, 1)), "up must not be parallel"),
        (lambda: Perspective((0, 0, 0), (0, 0, 1), 180.0, Film(1, 1)), r"fov must lie in \(0, pi\)"),
        (lambda: Perspective((0, 0, 0), (0, 0, 1), 1.0, Film(1, 1), fov_axis="z"), "fov_axis must be one of"),
        (lambda: Orthographic((0, 0, 0), (0, 0, 1), 0.0, Film(1, 1)), "width"),
        (lambda: OneRay((0, 0, 0), (0, 0, 1), Film(1, 1), wall=math.nan), "wall must be > 0"),
        (lambda: Film(0, 3), "whole number of pixels"),
        (lambda: Film(3, True), "whole number of pixels"),
        (lambda: Film(3, 3, (1, 1, 3, 1)), "inside the film of 3 x 3"),
    ],
)
def test_what_makes_no_camera_is_refused(make, words):
    with pytest.raises(InvalidValueError, match=words):
        make()


def test_every_kind_has_rays():
    for kind in cameras.KINDS.values():
        assert kind.__module__.startswith("fogproof.scene.cameras.")
