"""A majorant that is exact is not rejected for the rounding of its function, and one that is too low is, wherever it is."""

import numpy as np
import pytest

from fogproof import Box, Interval, InvalidValueError, UnitSphere, check_bound


def henyey_greenstein(g, axis):
    axis = np.asarray(axis) / np.linalg.norm(axis)
    return lambda w: (1 - g * g) / (1 + g * g - 2 * g * (w @ axis)) ** 1.5


@pytest.mark.parametrize("axis", [(0, 0, 1), (0.3, -0.5, 0.81)])
@pytest.mark.parametrize("g", [0.5, 0.95, 0.999])
def test_a_peak_that_rounding_blurs_may_reach_its_bound(g, axis):
    highest = (1 - g * g) / (1 - g) ** 3
    assert check_bound(henyey_greenstein(g, axis), highest, UnitSphere()).outcome == "not rejected"
    assert check_bound(henyey_greenstein(g, (0, 0, 1)), (1 - 1e-5) * highest, UnitSphere()).outcome == "rejected"


def test_rounding_at_one_place_does_not_hide_an_excess_at_another():
    g = 0.95
    highest = (1 - g * g) / (1 - g) ** 3
    peak = henyey_greenstein(g, (0, 0, 1))
    verdict = check_bound(lambda w: np.where(w[:, 0] > 0.95, 1.01 * highest, peak(w)), highest, UnitSphere())
    assert verdict.outcome == "rejected"


@pytest.mark.parametrize("excess", [1e-8, 1e-12])
def test_a_jump_is_no_rounding(excess):
    step = lambda x: np.where(x < 0.7, 1.0, 0.0)  # noqa: E731
    assert check_bound(step, 1 - excess, Interval(0.0, 1.0)).outcome == "rejected"
    assert check_bound(step, 1.0, Interval(0.0, 1.0)).outcome == "not rejected"


def test_corners_of_many_dimensions_are_visited():
    assert check_bound(lambda x: np.prod(x, axis=1), 0.99, Box([0] * 12, [1] * 12)).outcome == "rejected"
    assert check_bound(lambda x: np.prod(1 - x, axis=1), 0.99, Box([0] * 8, [1] * 8)).outcome == "rejected"


def test_words():
    verdict = check_bound(lambda x: np.where(x > 0.5, np.nan, x), 1.0, Interval(0.0, 1.0))
    assert "f = nan is no number that a bound could hold" in str(verdict)
    with pytest.raises(InvalidValueError, match="evaluations must be a whole number >= 100"):
        check_bound(lambda x: x, 1.0, Interval(0.0, 1.0), evaluations=10)
