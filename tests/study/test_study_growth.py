"""The time of a call between the counts and beyond the last: of any power of the count, and none where the counts do not tell."""

import math

import numpy as np
import pytest

from fogproof.study.growth import least_beyond, power_at, time_at, time_beyond
from fogproof.study.speed import Times

COUNTS = np.array([100, 1000, 10_000])
NOISE = np.exp(0.02 * np.array([1, -1, 2, -2, 1.5, -1.5, 0.5, -0.5]))


def times(law, counts=COUNTS, noise=NOISE):
    return [Times(law(count) * np.roll(noise, k)) for k, count in enumerate(counts)]


def line(n):
    return 1e-3 + 1e-6 * n


def square(n):
    return 1e-4 + 1e-9 * n**2


def root(n):
    return 1e-3 * math.sqrt(n)


def inside(at, truth):
    own = at.times.estimate
    return own.low * math.exp(-at.bend[0]) <= truth <= own.high * math.exp(at.bend[1])


@pytest.mark.parametrize("law", [line, square, root])
@pytest.mark.parametrize("count", [100, 300, 739, 1000, 5000, 10_000])
def test_between_counts_the_interval_holds_the_time_of_any_power(law, count):
    at = time_at(COUNTS, times(law), count)
    assert inside(at, law(count))
    assert at.times.estimate.value == pytest.approx(law(count), rel=0.05)


@pytest.mark.parametrize("law", [line, square, root])
def test_beyond_the_last_the_time_is_right_or_none(law):
    for factor in (1.5, 2, 10, 1000):
        at = time_beyond(COUNTS, times(law), factor * COUNTS[-1])
        if isinstance(at, str):
            assert law is not line
            assert factor > 2
            assert "does not grow like a fixed cost" in at
        else:
            assert law is line or factor <= 10
            assert inside(at, law(factor * COUNTS[-1]))


@pytest.mark.parametrize("law", [line, square, root])
def test_no_time_beyond_the_last_is_below_the_least(law):
    for factor in (1.5, 10, 1e3, 1e6):
        least = least_beyond(COUNTS, times(law), factor * COUNTS[-1])
        assert times(law)[-1].estimate.value <= least <= law(factor * COUNTS[-1])
        assert law is square or least > 0.7 * law(factor * COUNTS[-1])


def test_samples_lost_in_the_noise_of_the_call_bound_nothing():
    one = times(lambda n: 7e-5 + 2e-8 * n, np.array([1, 2, 4]))
    assert least_beyond(np.array([1, 2, 4]), one, 1000) == one[-1].estimate.value
    assert least_beyond(COUNTS[:1], times(line)[:1], 1000) == times(line)[0].estimate.value


def test_one_count_tells_no_time_of_more():
    assert "one count" in time_beyond(COUNTS[:1], times(line)[:1], 200)
    assert power_at(COUNTS[:1], times(line)[:1], 200) == 1


def test_samples_that_took_no_time_beside_the_call_tell_none():
    """1, 2 and 4 samples of 20 ns in calls of 70 us: a thousand would take anything."""
    counts = np.array([1, 2, 4])
    at = time_beyond(counts, times(lambda n: 7e-5 + 2e-8 * n, counts), 1000)
    assert "too little time beside the call" in at


def test_a_time_between_two_counts_is_between_theirs():
    """Rounds in contrary moods: the mean of sums is larger than either mean."""
    moody = [Times(np.array([1.0, 16, 1, 16])), Times(np.array([17.0, 1.1, 17, 1.1]))]
    middle = time_at(np.array([10, 20]), moody, 15).times.estimate.value
    assert moody[0].estimate.value <= middle <= moody[1].estimate.value


@pytest.mark.parametrize(("law", "power"), [(lambda n: 1e-6 * n, 1), (lambda n: 1e-9 * n**2, 2), (root, 0.5)])
def test_the_power_with_which_a_time_grows(law, power):
    assert power_at(COUNTS, times(law), 3000) == pytest.approx(power, rel=0.03)


def test_a_step_of_the_cache_is_no_power_that_goes_on():
    """Three times as long a sample from 10 000 on, and no longer after that: the line is told, the power is inside the interval."""
    counts = np.array([100, 1000, 10_000, 100_000])

    def stepped(n):
        return 5e-4 + 2.5e-8 * min(n, 10_000) + 7.5e-8 * max(n - 10_000, 0)

    at = time_beyond(counts, times(stepped, counts), 2e6)
    assert at.times.estimate.value == pytest.approx(stepped(2e6), rel=0.05)
    assert at.bend[1] > math.log(2)
    assert "does not grow" in time_beyond(counts, times(stepped, counts), 1e10)
