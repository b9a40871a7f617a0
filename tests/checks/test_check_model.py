"""What a claimed density says is found by quadrature, whatever hides between its nodes; cells have the probabilities they claim."""

import numpy as np
import pytest

from fogproof.checks.density.charts import chart_of
from fogproof.checks.density.grid_of_density import grid_of
from fogproof.checks.density.model import Effort, integrated, looked_at
from fogproof.checks.density.rounding import Rounded, blurred
from fogproof.checks.subject import nudged
from fogproof.domains import Interval, UnitDisk, UnitHemisphere, UnitSphere

EFFORT = Effort(2e-8, 1_500_000, 2.0**-50)
POLE, TILTED = (0.0, 0.0, 1.0), (2 / 7, -3 / 7, 6 / 7)


def bell(centre, width, mass):
    return lambda x: mass * np.exp(-0.5 * ((x - centre) / width) ** 2) / (width * np.sqrt(2 * np.pi))


def hole(left, width):
    return lambda x: np.where((x >= left) & (x < left + width), 0.0, 1 / (1 - width))


HIDDEN = [
    ("a hole of width 1e-4", hole(0.300123, 1e-4), 1.0),
    ("a hole of width 2e-3", hole(0.123, 2e-3), 1.0),
    ("a peak of width 1e-4 that a few samples show", lambda x: 0.999 + bell(0.7312345, 1e-4, 1e-3)(x), 1.0),
    ("a hole that no pdf of 1 has", lambda x: np.where(np.abs(x - 0.7) < 5e-5, 0.0, 1.0), 1 - 1e-4),
]


@pytest.mark.parametrize(("name", "pdf", "truth"), HIDDEN, ids=[case[0] for case in HIDDEN])
def test_a_feature_between_the_nodes_is_found(name, pdf, truth):
    chart = chart_of(Interval(0, 1), np.empty(0), None)
    rng = np.random.default_rng(11)
    pilot = rng.random(16_384)
    pilot = np.where(rng.random(len(pilot)) < 1e-3, 0.7312345 + 1e-4 * rng.normal(size=len(pilot)), pilot)
    leaves = integrated(chart, lambda c: pdf(c[:, 0]), pilot[:, None], EFFORT)
    assert abs(leaves.total - truth) <= leaves.total_error + 1e-9, name
    assert leaves.total_error < 1e-6


def test_a_peak_that_the_pilot_missed_is_found_by_one_later_sample():
    peak = bell(0.7312345, 1e-7, 1e-4)
    chart = chart_of(Interval(0, 1), np.empty(0), None)
    pilot = np.random.default_rng(12).random(16_384)

    def density(c):
        return 0.9999 + peak(c[:, 0])

    leaves = integrated(chart, density, pilot[:, None], EFFORT)
    assert leaves.total == pytest.approx(0.9999, abs=1e-9), "nothing has shown it so far"
    found = looked_at(density, leaves, np.array([0.73123452]), EFFORT)
    assert abs(found.total - 1) <= found.total_error + 1e-9
    assert looked_at(density, found, np.array([0.73123452]), EFFORT) is found, "and nothing is left to be found"


def henyey_greenstein(g, axis):
    def pdf(x):
        away = 0.5 * np.sum((x - np.copysign(1.0, g) * np.asarray(axis)) ** 2, axis=-1)
        k = abs(g)
        return (1 - k) * (1 + k) / (4 * np.pi * ((1 - k) ** 2 + 2 * k * away) ** 1.5)

    return pdf


def hg_beyond(g, versine):
    """P(1 - mu < versine), from sums of positive terms."""
    distance = np.sqrt((1 - g) ** 2 + 2 * g * versine)
    return (1 + g) * versine / (distance * (distance + 1 - g))


def sphere_model(pdf, axis, samples=100_000, pilot=None):
    chart = chart_of(UnitSphere(), np.empty((0, 3)), axis)
    points = np.empty((0, 2)) if pilot is None else chart.coordinates(pilot)
    density = lambda c: pdf(chart.to_point(c)) * chart.jacobian(c)  # noqa: E731
    leaves = integrated(chart, density, points, EFFORT)
    return chart, leaves, grid_of(chart, leaves, samples)


@pytest.mark.parametrize("g", [0.8, -0.95, 0.999, -0.9999])
@pytest.mark.parametrize("axis", [POLE, TILTED])
def test_henyey_greenstein_is_normalised_about_any_axis(g, axis):
    _, leaves, _ = sphere_model(henyey_greenstein(g, axis), None)
    assert abs(leaves.total - 1) <= leaves.total_error
    assert leaves.total_error < 1e-7


@pytest.mark.parametrize("g", [0.8, -0.95, 0.999])
def test_the_marginal_has_the_cdf_of_the_cosine(g):
    _, _, grid = sphere_model(henyey_greenstein(g, POLE), POLE)
    mu, phi = grid.marginals
    truth = hg_beyond(g, mu.edges)
    assert np.all(np.abs(mu.cdf - truth) <= mu.error + 1e-12)
    np.testing.assert_allclose(phi.cdf, (phi.shown + np.pi) / (2 * np.pi), atol=1e-8)
    assert grid.plane.independent
    assert not sphere_model(henyey_greenstein(g, TILTED), POLE)[2].plane.independent


def test_the_cells_of_the_plane_have_the_masses_of_a_closed_form():
    """Density (1 + x)/(4 pi): the mass of a cell in (mu, phi) is known."""
    _, _, grid = sphere_model(lambda x: (1 + x[:, 0]) / (4 * np.pi), POLE)
    plane, (mu, phi) = grid.plane, grid.marginals
    coarse = [np.append(np.searchsorted(rows * 32 // plane.size, np.arange(32)), len(rows)) for rows in plane.rows]
    m, p = mu.shown[coarse[0]], phi.shown[coarse[1]]
    antiderivative = 0.5 * (m * np.sqrt(1 - m * m) + np.arcsin(m))
    truth = (np.diff(p) * -np.diff(m)[:, None] + np.diff(np.sin(p)) * -np.diff(antiderivative)[:, None]) / (4 * np.pi)
    assert np.all(np.abs(plane.mass - truth) <= plane.error + 1e-10)
    assert np.max(plane.error) < 1e-6


@pytest.mark.parametrize(("domain", "area"), [(UnitHemisphere(), 2 * np.pi), (UnitDisk(), np.pi)])
def test_other_planes_have_their_measure(domain, area):
    chart = chart_of(domain, np.empty(0), None)
    leaves = integrated(chart, chart.jacobian, np.empty((0, 2)), EFFORT)
    assert leaves.total == pytest.approx(area, rel=1e-12)


def test_counted_coordinates_keep_their_digits_near_both_poles():
    angle = np.array([1e-9, 1e-5, 0.3, np.pi - 1e-5, np.pi - 1e-7])
    points = np.stack([np.sin(angle), np.zeros(5), np.cos(angle)], axis=-1)
    chart = chart_of(UnitSphere(), np.empty((0, 3)), POLE)
    versine = chart.count(points)[0]
    np.testing.assert_allclose(versine, 2 * np.sin(angle / 2) ** 2, rtol=1e-15)
    single = points.astype(np.float32).astype(float)
    np.testing.assert_allclose(chart.count(single)[0], versine, rtol=1e-6)


def test_rounding_of_single_precision_points_is_part_of_the_cells_doubt():
    pdf = henyey_greenstein(0.99, POLE)
    rng = np.random.default_rng(8)
    mu = np.clip(1 - 1e-4 * rng.exponential(size=2048), -1, 1)
    sine = np.sqrt(1 - mu * mu)
    points = np.stack([sine, np.zeros(2048), mu], axis=-1)
    chart, _, grid = sphere_model(pdf, POLE)
    coarse = blurred(grid, chart.count, Rounded(points, nudged(points, 2.0**-24), None, 2.0**-24))
    fine = blurred(grid, chart.count, Rounded(points, nudged(points, 2.0**-53), None, 2.0**-53))
    assert coarse.marginals[0].blur.max() > 1e-4
    assert fine.marginals[0].blur.max() < 1e-9
