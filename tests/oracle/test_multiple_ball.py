"""Invariant: a ball under a uniform sky sends back and shows what the transport equation says, within the stated error."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import exp1

from fogproof.analytic import (
    ball_albedo,
    ball_albedo_orders,
    ball_radiance,
    ball_radiance_orders,
    ball_source,
)
from fogproof.errors import InvalidValueError

VALUES = json.loads((Path(__file__).parents[1] / "data" / "reference-values.json").read_text())
ROWS = {
    (float(c), float(name.split("=")[1])): row
    for c, rows in VALUES["slab_and_sphere_isotropic"]["values"].items()
    for name, row in rows.items()
    if name.startswith("sphere")
}
albedos = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1), st.floats(-16, 0).map(lambda x: 1 - 10.0**x))
radii = st.one_of(st.just(0.0), st.floats(-9, 4).map(lambda x: 10.0**x))


@pytest.mark.parametrize(("c", "radius"), ROWS)
def test_reference_values(c, radius):
    """The table has about 15 digits of the albedo and of the source at the surface, 12 inside the smallest ball."""
    row = ROWS[c, radius]
    albedo = ball_albedo(c, radius)
    assert abs(albedo.value - float(row["albedo"])) <= albedo.error
    assert albedo.error <= 1e-12
    source = ball_source(c, radius, [0, radius / 2, radius])
    truth = np.array([float(row[key]) for key in ("S(0)", "S(R/2)", "S(R)")])
    assert np.all(np.abs(source.value - truth) <= source.error + 1e-12)


@given(st.floats(0.05, 1), st.floats(-1, 1).map(lambda x: 10.0**x))
@settings(max_examples=15, deadline=None)
def test_the_source_solves_the_integral_equation(c, radius):
    """S(r) = c e(r) + c/(2 r) int_0^R (E1|r - r'| - E1(r + r')) r' S(r') dr', e the mean of exp(-distance to the surface)."""
    y, w = np.polynomial.legendre.leggauss(60)
    y, w = (1 + y) / 2, w / 2
    graded, slope = y**4, 4 * y**3 * w
    for r in (0.3 * radius, 0.9 * radius):
        # The kernel is singular at r and the source is not smooth at R: panels graded towards both.
        nodes, weights = [], []
        for centre, end in ((r, 0.0), (r, (r + radius) / 2), (radius, (r + radius) / 2)):
            nodes.append(centre + (end - centre) * graded)
            weights.append(abs(end - centre) * slope)
        x, v = np.concatenate(nodes), np.concatenate(weights)
        kernel = exp1(np.abs(r - x)) - exp1(r + x)
        mu = np.concatenate([-1 + graded, 1 - graded])
        chord = -r * mu + np.sqrt(radius**2 - r**2 * (1 - mu**2))
        direct = np.sum(np.concatenate([slope, slope]) * np.exp(-chord)) / 2
        right = c * (direct + np.sum(v * kernel * x * ball_source(c, radius, x).value) / (2 * r))
        assert ball_source(c, radius, r).value == pytest.approx(right, abs=1e-9)


@given(albedos, st.floats(-3, 2).map(lambda x: 10.0**x))
@settings(max_examples=20, deadline=None)
def test_what_cameras_see_is_what_leaves(c, radius):
    """The albedo is the mean of the radiance over all chords, whose cosines to the surface have density 2 mu."""
    y, w = np.polynomial.legendre.leggauss(40)
    y, w = (1 + y) / 2, w / 2
    mu, weight = y**2, 4 * y**3 * w
    seen = ball_radiance(c, radius, radius * np.sqrt((1 - mu) * (1 + mu)))
    albedo = ball_albedo(c, radius)
    assert np.sum(weight * seen.value) == pytest.approx(albedo.value, abs=1e-9)
    assert seen.error.max() <= 1e-11


@given(albedos, radii)
@settings(max_examples=30, deadline=None)
def test_bounds_and_furnace(c, radius):
    with np.errstate(all="raise"):
        albedo = ball_albedo(c, radius)
        crossed = ball_albedo(0.0, radius)
        assert crossed.value - crossed.error <= albedo.value + albedo.error
        assert albedo.value <= 1 + albedo.error
        if c == 1:
            assert abs(albedo.value - 1) <= albedo.error
            seen = ball_radiance(1.0, radius, radius * np.array([0, 0.5, 0.99, 1]))
            assert np.all(np.abs(seen.value - 1) <= seen.error)


@pytest.mark.parametrize("radius", [1e-6, 0.2, 1.0, 30.0])
def test_without_scattering_only_what_crosses_remains(radius):
    """The mean of exp(-chord) over chords with density l/(2 R^2) on (0, 2 R)."""
    y, w = np.polynomial.legendre.leggauss(80)
    chord = (1 + y) * radius
    truth = np.sum(w * radius * chord / (2 * radius**2) * np.exp(-chord))
    for c in (0.0, 1e-300):
        reference = ball_albedo(c, radius)
        assert abs(reference.value - truth) <= reference.error + 1e-14


def test_orders_begin_with_what_crosses_and_add_up():
    orders = ball_albedo_orders(1.3, 20)
    crossed = ball_albedo(0.0, 1.3)
    assert abs(orders.value[0] - crossed.value) <= orders.error[0]
    powers = 0.2 ** np.arange(21)
    whole = ball_albedo(0.2, 1.3)
    assert abs(orders.value @ powers - whole.value) <= orders.error @ powers + whole.error + 1e-13
    impact = np.array([0.0, 0.7, 1.2])
    seen = ball_radiance_orders(1.3, impact, 20)
    assert seen.value.shape == (3, 21)
    assert np.all(np.abs(seen.value[:, 0] - np.exp(-2 * np.sqrt(1.3**2 - impact**2))) <= seen.error[:, 0])
    whole = ball_radiance(0.2, 1.3, impact)
    assert np.all(np.abs(seen.value @ powers - whole.value) <= seen.error @ powers + whole.error + 1e-13)


def test_shapes_broadcast():
    reference = ball_radiance(np.array([[0.5], [0.9]]), 2.0, [0.0, 1.0, 2.0])
    assert reference.value.shape == reference.error.shape == (2, 3)
    assert ball_albedo([0.1, 0.2], 1.0).value.shape == (2,)
    assert ball_source(0.5, 1.0, 0.5).value.shape == ()


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: ball_albedo(2.0, 1.0), "albedo"),
        (lambda: ball_albedo(0.5, -1.0), "radius"),
        (lambda: ball_radiance(0.5, 1.0, 1.1), "impact"),
        (lambda: ball_source(0.5, 1.0, [0.5, -0.1]), "distance"),
        (lambda: ball_source(0.5, [1.0, 2.0], [0.1, 0.1, 0.1]), "distance"),
        (lambda: ball_albedo_orders(0.0, 3), "radius"),
    ],
)
def test_bad_arguments_are_named(call, argument):
    with pytest.raises(InvalidValueError) as raised:
        call()
    assert raised.value.argument == argument
