"""The quadrature behind normalisation: its error bound holds, on smooth, peaked, singular and discontinuous integrands."""

import numpy as np
import pytest

from fogproof.checks.quadrature import integrate_boxes

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
    result = integrate_boxes(lambda c: f(c[:, 0]), np.array([[low]]), np.array([[high]]), 1e-9, 200_000)
    assert abs(result.total - truth) <= result.total_error + 1e-15
    assert result.total_error < 1e-8


def test_plane():
    edges = np.linspace(0, 1, 5)
    low = np.stack(np.meshgrid(edges[:-1], edges[:-1], indexing="ij"), axis=-1).reshape(-1, 2)

    def peak(c):
        return np.exp(-0.5 * np.sum(((c - [0.3, 0.7]) / 0.01) ** 2, axis=-1))

    result = integrate_boxes(peak, low, low + 0.25, 1e-10, 500_000)
    assert abs(result.total - 2 * np.pi * 1e-4) <= result.total_error
    assert result.total_error < 1e-9
    assert abs(result.value[1 * 4 + 2] - 2 * np.pi * 1e-4) < 1e-9, "the peak's mass belongs to the box that holds it"


def test_a_nan_is_never_an_accurate_value():
    result = integrate_boxes(lambda c: np.full(len(c), np.nan), np.zeros((1, 1)), np.ones((1, 1)), 1e-9, 10_000)
    assert not result.total_error < 1e300


def test_the_budget_is_kept_and_the_rest_of_the_error_told():
    rough = integrate_boxes(lambda c: np.sin(1e5 * c[:, 0]) ** 2, np.zeros((1, 1)), np.ones((1, 1)), 1e-12, 3000)
    assert rough.evaluations <= 3000
    assert abs(rough.total - 0.5) <= rough.total_error
