"""Labels in strips along each axis: errors that repeat, or that one coordinate alone shows, in several dimensions."""

import math

import numpy as np
import pytest

from fogproof import Box, UnitSphere, check_sampler
from fogproof.checks.statistics.label_strips import Strips, strips
from fogproof.domains import Discrete, Product

SHARES = np.array([0.5, 0.3, 0.2])


def direction(u, v):
    mu, phi = 1 - 2 * u, 2 * np.pi * v
    sine = np.sqrt((1 - mu) * (1 + mu))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


def channel_and_direction(shares):
    def sample(u):
        channel = np.minimum(np.searchsorted(np.cumsum(shares), u[:, 0], side="right"), 2)
        return np.column_stack([channel, direction(u[:, 1], u[:, 2])])

    return sample


def striped(depth, stripes, axis):
    """Uniform points of a box, but for stripes across an axis where the density is 1 + depth and 1 - depth in turn."""

    def sample(u):
        y = stripes / 2 * u[:, axis]
        stripe = np.floor(y)
        y -= stripe
        first = (1 + depth) / 2
        x = u.copy()
        x[:, axis] = (stripe + np.where(y < first, 0.5 * y / first, 0.5 + 0.5 * (y - first) / (1 - first))) / (
            stripes / 2
        )
        return np.minimum(x, 1.0)

    return sample


def chequered(depth):
    """The same in the squares of a chessboard of two coordinates of five: each alone is uniform."""

    def sample(u):
        darker = np.where(np.floor(8 * u[:, 0]) % 2 == 0, 1, -1)
        y = 4 * u[:, 3]
        pair = np.floor(y)
        y -= pair
        first = (1 + darker * depth) / 2
        x = u.copy()
        x[:, 3] = np.minimum(
            (pair + np.where(y < first, 0.5 * y / first, 0.5 + 0.5 * (y - first) / (1 - first))) / 4, 1.0
        )
        return x

    return sample


def ones(x):
    return np.ones(len(x))


def shares_of(x):
    return SHARES[x[:, 0].astype(int)] / (4 * np.pi)


FIVE, THREE = Box((0.0,) * 5, (1.0,) * 5), Box((0.0,) * 3, (1.0,) * 3)
SUBJECTS = {
    "channels": (channel_and_direction(SHARES), shares_of, Product(Discrete(3), UnitSphere()), 3, "not rejected"),
    "other channels": (
        channel_and_direction([0.52, 0.28, 0.2]),
        shares_of,
        Product(Discrete(3), UnitSphere()),
        3,
        "axis",
    ),
    "uniform": (lambda u: u, ones, FIVE, 5, "not rejected"),
    "stripes": (striped(0.15, 128, 2), ones, THREE, 3, "x3"),
    "chessboard": (chequered(0.3), ones, FIVE, 5, "squares"),
}


@pytest.mark.parametrize("name", SUBJECTS)
def test_what_repeats_is_seen_in_several_dimensions(name):
    sample, pdf, domain, dimensions, expected = SUBJECTS[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=100_000, alpha=1e-6)
    found = next(f for f in verdict.findings if f.check == "labels along the axes")
    assert (found.outcome == "rejected") == (verdict.outcome == "rejected") == (expected != "not rejected"), str(
        verdict
    )


def _found(shift, n, rng, strip_count=16):
    """Return what is found of `n` coins of probability 1/2 at points of [0, 1]^3, odd strips of the first axis having more."""
    u = rng.random((n, 3))
    where = Strips.of(rng.random((1 << 16, 3)))
    odd = np.where(np.floor(strip_count * u[:, 0]) % 2 == 1, 1.0, -1.0)
    told = (rng.random(n) < 0.5 + 0.25 * shift * odd).astype(float)
    return strips("", where, ("x", "y", "z"), where.sums(u, told, np.full(n, 0.5)), 1e-6)


def test_strips_find_an_error_of_the_stated_size():
    """A ratio of densities 1 + s in one half of the strips and 1 - s in the other moves a coin by w (1 - w) s."""
    rng = np.random.default_rng()
    stated = _found(0.0, 1 << 15, rng).resolution.value
    for shift, least, most in ((stated, 0.9, 1.0), (stated / 2, 0.0, 0.5)):
        caught = np.mean([_found(shift, 1 << 15, rng).outcome == "rejected" for _ in range(40)])
        assert least <= caught <= most, f"{shift}: {caught}"


def test_right_coins_are_hardly_ever_rejected():
    """Coins of any probability, at places that crowd: the p-value is a bound."""
    rng = np.random.default_rng()
    small = 0
    for _ in range(60):
        u = rng.random((4000, 2)) ** 3
        w = rng.random(4000)
        where = Strips.of(u[:2000])
        sums = where.sums(u, (rng.random(4000) < w).astype(float), w)
        small += strips("", where, ("x", "y"), sums, 1e-6).p_value < 0.01
    assert small <= 6, f"{small} of 60 below .01"  # 0.6 expected at most; 7 or more come once in a million


def test_squares_of_the_next_level_are_neighbours():
    where = Strips.of(np.random.default_rng(1).random((4096, 2)))
    u = np.array([[0.01, 0.01], [0.01, 0.09], [0.09, 0.01], [0.09, 0.09], [0.99, 0.99]])
    cells = np.flatnonzero(where.sums(u, np.ones(5), np.full(5, 0.5))[0, 2])
    assert (cells // 4).tolist() == [0, 0, 0, 0, 63]


def test_many_axes_are_looked_at_as_far_as_it_goes():
    where = Strips.of(np.random.default_rng(1).random((100, 30)))
    assert where.size == 16
    assert Strips.of(np.zeros((10, 1))).size == 0
    assert math.isclose(float(Strips.of(np.empty((0, 2))).edges[0, 127]), 0.5)
