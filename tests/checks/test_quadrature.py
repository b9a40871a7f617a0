"""The quadrature behind normalisation: its error bound holds, on smooth, peaked, singular and discontinuous integrands."""

import numpy as np
import pytest

from fogproof.checks.density.curve import coefficients_of, curve_along, curve_of_line, error_along
from fogproof.checks.density.quadrature import integrate

LINE = [
    ("polynomial", lambda x: 3 * x**2, 0.0, 1.0, 1.0),
    ("oscillating", lambda x: np.cos(50 * x), 0.0, 1.0, np.sin(50) / 50),
    ("narrow", lambda x: np.exp(-0.5 * ((x - 0.3) / 1e-3) ** 2), 0.0, 1.0, 1e-3 * np.sqrt(2 * np.pi)),
    ("inverse root", lambda x: 0.5 / np.sqrt(x), 0.0, 1.0, 1.0),
    ("jump", lambda x: (x > 1 / 3) * 1.0, 0.0, 1.0, 2 / 3),
    ("kink", lambda x: np.abs(x - np.pi / 10), 0.0, 1.0, 0.5 - np.pi / 10 + (np.pi / 10) ** 2),
]


@pytest.mark.parametrize(("name", "f", "low", "high", "truth"), LINE)
def test_line(name, f, low, high, truth):
    result = integrate(lambda c: f(c[:, 0]), np.array([[low]]), np.array([[high]]), 1e-9, 200_000)
    assert abs(result.total - truth) <= result.total_error + 1e-15
    assert result.total_error < 1e-8


def test_plane():
    edges = np.linspace(0, 1, 5)
    low = np.stack(np.meshgrid(edges[:-1], edges[:-1], indexing="ij"), axis=-1).reshape(-1, 2)

    def peak(c):
        return np.exp(-0.5 * np.sum(((c - [0.3, 0.7]) / 0.01) ** 2, axis=-1))

    result = integrate(peak, low, low + 0.25, 1e-10, 500_000)
    assert abs(result.total - 2 * np.pi * 1e-4) <= result.total_error
    assert result.total_error < 1e-9


def test_a_nan_is_never_an_accurate_value():
    result = integrate(lambda c: np.full(len(c), np.nan), np.zeros((1, 1)), np.ones((1, 1)), 1e-9, 10_000)
    assert not result.total_error < 1e300


def test_an_infinite_end_that_holds_little_is_bounded_and_one_that_holds_much_is_not_trusted():
    ends = np.zeros((1, 1)), np.ones((1, 1))
    with np.errstate(all="ignore"):
        mild = integrate(lambda c: 0.5 * (1 - c[:, 0]) ** -0.5, *ends, 1e-9, 200_000)
        wild = integrate(lambda c: 0.1 * (1 - c[:, 0]) ** -0.9, *ends, 1e-9, 200_000)
    assert abs(mild.total - 1) <= mild.total_error < 1e-5
    assert abs(wild.total - 1) <= wild.total_error, "2.5 % of its mass lies within one rounding of 1"


@pytest.mark.parametrize("power", [0.5, 0.75, 0.9])
def test_a_pole_that_no_number_meets_is_no_better_known(power):
    def pole(c):
        t = 1 - c[:, 0]
        return np.where(t > 0, (1 - power) * np.maximum(t, 2.0**-53) ** -power, 0.0)

    result = integrate(pole, np.zeros((1, 1)), np.ones((1, 1)), 1e-9, 200_000)
    assert abs(result.total - 1) <= result.total_error


def test_the_budget_is_kept_and_the_rest_of_the_error_told():
    rough = integrate(lambda c: np.sin(1e5 * c[:, 0]) ** 2, np.zeros((1, 1)), np.ones((1, 1)), 1e-12, 3000)
    assert rough.evaluations <= 3000
    assert abs(rough.total - 0.5) <= rough.total_error


def test_noise_is_not_chased():
    rng = np.random.default_rng(3)
    noisy = integrate(
        lambda c: 1 + 1e-6 * rng.normal(size=len(c)), np.zeros((1, 1)), np.ones((1, 1)), 1e-9, 200_000, noise=1e-6
    )
    assert noisy.evaluations < 1000
    assert abs(noisy.total - 1) <= noisy.total_error < 1e-5


@pytest.mark.parametrize("rate", [0.5, 40.0])
def test_the_polynomials_give_the_cdf_and_the_density_between_the_nodes(rate):
    breaks = np.linspace(0, 1, 4)
    leaves = integrate(lambda c: np.exp(-rate * c[:, 0]), breaks[:-1, None], breaks[1:, None], 1e-9, 10_000)
    curve = curve_of_line(leaves)
    t = np.linspace(0, 1, 1001)
    truth = -np.expm1(-rate * t) / rate
    before, at_edge = error_along(leaves, 0, t)
    assert np.all(np.abs(curve.cdf(t) - truth) <= before + at_edge + 1e-15)
    assert np.max(before + at_edge) < 1e-8
    np.testing.assert_allclose(curve.density(t), np.exp(-rate * t), atol=1e-7)
    shares = np.array([0.1, 0.5, 0.99])
    np.testing.assert_allclose(curve.cdf(curve.quantiles(shares)), shares * truth[-1], rtol=0.05)  # only about there


def test_the_marginals_of_a_plane_are_those_of_the_function():
    """x e^{-xy} + 1 on the unit square, its boxes of very different sizes."""
    low = np.array([[0, 0], [0.5, 0], [0, 0.5], [0.5, 0.5], [0.75, 0.5]])
    high = np.array([[0.5, 0.5], [1, 0.5], [0.5, 1], [0.75, 1], [1, 1]])
    leaves = integrate(lambda c: c[:, 0] * np.exp(-c[:, 0] * c[:, 1]) + 1, low, high, 1e-12, 10**6)
    t = np.linspace(0, 1, 101)[1:]
    np.testing.assert_allclose(curve_along(leaves, 0).density(t), 2 - np.exp(-t), atol=1e-12)
    np.testing.assert_allclose(curve_along(leaves, 0).cdf(t), 2 * t + np.expm1(-t), atol=1e-12)
    along_y = (1 - (1 + t) * np.exp(-t)) / t**2 + 1
    np.testing.assert_allclose(curve_along(leaves, 1).density(t), along_y, atol=1e-12)


def test_coefficients_reproduce_a_product_of_legendre_polynomials():
    leaves = integrate(
        lambda c: (1.5 * (2 * c[:, 0] - 1) ** 2 - 0.5) * (2 * c[:, 1] - 1), np.zeros((1, 2)), np.ones((1, 2)), 1, 225
    )
    expected = np.zeros((15, 15))
    expected[2, 1] = 1
    np.testing.assert_allclose(coefficients_of(leaves)[0], expected, atol=1e-13)
