"""What comes again is named: the period of a sequence that is used up, few values of a coordinate; a right sequence is neither."""

import numpy as np
import pytest
from laws_by_hand import TURN, about, even, exponential, hold

from fogproof import Discrete, HalfLine, Interval, Product, UnitSphere, UnitSquare, check_sampler

N = 20_000
SEVERAL = 150_000  # samples of more than one call
PERIOD = 1 << 13
STEPS = np.array([0.7548776662466927, 0.5698402909980532])  # the first powers of the root of x^3 = x + 1 (Roberts 2018)


def sequence(i):
    """Return points (n, 2) of low discrepancy."""
    return (0.5 + STEPS * (i[:, None] + 1)) % 1


class Sequence:
    """Points of a sequence, one call after the other, over again when so many are used up."""

    def __init__(self, period):
        self.period, self.given = period, 0

    def __call__(self, rng, n):
        self.given += n
        return sequence(np.arange(self.given - n, self.given) % self.period)


def anew(rng, n):
    """The same points in every call."""
    return sequence(np.arange(n))


def shifted(rng, n):
    """The same points in every call, moved by a vector of its own (Cranley & Patterson 1976)."""
    return (anew(rng, n) + rng.random(2)) % 1


def checked(sample):
    return check_sampler(sample, even(1), UnitSquare(), dimensions=None, samples=SEVERAL, quasi_random=True)


@pytest.mark.parametrize(("sample", "words"), [
    (Sequence(PERIOD), f"begins anew after {PERIOD} points"),
    (anew, "every call begins the sequence anew"),
    (lambda rng, n: np.tile(rng.random((-(-n // 4), 2)), (4, 1))[:n], "repeats itself after"),
])  # fmt: skip
def test_the_period_is_told(sample, words):
    verdict = checked(sample)
    assert (verdict.outcome, verdict.cause) == ("rejected", "repeated samples"), str(verdict)
    assert words in verdict.diagnosis, verdict.diagnosis


@pytest.mark.parametrize("sample", [Sequence(1 << 40), shifted])
def test_a_sequence_that_is_not_used_up_is_right(sample):
    assert checked(sample).outcome == "not rejected"


def test_pairs_of_points_have_no_period():
    verdict = checked(lambda rng, n: np.repeat(rng.random((n, 2)), 2, axis=0)[:n])
    assert (verdict.cause, verdict.diagnosis) == ("repeated samples", "")


def coarse(u, values):
    return (np.floor(values * u) + 0.5) / values


COARSE = {  # values -> sampler, pdf, domain, dimensions; the axis of which they are few
    "a side of a square": (
        lambda k: (lambda u: np.column_stack([u[:, 0], coarse(u[:, 1], k)]), even(1), UnitSquare(), 2),
        "y",
    ),
    "both sides": (lambda k: (lambda u: coarse(u, k), even(1), UnitSquare(), 2), "x"),
    "a cosine": (
        lambda k: (lambda u: about(2 * coarse(u[:, 0], k) - 1, TURN * u[:, 1]), even(2 * TURN), UnitSphere(), 2),
        "mu",
    ),
    "an azimuth": (
        lambda k: (lambda u: about(2 * u[:, 0] - 1, TURN * coarse(u[:, 1], k)), even(2 * TURN), UnitSphere(), 2),
        "phi",
    ),
    "a distance": (
        lambda k: (
            lambda u: np.column_stack([exponential(coarse(u[:, :1], k)), about(2 * u[:, 1] - 1, TURN * u[:, 2])]),
            lambda x: np.exp(-x[:, 0]) / (2 * TURN),
            Product(HalfLine(0), UnitSphere()),
            3,
        ),
        "x",
    ),
    "beside whole numbers": (
        lambda k: (
            lambda u: np.column_stack([np.floor(4 * u[:, 0]), coarse(u[:, 1], k)]),
            even(4),
            Product(Discrete(4), Interval(0, 1)),
            2,
        ),
        "x 2",
    ),
}


@pytest.mark.parametrize("values", [2, 5, 7])
@pytest.mark.parametrize("name", COARSE)
def test_few_values_of_a_coordinate_are_coarse_numbers(name, values):
    case, axis = COARSE[name]
    hold((case(values), "coarse numbers", f"{axis} takes {values} values alone"), N)


def test_few_points_of_a_square_are_atoms():
    points = np.array([[0.1, 0.2], [0.4, 0.6], [0.9, 0.3]])
    case = (lambda u: points[np.floor(3 * u[:, 0]).astype(int)], even(1), UnitSquare(), 1)
    hold((case, "atom", "declare atoms"), N)


def test_values_that_rounding_puts_side_by_side_are_not_few():
    """A lobe of single precision, wrong in its azimuth, has a dozen cosines or so."""

    def sample(u):
        mu = 1 + 3e-7 * np.log1p(-u[:, 0].astype(float))
        return about(np.maximum(mu, -1), 0.9 * TURN * u[:, 1]).astype(np.float32)

    def pdf(x):
        return np.exp((x[:, 2] - 1) / 3e-7) / (TURN * 3e-7)

    verdict = check_sampler(sample, pdf, UnitSphere(), dimensions=2, samples=N, precision="float32")
    assert verdict.outcome == "rejected"
    assert verdict.cause != "coarse numbers", str(verdict)
