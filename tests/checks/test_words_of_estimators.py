"""What a verdict about an estimator says is true: how small a bias it excludes, what would explain one, what may be declared."""

import inspect
import itertools
import re
from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from fogproof import (
    Draws,
    InvalidValueError,
    Reference,
    check_bound,
    check_convergence,
    check_estimator,
    check_gradient,
    check_mis,
    compare_estimators,
)
from fogproof.checks.names import in_ranges
from fogproof.checks.statistics.interval import effect_interval
from fogproof.checks.statistics.known import NOTHING, Known
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.domains import Interval
from fogproof.errors import SubjectError


def uniform(rng, n):
    return rng.random(n)


def lattice(rng, n):
    """A rule that is exact for the function: what varies is rounding."""
    x = (np.arange(32) / 32 + rng.random((n, 1))) % 1
    return np.exp(np.cos(2 * np.pi * x)).mean(axis=1)


def zeros(rng, n):
    return np.zeros(n)


def heavy(rng, n):
    return rng.pareto(1.1, n)


BESSEL = float(mpmath.besseli(0, 1))


def test_a_resolution_is_never_finer_than_the_rounding_that_is_allowed_for():
    verdict = check_estimator(lattice, BESSEL, samples=20_000)
    assert verdict.outcome == "not rejected"
    off = 1.2 * verdict.resolution.value  # one unit in the last place is a tenth of that, and all the noise there is
    for side in (-off, off):
        shifted = check_estimator(lambda rng, n, s=side: lattice(rng, n) + s, BESSEL, samples=20_000)
        assert shifted.outcome == "rejected", str(shifted)


FOUND = {
    "estimator, constant": (check_estimator, lambda: check_estimator(zeros, 0.3, samples=1000)),
    "estimator, heavy": (check_estimator, lambda: check_estimator(heavy, 10.0, samples=2000)),
    "estimator, few": (check_estimator, lambda: check_estimator(np.arange(30.0), 14.0)),
    "estimator, by order": (
        check_estimator,
        lambda: check_estimator(lambda rng, n: Draws(heavy(rng, n), order=np.ones(n)), {1: 10.0}, samples=2000),
    ),
    "estimator, stratified": (
        check_estimator,
        lambda: check_estimator(lambda rng, n: (np.arange(n) + rng.random(n)) / n, 0.5, samples=60_000),
    ),
    "estimator, standard errors": (
        check_estimator,
        lambda: check_estimator(lambda rng, n: Draws(heavy(rng, n), stderr=heavy(rng, n)), 10.0, samples=2000),
    ),
    "gradient": (check_gradient, lambda: check_gradient(heavy, 10.0, samples=2000)),
    "two, constant": (
        compare_estimators,
        lambda: compare_estimators(zeros, lambda rng, n: np.full(n, 0.1), samples=1000),
    ),
    "two, one constant": (compare_estimators, lambda: compare_estimators(zeros, uniform, samples=1000)),
    "two, heavy": (compare_estimators, lambda: compare_estimators(heavy, heavy, samples=2000)),
    "convergence": (
        check_convergence,
        lambda: check_convergence(lambda rng, n: rng.random() if n < 100 else 1 / n, [10, 100, 1000]),
    ),
}


@pytest.mark.parametrize("name", FOUND)
def test_what_may_be_declared_is_an_argument_of_the_check_that_says_so(name):
    check, judge = FOUND[name]
    taken = set(inspect.signature(check_estimator if check is check_gradient else check).parameters)
    verdict = judge()
    assert verdict.outcome != "not rejected", str(verdict)
    said = "\n".join(finding.message for finding in verdict.findings)
    named = re.findall(r"\b([a-z_]+)=", said)
    if check is not check_convergence and name not in ("estimator, stratified", "estimator, standard errors"):
        assert named, said
    assert set(named) <= taken, said
    if check is compare_estimators:
        assert "variance=0" not in said  # a pair is wanted
        assert "variance=(first, second)" in said
    if "by order" in name:
        assert "variance" not in named  # which is refused there


def test_an_unseen_event_is_not_thought_of_where_bounds_exclude_it():
    def work(rng, n):
        return Draws(rng.random(n), cost=np.full(n, 16.0))

    costly = check_estimator(work, 0.5, cost=15.0, samples=2000)
    assert costly.cause == "wrong cost"
    assert "an event unseen" not in str(costly)
    large = check_estimator(lambda rng, n: 1 + uniform(rng, n), 0.5, nonnegative=True, samples=2000)
    assert large.outcome == "rejected"
    assert "an event unseen" not in str(large)
    small = check_estimator(lambda rng, n: 0.1 * uniform(rng, n), 0.5, nonnegative=True, samples=2000)
    assert "an event unseen" in str(small)


def test_what_unseen_events_may_bring_within_declared_bounds_is_allowed_for():
    """One realisation in 200 is ten times as bright as the rest: every third set of 200 has none such, and is right."""
    met = 0
    for seed in range(30):
        rng = np.random.default_rng([seed, 14])
        bright = rng.random(200) < 1 / 200
        met += bright.any()
        verdict = check_estimator(
            np.where(bright, 11.0, 1 + 0.1 * rng.normal(size=200)), 1.05, bounds=(0, 20), seed=seed
        )
        assert verdict.outcome != "rejected", str(verdict)
        assert verdict.resolution.value > 0.5  # what an unseen event may bring is in it
        hits = np.where(rng.random(200) < 0.5, 1.0, 2.0)
        assert check_estimator(hits, 1.9, bounds=(0, 20), seed=seed).outcome != "rejected"
        assert check_estimator(hits, 1.9, bounds=(1, 2), seed=seed).outcome == "rejected"  # here there are none
    assert met < 30
    loose = check_estimator(uniform, 0.6, bounds=(0, 10), samples=100_000)
    assert loose.outcome == "rejected", str(loose)
    assert loose.resolution.value < 0.04
    tight = check_estimator(uniform, 0.5, bounds=(0, 1), samples=100_000)
    plain = check_estimator(uniform, 0.5, samples=100_000)
    assert tight.resolution.value < 1.05 * plain.resolution.value


def test_intervals_are_as_wide_as_the_law_of_what_was_seen_asks():
    few = effect_interval(Moments.of(np.random.default_rng(1).normal(size=8)), 0.0, NOTHING, False)
    scale = few.high - few.low
    error = Moments.of(np.random.default_rng(1).normal(size=8)).stderr
    assert scale == pytest.approx(2 * 3.4995 * error, rel=1e-4)  # Student's with 7 degrees of freedom, not 2.576
    hits = Moments.of((np.arange(20_000) < 8).astype(float))
    exact = mean_test("", "", hits, 1e-4, 0.0, 0.05)  # 8 where 2 are expected
    assert exact.outcome == "rejected"
    assert exact.interval.low > 0  # the normal law's holds 0
    black = Moments.of(np.zeros(1000))
    within = effect_interval(black, 0.0, Known(low=0.0, high=1.0), False)
    assert within.low == 0
    assert (1 - within.high) ** 1000 == pytest.approx(0.01)  # were it more, one of them would not be black
    assert effect_interval(black, 0.0, NOTHING, False) is None


def test_a_mean_beyond_both_values_has_no_planned_resolution():
    finding = mean_test("", "", Moments.of((np.arange(1000) % 2).astype(float)), -0.4, 0.0, 1e-6)
    assert finding.outcome == "rejected"
    assert finding.resolution is None


def test_where_the_variance_may_be_infinite_no_resolution_is_stated():
    heavier = np.random.default_rng(3).pareto(0.8, 20_000)
    verdict = check_estimator(heavier, float(heavier.mean()) * 1.01, tails="light")
    assert "infinite variance suspected" in str(verdict)
    assert verdict.resolution is None


def test_a_stream_that_starts_again_is_named_so():
    verdict = check_estimator(lambda rng, n: np.random.default_rng(3).random(n), 0.5, samples=100_000)
    assert verdict.cause == "repeated samples", str(verdict)


def test_many_channels_are_told_in_ranges_and_by_the_coarsest():
    scale = np.linspace(1, 5, 30)
    verdict = check_estimator(lambda rng, n: rng.random((n, 30)) * scale, scale / 2, samples=5000)
    assert verdict.resolution.kind == "bias of mean of channel 29"
    assert "mean of channel 0 to 29" in str(verdict)
    assert "mean of channel 12" not in str(verdict)
    names = ["a", "mean of channel 0", "mean of channel 1", "mean of channel 3", "b 1", "b 2", "b 3"]
    assert in_ranges(names) == names
    assert in_ranges([f"mean of order {k}" for k in (1, 2, 3, 7)]) == ["mean of order 1 to 3", "mean of order 7"]


def test_of_two_estimators_the_difference_is_told():
    one = compare_estimators(uniform, uniform, samples=5000)
    assert one.resolution.kind == "difference of means"
    scale = np.array([1.0, 3.0])
    two = compare_estimators(*2 * [lambda rng, n: rng.random((n, 2)) * scale], samples=5000)
    assert two.resolution.kind == "difference of means in channel 1"


def test_orders_without_a_reference_are_told_as_unchecked():
    def draw(rng, n):
        return Draws(rng.random(n), order=np.arange(n) % 2)

    verdict = check_estimator(draw, {0: 0.25}, samples=5000)
    assert any("order without a reference" in line for line in verdict.unchecked)
    assert "unchecked: " in str(verdict)


def test_a_verdict_may_be_kept_in_a_set():
    verdict = check_estimator(uniform, 0.5, samples=2000)
    assert verdict in {verdict}


@pytest.mark.parametrize("half", [Fraction(1, 2), Decimal("0.5"), mpmath.mpf("0.5"), np.longdouble(0.5)])
def test_numbers_of_any_kind_are_references(half):
    assert float(Reference.of("reference", half)) == 0.5
    assert check_estimator(uniform, half, samples=2000).outcome == "not rejected"
    assert Reference([half, 2 * half]).value.tolist() == [0.5, 1.0]


@pytest.mark.parametrize("nonsense", [None, "0.5", True, [Fraction(1, 2), "0.5"], object()])
def test_what_is_no_number_is_no_reference(nonsense):
    with pytest.raises(InvalidValueError, match="must be a number or an array of numbers"):
        check_estimator(uniform, nonsense, samples=2000)


def test_complex_numbers_and_values_with_errors_are_told_what_to_write():
    with pytest.raises(InvalidValueError, match="real and imaginary parts as two channels"):
        check_estimator(uniform, 0.5 + 0.5j, samples=2000)
    with pytest.raises(SubjectError, match="real and imaginary parts as two channels"):
        check_estimator(lambda rng, n: 1j * uniform(rng, n), 0.5, samples=2000)
    with pytest.raises(SubjectError, match=r"a value with its error is Reference\(value, error\)"):
        check_estimator(uniform, (0.5, 1e-9), samples=2000)  # as scipy.integrate.quad returns it
    line = (lambda u: u[:, 0], lambda x: np.ones(len(x)), 1)
    with pytest.raises(InvalidValueError, match="exponent must be > 0 and finite, got inf; None asks"):
        check_mis([line, line], lambda x: np.full((len(x), 2), 0.5), exponent=np.inf)


def test_a_bound_of_nothing_is_attained_and_a_small_excess_is_told():
    empty = check_bound(lambda x: 0 * x, 0.0, Interval(0.0, 1.0))
    assert empty.outcome == "not rejected", str(empty)
    assert "f and its bound are 0" in empty.findings[1].message
    somewhere = check_bound(lambda x: 0 * x, lambda x: np.where(x > 0.5, 1.0, 0.0), Interval(0.0, 1.0))
    assert somewhere.outcome == "inconclusive"  # 0 of 1 is loose, whatever is elsewhere
    over = check_bound(lambda x: 1 + np.sin(17 * x), 2 - 1e-8, Interval(0.0, 1.0))
    assert over.outcome == "rejected"
    assert re.search(r"above its bound, by [1-5](\.\d)?e-09 of that", over.findings[0].message)


def test_a_program_that_disregards_its_number_of_samples_is_no_pass():
    scatter = itertools.cycle(np.linspace(0.4, 0.6, 32))  # as much at every count
    verdict = check_convergence(lambda rng, n: next(scatter), [100, 4000], reference=0.5)
    assert verdict.outcome == "inconclusive", str(verdict)
    assert "a number of samples that is disregarded" in str(verdict)
