"""`check_estimator` counts the reference's error, is exact for hits and misses, sees dependence, and says when it cannot tell."""

from types import SimpleNamespace

import numpy as np
import pytest

from fogproof import Draws, Reference, check_estimator
from fogproof.checks import compare_estimators
from fogproof.checks.statistics.moments import Moments
from fogproof.errors import InvalidValueError, SubjectError

N = 200_000


def ref(value, error=0.0):
    return Reference(np.asarray(value), np.asarray(error), "test", "test")


def exponential(rng, n):
    return rng.exponential(size=n)


def rare(rng, n):
    return (rng.random(n) < 1e-4).astype(float)


CASES = [
    ("right mean", exponential, ref(1.0), {}, "not rejected"),
    ("wrong mean", exponential, ref(1.03), {}, "rejected"),
    ("wrong mean within the reference's error", exponential, ref(1.03, 0.05), {}, "not rejected"),
    ("right variance and cost", lambda rng, n: Draws(exponential(rng, n), cost=rng.poisson(3, n)), ref(1.0),
     {"variance": 1.0, "cost": 3.0, "samples": 5 * N}, "not rejected"),
    ("wrong variance", exponential, ref(1.0), {"variance": 0.8, "samples": 5 * N}, "rejected"),
    ("variance too small, but rare values", exponential, ref(1.0), {"variance": 1.2, "samples": 5 * N}, "inconclusive"),
    ("variance too small, light tails", exponential, ref(1.0), {"variance": 1.2, "samples": 5 * N, "tails": "light"}, "rejected"),
    ("wrong cost", lambda rng, n: Draws(exponential(rng, n), cost=rng.poisson(3, n)), ref(1.0), {"cost": 3.1}, "rejected"),
    ("rare hits", rare, ref(1e-4), {}, "not rejected"),
    ("rare hits, wrong", rare, ref(1e-3), {}, "rejected"),
    ("channels", lambda rng, n: rng.exponential(size=(n, 3)) * [1, 2, 3], ref([1.0, 2.0, 3.0]), {}, "not rejected"),
    ("one wrong channel", lambda rng, n: rng.exponential(size=(n, 3)) * [1, 2, 3], ref([1.0, 2.0, 3.1]), {}, "rejected"),
    ("no variance", lambda rng, n: np.full(n, 0.25), ref(0.25), {"variance": 0.0}, "not rejected"),
    ("no variance, wrong", lambda rng, n: np.full(n, 0.25001), ref(0.25), {"variance": 0.0}, "rejected"),
    ("constant, unexplained", lambda rng, n: np.full(n, 0.2), ref(0.25), {}, "inconclusive"),
    ("constant, too large for radiance", lambda rng, n: np.full(n, 0.3), ref(0.25), {}, "rejected"),
    ("too skewed", lambda rng, n: rng.lognormal(0, 4, n), ref(np.exp(8)), {}, "inconclusive"),
    ("infinite variance", lambda rng, n: rng.pareto(1.2, n), ref(5.0), {}, "inconclusive"),
    ("NaN", lambda rng, n: np.where(rng.random(n) < 1e-3, np.nan, 1.0), ref(1.0), {}, "rejected"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "draw", "reference", "options", "outcome"), CASES, ids=[c[0] for c in CASES])
def test_outcome(name, draw, reference, options, outcome):
    verdict = check_estimator(draw, reference, alpha=1e-9, **{"samples": N, **options})
    assert verdict.outcome == outcome, str(verdict)


def skewed(rng, n):
    """Mean 1 from a hit in 10^4, smeared so that there are more than two values."""
    return (rng.random(n) < 1e-4) * 1e4 * rng.uniform(0.9, 1.1, n)


SKEWED_VARIANCE = 1e4 * (1 + 0.2**2 / 12) - 1

DISTRIBUTION_FREE = [
    ("exact variance", skewed, ref(1.0), {"variance": SKEWED_VARIANCE}, "not rejected", "Catoni"),
    ("exact variance, wrong mean", skewed, ref(9.0), {"variance": SKEWED_VARIANCE}, "rejected", "betting"),
    ("far too large", lambda rng, n: 1000 * skewed(rng, n), ref(1.0), {"nonnegative": True}, "rejected", "betting"),
    ("far too small", lambda rng, n: 0.1 * skewed(rng, n), ref(1.0), {}, "inconclusive", "too skewed"),
]


@pytest.mark.parametrize(
    ("name", "draw", "reference", "options", "outcome", "words"),
    DISTRIBUTION_FREE,
    ids=[c[0] for c in DISTRIBUTION_FREE],
)
def test_where_no_normal_law_holds_another_test_does_or_none(name, draw, reference, options, outcome, words):
    verdict = check_estimator(draw, reference, alpha=1e-9, samples=N, **options)
    mean = next(f for f in verdict.findings if f.check == "mean")
    assert mean.outcome == outcome, str(verdict)
    assert words in mean.message


def test_an_infinite_variance_is_named_and_a_finite_one_is_not():
    def message(draw, reference):
        return next(f.message for f in check_estimator(draw, reference, samples=N).findings if f.check == "mean")

    assert "infinite variance suspected" in message(lambda rng, n: rng.pareto(1.1, n), ref(10.0))
    for draw, mean in ((exponential, 1.0), (lambda rng, n: rng.lognormal(0, 1, n), np.exp(0.5)), (rare, 1e-4)):
        assert "infinite variance" not in message(draw, ref(mean))


def by_order(rng, n):
    order = rng.integers(1, 4, n)
    return Draws(rng.exponential(size=n) * order, order=order)


def test_contributions_by_order():
    right = {1: ref(1 / 3), 2: ref(2 / 3), 3: ref(1.0)}
    assert check_estimator(by_order, right, samples=N).outcome == "not rejected"
    verdict = check_estimator(by_order, {**right, 2: ref(0.7)}, samples=5 * N)
    assert [f.check for f in verdict.findings if f.outcome == "rejected"] == ["mean of order 2"]
    with pytest.raises(SubjectError, match="order"):
        check_estimator(exponential, right, samples=1000)


def with_errors(scale):
    def draw(rng, n):
        x = rng.normal(size=(n, 30)) + 2
        return Draws(x.mean(axis=1), stderr=scale * x.std(axis=1, ddof=1) / np.sqrt(30))

    return draw


ERRORS = [(1.0, set()), (0.7, {"square", "coverage"}), (0.97, {"square"}), (1.5, {"square"})]


@pytest.mark.parametrize(("scale", "rejecting"), ERRORS)
def test_reported_standard_errors_must_be_right_and_cover(scale, rejecting):
    verdict = check_estimator(with_errors(scale), ref(2.0), samples=N)
    found = {f.check.split()[0] for f in verdict.findings if f.outcome == "rejected"}
    assert found == rejecting, str(verdict)
    assert verdict.cause == ("wrong standard errors" if rejecting else "")


def ar1(rng, n):
    x = rng.normal(size=n)
    for i in range(1, n):
        x[i] = 0.1 * x[i - 1] + np.sqrt(0.99) * x[i]
    return x


def per_thread(rng, n):
    """Four threads with the same seed."""
    quarter = rng.exponential(size=-(-n // 4))
    return np.tile(quarter, 4)[:n]


CORRELATED = [
    ("successive ones", ar1, 0.0, "correlation of realisations"),
    (
        "the same seed in every call",
        lambda rng, n: np.random.default_rng(1).normal(size=n),
        0.0,
        "repeated realisations",
    ),
    ("the same seed in every thread", per_thread, 1.0, "repeated realisations"),
    ("sorted", lambda rng, n: np.sort(rng.normal(size=n)), 0.0, "correlation of realisations"),
]


@pytest.mark.parametrize(("name", "draw", "mean", "check"), CORRELATED, ids=[c[0] for c in CORRELATED])
def test_realisations_that_are_not_independent_are_found(name, draw, mean, check):
    verdict = check_estimator(draw, ref(mean), samples=N)
    assert check in [f.check for f in verdict.findings if f.outcome == "rejected"], str(verdict)


def test_hits_and_misses_may_repeat_as_they_like():
    for p in (1e-4, 0.5):
        verdict = check_estimator(lambda rng, n, p=p: (rng.random(n) < p) * 2.0, ref(2 * p), samples=N)
        assert verdict.outcome == "not rejected", str(verdict)


def test_gross_errors_stop_early():
    assert check_estimator(exponential, ref(2.0), samples=5_000_000).samples < 500_000
    assert check_estimator(exponential, ref(1.0), samples=1_000_000).samples == 1_000_000


COMPARED = [
    ("equal", exponential, lambda rng, n: rng.uniform(0, 2, n), "not rejected"),
    ("unequal", exponential, lambda rng, n: 1.03 * rng.uniform(0, 2, n), "rejected"),
    ("equal hits", rare, rare, "not rejected"),
    ("unequal hits", rare, lambda rng, n: (rng.random(n) < 1e-3) * 1.0, "rejected"),
    ("no variance", lambda rng, n: np.ones(n), lambda rng, n: np.ones(n), "not rejected"),
    ("too skewed", lambda rng, n: rng.lognormal(0, 4, n), exponential, "inconclusive"),
]


@pytest.mark.parametrize(("name", "first", "second", "outcome"), COMPARED, ids=[c[0] for c in COMPARED])
def test_two_estimators_against_each_other(name, first, second, outcome):
    verdict = compare_estimators(first, second, samples=N, alpha=1e-9)
    assert verdict.outcome == outcome, str(verdict)


def test_comparison_of_channels_names_the_one_that_differs():
    def draw(last):
        return lambda rng, n: rng.exponential(size=(n, 3)) * [1, 2, last]

    verdict = compare_estimators(draw(3.0), draw(3.1), samples=N)
    assert [f.check for f in verdict.findings if f.outcome == "rejected"] == ["difference in channel 2"]
    with pytest.raises(SubjectError, match="channels"):
        compare_estimators(draw(3.0), exponential, samples=1000)


def test_a_z_test_would_raise_false_alarms_where_the_binomial_does_not():
    p_values = []
    for seed in range(300):
        verdict = check_estimator(rare, ref(1e-4), samples=20_000, seed=seed)
        p_values += [f.p_value for f in verdict.findings if f.p_value is not None]
    assert min(p_values) > 1e-6 / 300


def test_moments_merge_to_those_of_the_whole():
    rng = np.random.default_rng(7)
    x = rng.gamma(0.7, size=10_000)
    merged = Moments()
    for part in np.array_split(x, [100, 5000, 5001]):
        merged = merged.merged(Moments.of(part))
    whole = Moments.of(x)
    for name in ("n", "mean", "m2", "m3", "m4", "low", "high"):
        assert getattr(merged, name) == pytest.approx(getattr(whole, name), rel=1e-12)


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda rng, n: np.zeros(n - 1), r"shape \(\d+,\), got"),
        (lambda rng, n: np.zeros((n, 2)), r"shape \(\d+,\), got"),
        (lambda rng, n: ["x"] * n, "must return numbers"),
        (lambda rng, n: 1 / 0, "raised ZeroDivisionError"),
    ],
)
def test_an_estimator_that_breaks_its_contract_is_told_how(draw, message):
    with pytest.raises(SubjectError, match=message):
        check_estimator(draw, ref(1.0))


def test_bad_arguments_are_explained():
    with pytest.raises(InvalidValueError, match="alpha must lie in"):
        check_estimator(exponential, ref(1.0), alpha=2)
    with pytest.raises(SubjectError, match="cost"):
        check_estimator(exponential, ref(1.0), cost=1.0, samples=1000)


@pytest.mark.parametrize("given", [lambda ref: ref, lambda ref: {0: ref}, lambda ref: Reference(ref)])
def test_what_draw_writes_into_the_reference_changes_nothing(given):
    """A renderer may hand out a view of the buffer that it writes into."""
    mine = np.array([0.5])

    def draw(rng, n):
        mine[0] = 0.6
        return Draws(rng.random((n, 1)) + 0.1, order=np.zeros(n))

    assert check_estimator(draw, given(mine), samples=10_000).outcome == "rejected"


def test_an_object_that_draws_is_told_from_realisations():
    with pytest.raises(SubjectError, match=r"an object of SimpleNamespace; pass its method: x\.draw"):
        check_estimator(SimpleNamespace(draw=lambda rng, n: rng.random(n)), 0.5)
