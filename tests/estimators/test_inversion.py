"""Newton's method between bounds: the last digit, no stall where rounding decides, no element disturbed by its neighbours."""

import numpy as np
import pytest

from fogproof.estimators.inversion import inverted


def cube(target):
    return lambda t, which: (t**3 - target[which], 3 * t * t)


def test_roots_to_the_last_digit_wherever_it_starts():
    target = np.geomspace(1e-9, 1e9, 121)
    low, high = np.zeros_like(target), np.full_like(target, 1e4)
    for start in (np.full_like(target, 1e4), np.full_like(target, 1e-3), np.cbrt(target) * (1 + 1e-6)):
        found = inverted(cube(target), start, low, high)
        assert np.max(np.abs(found / np.cbrt(target) - 1)) < 5e-16


def test_a_root_that_is_met_exactly_is_kept():
    found = inverted(cube(np.array([8.0])), np.array([2.0]), np.array([0.0]), np.array([3.0]))
    assert found.tolist() == [2.0]


def test_steps_that_rounding_makes_end_it():
    """A function that is told to 1e-12 alone: without an end to it, every call would take all steps."""
    calls, target = [], np.linspace(1, 2, 1000)

    def noisy(t, which):
        calls.append(len(t))
        return t**3 - target[which] + 1e-12 * np.sin(1e16 * t), 3 * t * t

    found = inverted(noisy, target.copy(), np.zeros(1000), np.full(1000, 3.0))
    assert np.max(np.abs(found - np.cbrt(target))) < 2e-12
    assert len(calls) <= 25


@pytest.mark.parametrize("slope", [0.0, np.nan, -1.0])
def test_a_slope_that_says_nothing_leaves_halving(slope):
    found = inverted(
        lambda t, which: (t - 0.3, np.full_like(t, slope)), np.array([0.9]), np.array([0.0]), np.array([1.0])
    )
    assert abs(found[0] - 0.3) < 1e-15


def test_elements_do_not_know_each_other():
    target = np.random.default_rng(0).uniform(0.1, 20, 200)
    together = inverted(cube(target), np.ones(200), np.zeros(200), np.full(200, 4.0))
    alone = [inverted(cube(x), np.ones(1), np.zeros(1), np.full(1, 4.0))[0] for x in target[:, None]]
    assert together.tolist() == alone
    assert inverted(cube(target[:0]), np.ones(0), np.zeros(0), np.ones(0)).shape == (0,)
