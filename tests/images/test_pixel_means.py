"""Invariant: pixel means lie within their error of integrals known in closed form, and the error is not idle."""

import math

import numpy as np
import pytest

from fogproof import (
    Environment,
    Film,
    HenyeyGreenstein,
    ImageScene,
    Medium,
    OneRay,
    Orthographic,
    Perspective,
    PointLight,
    UnsupportedError,
)
from fogproof.analytic import image, radiance, single_scattering
from fogproof.analytic.cameras.perspective import rays
from fogproof.analytic.images.pixel_means import pixel_means
from fogproof.scene import Ball, Ray, Scene, Slab

TOL = 1e-8


def means(f, width, height, most=10**7):
    return pixel_means(lambda x, y: (f(x, y)[:, None], np.zeros((len(x), 1))), (0, 0, width, height), 1, TOL, most)


def check(found, truth, tight):
    off = np.abs(found.value[..., 0] - truth)
    assert (off <= found.error[..., 0] + 1e-13).all()
    assert (found.error[..., 0] <= tight).all(), found.error.max()


def test_smooth_functions_take_one_look_a_pixel():
    rate = 0.05
    found = means(lambda x, y: np.exp(rate * x) * np.cos(rate * y), 40, 30)
    edges_x, edges_y = np.exp(rate * np.arange(41)) / rate, np.sin(rate * np.arange(31)) / rate
    check(found, np.diff(edges_y)[:, None] * np.diff(edges_x), 1e-8 * 10)
    assert found.evaluations == 48 * 38


def test_coarse_features_are_cut_and_still_right():
    found = means(lambda x, y: np.exp(-((x - 5.3) ** 2) - (y - 4.1) ** 2), 10, 8)
    erf = np.vectorize(math.erf)
    gx = np.diff(0.5 * math.sqrt(math.pi) * erf(np.arange(11) - 5.3))
    gy = np.diff(0.5 * math.sqrt(math.pi) * erf(np.arange(9) - 4.1))
    check(found, gy[:, None] * gx, 1e-8)


def test_an_edge_is_told_in_the_error_and_halved_in():
    # A half-plane x + y/2 > 5: shares of pixels are areas of trapezoids.
    found = means(lambda x, y: (x + y / 2 > 5).astype(float), 9, 4)
    fine = 2000
    places = (np.arange(fine) + 0.5) / fine
    truth = np.empty((4, 9))
    for i in range(4):
        for j in range(9):
            share = np.clip(j + 1 - (5 - (i + places) / 2), 0, 1)
            truth[i, j] = share.mean()
    off = np.abs(found.value[..., 0] - truth)
    assert (off <= found.error[..., 0] + 1e-6).all()
    assert found.error.max() < 0.03
    assert (found.error[truth == 1] < 1e-12).all()


def test_a_pole_of_1_over_r_is_narrowed_down():
    # Over a square of side 1 centred on the pole the mean of 1/r is 4 asinh(1).
    with np.errstate(divide="ignore"):
        found = means(lambda x, y: 1 / np.hypot(x - 3.5, y - 2.5), 7, 5)
    off = abs(found.value[2, 3, 0] - 4 * math.asinh(1))
    assert off <= found.error[2, 3, 0] < 1e-5


def test_the_budget_ends_in_an_honest_error():
    rough = means(lambda x, y: np.sin(40 * x) * np.sin(40 * y), 6, 6, most=5000)
    fine = means(lambda x, y: np.sin(40 * x) * np.sin(40 * y), 6, 6)
    assert (np.abs(rough.value - fine.value) <= rough.error + fine.error).all()


def scene(**changed):
    camera = Perspective((0, 0, 0), (0, 0, 1), 0.7, Film(8, 6), wall=10.0)
    given = {"medium": Medium(0.1, 0.4, HenyeyGreenstein(0.6)), "camera": camera, "scattering": "single"}
    given |= {"light": PointLight((0.3, 0.5, 3.0), 3.0), "background": 0.1}
    return ImageScene(**(given | changed))


def test_an_image_is_the_mean_of_the_radiance_of_its_rays():
    found = image(scene())
    nodes, weights = np.polynomial.legendre.leggauss(16)
    x, y = np.meshgrid(0.5 * (nodes + 1) + 1, 0.5 * (nodes + 1) + 4)  # pixel in row 4, column 1
    given = scene()
    seen = radiance(
        Scene(given.medium, rays(given.camera, x, y), "single", given.light, background=given.background)
    ).value
    mean = float(weights @ seen @ weights / 4)
    assert abs(found.value[4, 1] - mean) <= found.error[4, 1] + 1e-12
    relative = found.error / found.value
    assert np.median(relative) < 1e-8
    assert relative.max() < 1e-4  # the pixel of the lamp has a pole in it


def test_a_crop_is_a_part_of_the_whole():
    camera = Perspective((0, 0, 0), (0, 0, 1), 0.7, Film(8, 6, (2, 1, 3, 4)), wall=10.0)
    part, whole = image(scene(camera=camera)), image(scene())
    assert part.value.shape == (4, 3)
    assert (np.abs(part.value - whole.value[1:5, 2:5]) <= part.error + whole.error[1:5, 2:5]).all()


def test_a_medium_in_a_shape_attenuates_what_is_behind_it():
    camera = Orthographic((0, 0, -4), (0, 0, 0), 4.0, Film(4, 4))
    found = image(ImageScene(Medium(0.7, 0.0), camera, background=2.0, shape=Slab((0, 0, -1), (0, 0, -1), 2.0)))
    assert (np.abs(found.value - 2 * math.exp(-1.4)) <= found.error).all()
    assert found.error.max() < 1e-13


def test_the_mean_through_a_ball_is_known():
    # A film that just holds the ball: its mean transmittance over the disc is that of a uniform beam.
    camera = Orthographic((0, 0, -4), (0, 0, 0), 2.0, Film(1, 1))
    found = image(ImageScene(Medium(1.0, 0.0), camera, background=1.0, shape=Ball((0, 0, 0), 1.0)))
    disc = math.pi * (1 - (1 + 2) * math.exp(-2)) / 2
    truth = (disc + 4 - math.pi) / 4
    assert abs(found.value[0, 0] - truth) <= found.error[0, 0] < 0.05


def test_channels_are_the_last_axis():
    found = image(scene(medium=Medium(0.1, (0.1, 0.2, 0.4)), light=PointLight((0.3, 0.5, 3.0), (3.0, 2.0, 1.0))))
    grey = image(scene(medium=Medium(0.1, 0.2), light=PointLight((0.3, 0.5, 3.0), 2.0)))
    assert found.value.shape == (6, 8, 3)
    assert found.value[..., 1] == pytest.approx(grey.value, rel=1e-7)


def test_single_scattering_in_a_shape_is_that_of_the_rays():
    camera = OneRay((0, 0, -4), (0, 0, 0), Film(2, 2))
    slab, light = Slab((0, 0, -1), (0, 0, -1), 2.0), PointLight((0, 1, -3), 2.0)
    found = image(ImageScene(Medium(0.1, 0.5), camera, "single", light, slab))
    ray = Ray((0, 0, -4), (0, 0, 1))
    assert found.value[1, 1] == single_scattering(Medium(0.1, 0.5), ray, light, shape=slab).value


def sky(shape, medium, **changed):
    camera = OneRay((0, 0.0, -4), (0, 0.5, 0), Film(2, 2))
    return image(ImageScene(medium, camera, "multiple", Environment(2.0), shape, background=2.0, **changed))


def test_a_furnace_shows_nothing():
    for shape in (Slab((0, 0, -1), (0, 0, -1), 2.0), Ball((0, 0, 0), 1.0)):
        assert (sky(shape, Medium(0.0, 3.0, HenyeyGreenstein(0.8))).value == 2).all()
        assert (sky(shape, Medium(1.0, 3.0, emission=2.0)).value == 2).all()


def test_absorption_takes_and_emission_gives_the_same_share():
    for shape in (Slab((0, 0, -1), (0, 0, -1), 2.0), Ball((0, 0.4, 0), 1.0)):
        dark = sky(shape, Medium(0.5, 0.5)).value[0, 0]
        glowing = sky(shape, Medium(0.5, 0.5, emission=4.0)).value[0, 0]
        assert 0.2 < dark < 2
        assert glowing - dark == pytest.approx(4.0 * (1 - dark / 2), rel=1e-12)


def test_what_is_not_known_to_the_end_is_refused():
    with pytest.raises(UnsupportedError, match="all orders of scattering"):
        image(scene(scattering="multiple"))
    camera = OneRay((0, 0, 0), (0, 0, 1), Film(1, 1))
    slab, light = Slab((0, 0, -1), (0, 0, -1), 2.0), Environment(1.0)
    within = ImageScene(Medium(1.0, 1.0), camera, "multiple", light, slab, background=1.0)
    with pytest.raises(UnsupportedError, match="outside"):
        image(within)
