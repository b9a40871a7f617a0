"""Invariant: several media in one count where they are, add up or give way as was said, and nothing is guessed."""

import numpy as np
import pytest

from fogproof.analytic import coefficients, phase_pdf, phase_pdf_at, single_scattering, transmittance
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import (
    CompositeMedium,
    GaussianPuffs,
    HenyeyGreenstein,
    Medium,
    PointLight,
    Ray,
    Rayleigh,
    VoxelGrid,
)
from fogproof.scene.shapes import Ball, Box, Slab

CORE, FOG = Medium(0.5, 2.0, Rayleigh(), emission=3.0), Medium(0.1, 0.4, HenyeyGreenstein(0.5))
GRID = VoxelGrid(np.arange(8.0).reshape(2, 2, 2) / 4, (-1, -1, -1), (1, 1, 1), albedo=0.5)
SHAPES = (Ball((0, 0, 0), 1.0), Box((-2, -2, -2), (2, 2, 2)), Box((-3, -3, -3), (3, 3, 3)))
WHOLE_RAY = Ray((0.1, 0.2, -5), (0, 0, 1), 10.0)
RAY = Ray((0.1, 0.2, -5), (0, 0, 1), [4.0, 6.0, 10.0])


@pytest.mark.parametrize("overlap", ["sum", "first"])
def test_each_counts_where_it_is(overlap):
    medium = CompositeMedium((CORE, FOG, GRID), SHAPES, overlap)
    found = transmittance(medium, RAY)
    half = np.sqrt(1 - 0.05)
    inner = np.clip(RAY.length - (5 - half), 0, 2 * half)
    outer = np.clip(RAY.length - 3, 0, 4)
    depth = 2.5 * inner + 0.5 * outer if overlap == "sum" else 2.5 * inner + 0.5 * (outer - inner)
    truth = np.exp(-depth) * (transmittance(GRID, RAY).value if overlap == "sum" else 1.0)
    assert np.all(np.abs(found.value - truth) <= found.error + 1e-14 * truth)
    assert np.all(found.error <= 1e-12 * truth)


def test_coefficients_and_emission_add_up():
    both = coefficients(CompositeMedium((CORE, FOG), SHAPES[:2], "sum"), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert both.sigma_t == pytest.approx(3.0)
    assert both.sigma_s == pytest.approx(2.4)
    assert both.sigma_a * both.emission == pytest.approx(0.5 * 3.0)
    alone = coefficients(CompositeMedium((FOG, CORE), SHAPES[1::-1], "first"), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert alone.sigma_t == pytest.approx(0.5)


def test_the_phase_function_is_the_mean_of_what_scatters():
    phase = CompositeMedium((CORE, FOG), SHAPES[:2], "sum").phase
    mu = np.array([-0.4, 0.8])
    inside, outside, nowhere = (phase_pdf_at(phase, (0.0, 0.0, z), mu) for z in (0.0, 1.5, 9.0))
    one, other = phase_pdf(Rayleigh(), mu).value, phase_pdf(HenyeyGreenstein(0.5), mu).value
    assert np.all(np.abs(inside.value - (2.0 * one + 0.4 * other) / 2.4) <= inside.error + 1e-16)
    assert np.all(np.abs(outside.value - other) <= outside.error)
    assert nowhere.value.tolist() == [0, 0]


def test_a_medium_cut_in_two_is_the_same():
    whole, halves = Box((-2, -2, -2), (2, 2, 2)), (Box((-2, -2, -2), (2, 2, 0)), Box((-2, -2, 0), (2, 2, 2)))
    lamp = PointLight((0.5, 1.0, 0.5), 3.0)
    one = single_scattering(FOG, WHOLE_RAY, lamp, shape=whole)
    two = single_scattering(CompositeMedium((FOG, FOG), halves), WHOLE_RAY, lamp)
    assert abs(one.value - two.value) <= one.error + two.error
    assert two.error <= 1e-4 * two.value


def test_media_that_end_by_themselves_need_no_shape():
    puffs = GaussianPuffs([(5.0, 5.0, 5.0)], 0.1, 1.0)
    medium = CompositeMedium((GRID, puffs), (), "sum")
    assert transmittance(medium, RAY).value == pytest.approx(transmittance(GRID, RAY).value, rel=1e-14)


@pytest.mark.parametrize(
    ("make", "argument", "rule"),
    [
        (lambda: CompositeMedium((CORE, FOG)), "overlap", "must say what counts where media overlap"),
        (lambda: CompositeMedium((CORE, FOG), SHAPES[:2]), "overlap", "say overlap='sum' or overlap='first'"),
        (lambda: CompositeMedium((CORE, FOG), SHAPES[:1], "sum"), "shapes", "one shape a medium"),
        (lambda: CompositeMedium((), (), "sum"), "media", "1 to 64 media"),
        (lambda: CompositeMedium((CORE, 3), (), "sum"), "media", "list of media"),
        (lambda: CompositeMedium((CORE,), (), "blend"), "overlap", "one of refused, sum, first"),
    ],
)
def test_what_is_not_said_is_refused_by_name(make, argument, rule):
    with pytest.raises(InvalidValueError, match=rule) as raised:
        make()
    assert raised.value.argument == argument


def test_adjacent_slabs_and_no_composite_in_another():
    apart = CompositeMedium((CORE, FOG), (Slab((0, 0, 0), (0, 0, 1), 1.0), Slab((0, 0, -1), (0, 0, 1), 1.0)))
    assert apart.upper.tolist() == [np.inf, np.inf, 0]
    with pytest.raises(UnsupportedError, match="a composite medium holds none"):
        CompositeMedium((apart,))
