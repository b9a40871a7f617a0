"""An error is reached where the measured curve stays below it from then on; times are read off between the measured counts."""

from itertools import pairwise

import numpy as np
import pytest

from fogproof.study.convergence import Estimate
from fogproof.study.error_curve import reaches_of
from fogproof.study.reaching import ErrorOverTime, Reach, reach_of
from fogproof.study.speed import Times

COUNTS = np.array([10, 100, 1000])


def reach(sizes, target, law=None, stays=0.0, smooth=False):
    errors = [Estimate(size, size, size) for size in sizes]
    times = [Times(1e-3 * count * np.array([1, 1.1] * 4)) for count in COUNTS]
    return reach_of(ErrorOverTime(COUNTS, errors, times, law, stays, smooth), target, target)


@pytest.mark.parametrize(
    ("sizes", "target", "how", "samples"),
    [
        ((0.1, 0.01, 0.001), 0.01, "measured", 100),
        ((0.1, 0.01, 0.001), 10**-2.5, "measured", 10**2.5),
        ((0.1, 0.01, 0.001), 0.2, "less-than", 10),
        ((0.1, 0.01, 0.001), 1e-4, "not-reached", None),
        ((0.2, 0.05, 0.3), 0.1, "rises", None),  # it was below, and rises again
        ((0.2, 0.3, 0.4), 0.1, "rises", None),  # none was near enough, and the error grows
        ((0.2, 0.8, 0.4), 0.1, "not-reached", None),  # it falls again
        ((0.05, 0.2, 0.02), 0.1, "measured", 100 * 10 ** (np.log10(2) / 1)),  # the first time does not count
    ],
)
def test_the_error_stays_below_from_there_on(sizes, target, how, samples):
    found = reach(sizes, target)
    assert (found.how, found.samples) == (how, samples if samples is None else pytest.approx(samples, rel=1e-12))


def test_a_lucky_crossing_of_what_is_not_random_is_no_error_that_rises():
    assert reach((0.2, 0.05, 0.3), 0.1, smooth=True).how == "not-reached"


def flat(each, noise=0.02):
    """Return the time of calls that cost 100 us, and so much a sample."""
    return [Times((1e-4 + each * n) * np.exp(noise * np.roll([1, -1, 2, -2] * 2, k))) for k, n in enumerate(COUNTS)]


@pytest.mark.parametrize("each", [1e-9, 1e-8, 2e-8, 4e-8, 1e-7, 1e-6])
@pytest.mark.parametrize("samples", [5, 50, 900, 2000, 1e6])
def test_times_to_smaller_errors_are_no_less(each, samples):
    """Nor are their low ends: whether a time was read off, told beyond the last count, or only bounded there."""
    variance = samples * 0.01**2
    errors = [Estimate(e, e, e) for e in np.sqrt(variance / COUNTS)]
    law = Estimate(variance, variance, variance)
    found = reaches_of(ErrorOverTime(COUNTS, errors, flat(each), law), 1.0, 0.0)
    for larger, smaller in pairwise(found):
        assert smaller.at_least >= larger.at_least
        if smaller.reached and larger.reached:
            assert smaller.seconds.value >= larger.seconds.value
            assert smaller.seconds.low <= smaller.seconds.value <= smaller.seconds.high


def test_how_many_samples_are_needed_bounds_the_time_that_is_not_told():
    """Samples of 10 ns in calls of 100 us: ten thousand million of them take minutes, however unsure the slope."""
    variance = 1e10 * 0.0001**2
    errors = [Estimate(e, e, e) for e in np.sqrt(variance / COUNTS)]
    law = Estimate(variance, 0.9 * variance, 1.1 * variance)
    found = reaches_of(ErrorOverTime(COUNTS, errors, flat(1e-8), law), 1.0, 0.0)[-1]
    assert found.how == "not-reached"
    assert 0.1 * 1e10 * 1e-8 < found.at_least < 1e10 * 1e-8


def test_no_interval_goes_below_the_time_of_a_call_that_is_not_enough():
    """Four replicates tell an error hardly, and the time to it by decades: but the smallest call was timed."""
    sizes = (0.03, 0.02, 0.008)
    wide = [Estimate(e, e / 5, 5 * e) for e in sizes]
    unsure = reaches_of(ErrorOverTime(COUNTS, wide, flat(1e-6)), 1.0, 0.0)[0]
    sure = Reach(0.01, "measured", "", 10.0, Times(5e-5 * np.exp(0.02 * np.array([2, -1, 1, -2] * 2))))
    assert unsure.how == "measured"
    assert 0.9e-4 < unsure.seconds.low <= unsure.seconds.value
    assert 0.45 < sure.relative_to(unsure).high < 0.6
    assert 1.7 < unsure.relative_to(sure).low < 2.2


def test_what_takes_less_than_the_first_count_may_take_nothing():
    """Whatever the counts say of a call's own cost: below the first it may be another."""
    errors = [Estimate(e, e, e) for e in (1e-3, 1e-4, 1e-5)]
    first = reaches_of(ErrorOverTime(COUNTS, errors, flat(1e-9)), 1.0, 0.0)[0]
    sure = Reach(0.01, "measured", "", 10.0, Times(np.full(8, flat(1e-9)[0].estimate.value)))
    assert first.how == "less-than"
    assert first.seconds.low == first.relative_to(sure).low == 0
    assert sure.relative_to(first).high == np.inf


@pytest.mark.parametrize("needed", [5, 500, 5e4])
def test_a_bias_that_was_not_seen_is_part_of_the_error(needed):
    """Of half the error asked for it takes a third more samples, of all of it the time has no end."""
    law = Estimate(*(needed * 1e-4 * f for f in (1, 0.99, 1.01)))
    errors = [Estimate(e, e, e) for e in np.sqrt(law.value / COUNTS)]

    def seconds(bias, rare=False, times=None):
        times = times or [Times(1e-6 * n * np.array([0.999, 1.001] * 4)) for n in COUNTS]
        found = reach_of(ErrorOverTime(COUNTS, errors, times, law, bias=bias, rare=rare), 0.01, 0.01)
        return found.unless, found.seconds

    (unless, without), (_, half) = seconds(0.0), seconds(0.005)
    assert unless == ""
    assert half.value == without.value
    assert half.high / without.high >= (1.3 if needed > COUNTS[0] else 1.0)
    for bias in (0.01, 0.02):
        unless, there = seconds(bias)
        assert (unless, there.value, there.high) == ("bias", without.value, np.inf)
    unless, there = seconds(0.0, rare=True)
    assert (unless, there.value, there.high) == ("rare", without.value, np.inf)


def test_the_first_count_may_not_be_enough_for_the_largest_variance():
    law = Estimate(*(COUNTS[0] * 1e-4 * f for f in (0.9, 0.5, 1.8)))
    errors = [Estimate(e, e, e) for e in np.sqrt(law.value / COUNTS)]
    found = reach_of(ErrorOverTime(COUNTS, errors, flat(1e-4), law), 0.01, 0.01)
    assert found.how == "less-than"
    assert found.seconds.high > 1.6 * found.seconds.value


def test_a_smaller_error_that_noise_makes_sooner_takes_as_long_as_the_larger():
    late, soon = (Reach(0.01, "measured", "", 10.0, Times(time * np.array([1, 1.1] * 4))) for time in (1.0, 0.9))
    assert soon.after(late).seconds == late.seconds
    assert late.after(soon).seconds == late.seconds


def test_what_no_count_takes_away_is_never_reached():
    assert reach((0.1, 0.05, 0.05), 0.01, stays=0.05).how == "never"


def test_independent_samples_follow_their_law():
    found = reach((0.1, 0.03, 0.01), 0.02, law=Estimate(0.1, 0.09, 0.11))
    assert (found.how, found.samples) == ("measured", pytest.approx(0.1 / 0.02**2, rel=1e-12))
    assert found.seconds.value == pytest.approx(np.sqrt(1.1) * 1e-3 * 250, rel=1e-9)
    assert reach((0.1, 0.03, 0.01), 0.001, law=Estimate(0.1, 0.09, 0.11)).how == "extrapolated"
