"""What people do wrong with one part of a product, or between parts, is named: a scale, a sign, a constant, a curve."""

import numpy as np
import pytest
from laws_by_hand import TURN, about, bell, exponential, hold, normal

from fogproof import HalfLine, Interval, Product, RealLine, UnitSphere

N = 40_000
MORE = 120_000  # pin a factor


def flight(scale, mu):
    return lambda u: np.column_stack([scale * exponential(u), about(mu(u[:, 1]), TURN * u[:, 2])])


def flight_pdf(x):
    """Exponential distance, direction with density (1 + mu) / (4 pi)."""
    return np.exp(-x[:, 0]) * (1 + x[:, 3]) / (2 * TURN)


def forward(u):
    return 2 * np.sqrt(u) - 1


def sometimes(sample, column, value):
    """Return a sampler of which one in twenty has a constant in a column, by a uniform more."""

    def spoilt(u):
        x = sample(u)
        x[:, column] = np.where(u[:, -1] < 0.05, value, x[:, column])
        return x

    return spoilt


def ones(x):
    return np.ones(len(x))


FLIGHT, SQUARE = Product(HalfLine(0), UnitSphere()), Product(Interval(0, 1), Interval(0, 1))
CASES = {  # sampler, pdf, domain, dimensions; the cause and words of what explains it
    "the scale of one part": ((flight(1.4, forward), flight_pdf, FLIGHT, 3), "wrong scale", "in the column 0"),
    "the sign of one part": (
        (flight(1, lambda u: -forward(u)), flight_pdf, FLIGHT, 3),
        "sign convention",
        "in the columns 1 to 3",
    ),
    "the signs of both parts": (
        (
            lambda u: np.abs(np.column_stack([normal(u), normal(u[:, 1:])]) + 0.5),
            lambda x: bell(x[:, 0] - 0.5) * bell(x[:, 1] - 0.5),
            Product(RealLine(), RealLine()),
            2,
        ),
        "lost sign",
        "the signs of coordinate 0 and coordinate 1 are lost",
    ),
    "the signs of a direction": (
        (lambda u: np.abs(flight(1, forward)(u)), flight_pdf, FLIGHT, 3),
        "lost sign",
        "the signs of x, y and z are lost in the columns 1 to 3",
    ),
    "a correlation's sign": (
        (
            lambda u: np.column_stack([-normal(u), 0.6 * normal(u) + 0.8 * normal(u[:, 1:])]),
            lambda x: bell(x[:, 0]) * bell((x[:, 1] - 0.6 * x[:, 0]) / 0.8) / 0.8,
            Product(RealLine(), RealLine()),
            2,
        ),
        "sign convention",
        "",
    ),
    "a distance that is a constant": (
        (sometimes(flight(1, forward), 0, 1.0), flight_pdf, FLIGHT, 4),
        "atom",
        "x[0] = 1",
    ),
    "a coordinate that is a constant": (
        (sometimes(lambda u: u[:, :2].copy(), 1, 0.3), ones, SQUARE, 3),
        "atom",
        "x[1] = 0.3",
    ),
    "a clamped distance": (
        (lambda u: np.minimum(flight(1, forward)(u), [3, 1, 1, 1]), flight_pdf, FLIGHT, 3),
        "clamped",
        "x[0] = 3",
    ),
    "a curve that winds often": (
        (lambda u: np.column_stack([u[:, 0], 100 * u[:, 0] % 1]), ones, SQUARE, 1),
        "correlation",
        "share a uniform",
    ),
    "now and then the diagonal": (
        (lambda u: np.column_stack([u[:, 0], np.where(u[:, 2] < 0.05, u[:, 0], u[:, 1])]), ones, SQUARE, 3),
        "correlation",
        "not together",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_cause_is(name):
    hold(CASES[name], MORE if CASES[name][1] == "wrong scale" else N)
