"""Invariant: a user's function that jumps or kinks does not fool the quadrature, wherever between its nodes it does."""

import mpmath as mp
import numpy as np
import pytest

from fogproof import analytic
from fogproof.analytic.arithmetic.jump_bound import INSIDE, of_a_jump, of_a_kink
from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS
from fogproof.scene import PiecewiseConstantMedium, PointLight, Procedural, Ray

PLACES = [0.24775276509330763, *np.linspace(0.011, 0.329, 7)]
EVERYWHERE = np.linspace(0, 1, 2001)[1:-1]


def the_rule(f):
    """Return the rule's error and both bounds for f(x, place), at all places."""
    nodes = f(NODES, EVERYWHERE[:, None])
    edges = f(np.array([INSIDE, 1 - INSIDE]), EVERYWHERE[:, None])
    fine = np.linspace(0, 1, 200_001)
    truth = np.array([np.trapezoid(f(fine, place), fine) for place in EVERYWHERE[::20]])
    return np.abs(nodes @ WEIGHTS)[::20] - truth, of_a_jump(nodes, edges)[::20], of_a_kink(nodes)[::20]


@pytest.mark.parametrize(("power", "slack"), [(0, 2e-5), (0.5, 1e-6), (1, 1e-9)])
def test_the_bound_holds_for_jumps_roots_and_kinks(power, slack):
    off, jump, _ = the_rule(lambda x, place: np.where(x > place, np.maximum(x - place, 1e-300) ** power, 0.0))
    assert (np.abs(off) <= jump + slack).all()
    assert np.median(jump / (np.abs(off) + slack)) < 40


def test_falling_coefficients_are_believed_and_flat_ones_are_not():
    assert of_a_kink(np.exp(NODES)) < 1e-16
    _, jump, kink = the_rule(lambda x, place: np.abs(x - place))
    inside = slice(2, -2)
    assert (kink[inside] > 0.01 * jump[inside]).all()
    assert np.median(kink / jump) > 0.3


def step(at, high=0.5):
    return lambda x: np.where(x[..., 2] < at, high, 0.0)


@pytest.mark.parametrize("length", [0.3333480966054559, 1.0])
def test_a_step_is_found_wherever_it_is(length):
    for place in PLACES:
        found = analytic.optical_thickness(Procedural(step(place), 1.0, detail=0.31), Ray((0, 0, 0), (0, 0, 1), length))
        assert abs(found.value - 0.5 * place) <= found.error <= 1e-12 * place


@pytest.mark.parametrize("fall", [0.3, 1e-6, 1e-10])
def test_a_step_that_a_ray_grazes_costs_what_its_place_is_unsure_by(fall):
    """The function is given rounded places: one EPS across the ray is EPS / fall along it."""
    ray = Ray((0.1, 0.2, 0.7), (np.sqrt((1 - fall) * (1 + fall)), 0, fall), 1.0)
    height = 0.7 + 0.4321 * fall
    found = analytic.optical_thickness(Procedural(step(height), 1.0, detail=0.5), ray)
    with mp.workdps(40):
        truth = (mp.mpf(height) - mp.mpf(0.7)) / mp.mpf(float(ray.direction[2])) / 2
    off = float(abs(mp.mpf(float(found.value)) - truth))
    assert off <= found.error <= 1e-13 + 4e-15 / fall


def test_a_kink_is_found_too():
    for place in PLACES[:4]:
        medium = Procedural(lambda x, at=place: np.abs(x[..., 2] - at), majorant=1.0, detail=0.31)
        found = analytic.optical_thickness(medium, Ray((0, 0, 0), (0, 0, 1), 0.5))
        assert abs(found.value - (place**2 + (0.5 - place) ** 2) / 2) <= found.error <= 1e-12


def test_light_that_jumps_is_found_too():
    for place in PLACES[:4]:
        medium = Procedural(lambda x: np.ones(x.shape[:-1]), majorant=1.0, detail=0.31, emission=step(place, high=1.0))
        found = analytic.emitted_radiance(medium, Ray((0, 0, 0), (0, 0, 1), 0.3333480966054559))
        assert abs(found.value + np.expm1(-place)) <= found.error + 1e-16
        assert found.error <= 1e-11


def test_colours_that_jump_at_different_places():
    medium = Procedural(
        lambda x: np.stack([np.where(x[..., 2] < at, 0.5, 1.0) for at in (0.21, 0.77)], axis=-1),
        1.0,
        channels=2,
        detail=0.3,
    )
    found = analytic.optical_thickness(medium, Ray((0, 0, 0), (0, 0, 1), 1.0))
    assert (np.abs(found.value - [0.895, 0.615]) <= found.error).all()
    assert (found.error < 1e-12).all()


def test_a_lamp_over_steps_is_one_over_layers():
    heights, values = np.array([0.2, 0.55]), np.array([0.5, 1.3, 0.8])
    medium = Procedural(
        lambda x: values[np.searchsorted(heights, x[..., 2])],
        1.3,
        lower=(-1, -1, 0),
        upper=(1, 1, 1),
        detail=0.3,
        albedo=0.5,
    )
    layers = PiecewiseConstantMedium((0.0, 0.2, 0.55, 1.0), tuple(values), albedo=0.5)
    ray, lamp = Ray((0, 0, -0.1), (0, 0, 1), 1.2), PointLight((0.3, 0.5, 0.4), 2.0)
    found, truth = (analytic.single_scattering(m, ray, lamp) for m in (medium, layers))
    assert abs(found.value - truth.value) <= found.error + truth.error
    assert found.error < 1e-3 * found.value


def test_smooth_functions_lose_no_digits():
    medium = Procedural(lambda x: 1 + np.sin(3 * x[..., 2]), majorant=2.0, detail=0.3)
    found = analytic.optical_thickness(medium, Ray((0, 0, 0), (0, 0, 1), 2.0))
    assert abs(found.value - (2 + (1 - np.cos(6)) / 3)) <= found.error <= 2e-14


STEPS = [  # heights, values, emission, length: two runs of the solver agree on these better than either is right
    ([0.58166387], [0.39152081, 1.92297271], 0.35978692649261024, 0.618176999305838),
    ([0.11312211, 0.18265619, 0.20632579], [4.20952827, 3.52550881, 2.02864681, 1.15937514], 0.396819966, 0.593884454),
]


@pytest.mark.parametrize(("heights", "values", "glow", "length"), STEPS, ids=["one", "three"])
def test_the_differential_equation_counts_the_steps_that_jumps_are_taken_in(heights, values, glow, length):
    heights, values = np.array(heights), np.array(values)
    detail = float(np.diff(heights).min(initial=length)) * 0.999
    given = {"albedo": 0.4, "emission": glow}
    medium = Procedural(
        lambda x: values[np.searchsorted(heights, x[..., 2])], float(values.max()), detail=detail, **given
    )
    layers = PiecewiseConstantMedium((-1.0, *map(float, heights), length + 1), tuple(map(float, values)), **given)
    ray = Ray((0, 0, 0), (0, 0, 1), length)
    found, truth = analytic.radiance_by_ode(medium, ray), analytic.radiance_by_quadrature(layers, ray)
    assert abs(found.value - truth.value) <= 0.5 * found.error + truth.error
    assert found.error <= 1e-8 * found.value
