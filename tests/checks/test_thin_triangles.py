"""Triangles of any shape: area, law, what lies in them and the verdict on a right sampler hold for thin ones in any direction."""

import math
from fractions import Fraction

import numpy as np
import pytest

from fogproof import SphericalTriangle, Triangle, check_sampler

THIN = [
    ((0, 0, 0), (1, 1, 1), (0.5, 0.5, 0.53)),
    ((0, 0, 0), (1, 1, 1), (0.5, 0.5, 0.5001)),
    ((0, 0, 0), (1, 1, 1), (0.5, 0.5, 0.5 + 1e-9)),
    ((1, 2, 3), (1.5, 2.1, 3.3), (1.25, 2.05, 3.151)),
    ((1, 2, 3), (1.5, 2.1, 3.3), (1.25, 2.05, 3.1501)),
    ((0.3, 0.6, 0.901), (0, 0, 0), (1, 2, 3)),
    ((1, 2, 3), (0.3, 0.6, 0.901), (0, 0, 0)),
    ((10, 20, 30), (11, 20.5, 30.2), (10.5, 20.25, 30.101)),
    ((0, 0), (1, 0), (0.5, 1e-7)),
    ((0, 0), (1, 0), (0.5, 1e-8)),
    ((0, 0, 0), (1, 0, 0), (0.5, 3e-7, 0)),
]


def sampler(corners):
    """Return Turk's (1990) map by shares of the corners."""
    a, b, c = np.array(corners, dtype=float)

    def sample(u):
        root = np.sqrt(u[:, :1])
        return a * (1 - root) + b * (root * (1 - u[:, 1:])) + c * (root * u[:, 1:])

    return sample


def area(corners):
    """Return half the exact cross product's length."""
    a, b, c = ([*map(Fraction, corner), Fraction(0)][:3] for corner in corners)
    p, q = ([y - x for x, y in zip(a, corner, strict=True)] for corner in (b, c))
    cross = [p[i - 2] * q[i - 1] - p[i - 1] * q[i - 2] for i in range(3)]
    return math.hypot(*map(float, cross)) / 2


@pytest.mark.parametrize("corners", THIN)
def test_area_law_and_points_of_a_thin_triangle(corners):
    domain, u = Triangle(*corners), np.random.default_rng(1).random((5000, 2))
    assert domain.measure == pytest.approx(area(corners), rel=1e-14)
    x = sampler(corners)(u)
    assert domain.contains(x, 2e-15).all()
    law = domain.law(x)
    np.testing.assert_allclose(law.density(x), 1 / area(corners), rtol=1e-14)
    rounding = 1e-15 * np.abs(corners).max() / (2 * domain.measure)  # of the points, in heights of sides up to 1
    np.testing.assert_allclose(law.coordinates(law.place(u), u)[:, 0], u[:, 0], atol=1e-14 + 8 * rounding)


@pytest.mark.parametrize("corners", [case for case in THIN if len(case[0]) == 3])
def test_points_off_the_plane_or_beyond_a_side_are_not_in_it(corners):
    domain, (a, b, c) = Triangle(*corners), np.array(corners, dtype=float)
    middle, size = (a + b + c) / 3, np.ptp(np.array(corners), axis=0).max()
    across = np.cross(b - a, [0.3, -0.5, 0.7])  # far from the plane of each
    off = middle + 1e-9 * size * across / np.linalg.norm(across)
    beyond = [middle + 1.001 * ((p + q) / 2 - middle) for p, q in ((a, b), (b, c), (c, a))]
    outside = np.array([middle + 1.01 * (corner - middle) for corner in (a, b, c)])
    assert not domain.contains(outside, 2e-15).any()
    if domain.measure > 1e-8:  # else rounding is more than a thousandth of the height
        assert not domain.contains(np.array(beyond), 2e-15).any()
        assert not domain.contains(off[None], 2e-15).any()


@pytest.mark.parametrize("corners", THIN[::2])
def test_a_right_sampler_of_a_thin_triangle_is_not_rejected(corners):
    pdf = lambda x: np.full(len(x), 1 / area(corners))  # noqa: E731
    verdict = check_sampler(sampler(corners), pdf, Triangle(*corners), dimensions=2, samples=5000, seed=1)
    assert verdict.outcome == "not rejected", str(verdict)


def test_a_wrong_pdf_on_a_thin_triangle_is_seen_by_the_map():
    corners = ((0, 0), (1, 0), (0.5, 1e-7))
    pdf = lambda x: np.full(len(x), 0.9999 / area(corners))  # noqa: E731
    verdict = check_sampler(sampler(corners), pdf, Triangle(*corners), dimensions=2, samples=5000, seed=1)
    assert [f.check for f in verdict.findings if f.outcome == "rejected"] == ["pdf against the map"]


@pytest.mark.parametrize("s", [1e-2, 1e-5, 1e-7])
def test_the_solid_angle_of_a_narrow_spherical_triangle(s):
    """For small s it is half the determinant: that of corners (1, 0, 0), (1, s, t), (1, 2 s, 2 t + s^2)."""
    t = 0.7 * s
    domain = SphericalTriangle((1, 0, 0), (1, s, t), (1, 2 * s, 2 * t + s**2))
    last = Fraction(2 * t + s**2)
    determinant = Fraction(s) * last - Fraction(t) * Fraction(2 * s)
    assert domain.measure == pytest.approx(float(determinant) / 2, rel=8 * s**2 + 1e-14)
