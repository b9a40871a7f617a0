"""Where samples come back to one point, the diagnosis says how often, and whether what lies beyond was clamped to it."""

import re

import numpy as np
import pytest

from fogproof import HalfLine, Interval, UnitSquare
from fogproof.checks import check_sampler


def exponential(u):
    return -np.log1p(-u[:, 0])


def density(t):
    return np.exp(-t)


@pytest.mark.parametrize("most", [0.5, 3.0, 6.0])
def test_a_clamp_is_named_with_where_and_how_much(most):
    verdict = check_sampler(
        lambda u: np.minimum(exponential(u), most), density, HalfLine(0.0), dimensions=1, samples=200_000
    )
    assert (verdict.outcome, verdict.cause) == ("rejected", "clamped")
    assert f"x = {most:g}" in verdict.diagnosis
    share, lost = (float(found) for found in re.findall(r"(\S+) (?:of the samples|beyond it)", verdict.diagnosis))
    assert share == pytest.approx(np.exp(-most), rel=0.5)
    assert lost == pytest.approx(np.exp(-most), rel=0.5)


def test_a_clamp_below_and_in_a_plane():
    verdict = check_sampler(lambda u: np.maximum(u[:, 0], 0.1), lambda x: np.ones(len(x)), Interval(0, 1), dimensions=1)
    assert (verdict.cause, "x = 0.1" in verdict.diagnosis) == ("clamped", True)
    verdict = check_sampler(
        lambda u: np.column_stack([u[:, 0], np.minimum(u[:, 1], 0.75)]),
        lambda x: np.ones(len(x)),
        UnitSquare(),
        dimensions=2,
    )
    assert (verdict.cause, "x[1] = 0.75" in verdict.diagnosis) == ("clamped", True)


def test_a_point_of_its_own_is_no_clamp():
    """A tenth of all samples, from anywhere, at 2: outermost or not, the pdf lacks nothing beyond."""

    def often(u):
        return np.where(u[:, 1] < 0.1, 2.0, exponential(u))

    verdict = check_sampler(often, density, HalfLine(0.0), dimensions=2)
    assert (verdict.outcome, verdict.cause) == ("rejected", "atom")
    assert "of the samples are 2" in verdict.diagnosis
    assert "declare atoms=" in verdict.diagnosis


def test_numbers_of_few_bits_are_not_clamped():
    verdict = check_sampler(
        lambda u: np.floor(u[:, 0] * 200) / 200, lambda x: np.ones(len(x)), Interval(0, 1), dimensions=1
    )
    assert (verdict.outcome, verdict.cause) == ("rejected", "coarse numbers")
