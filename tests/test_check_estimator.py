"""`check_estimator` counts the reference's error, is exact for hits and misses, and says when it cannot tell."""

import numpy as np
import pytest

from fogproof import Draws, Reference, check_estimator
from fogproof.checks.means import Moments
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
    ("wrong variance", exponential, ref(1.0), {"variance": 1.2, "samples": 5 * N}, "rejected"),
    ("wrong cost", lambda rng, n: Draws(exponential(rng, n), cost=rng.poisson(3, n)), ref(1.0), {"cost": 3.1}, "rejected"),
    ("rare hits", rare, ref(1e-4), {}, "not rejected"),
    ("rare hits, wrong", rare, ref(1e-3), {}, "rejected"),
    ("channels", lambda rng, n: rng.exponential(size=(n, 3)) * [1, 2, 3], ref([1.0, 2.0, 3.0]), {}, "not rejected"),
    ("one wrong channel", lambda rng, n: rng.exponential(size=(n, 3)) * [1, 2, 3], ref([1.0, 2.0, 3.1]), {}, "rejected"),
    ("no variance", lambda rng, n: np.full(n, 0.25), ref(0.25), {"variance": 0.0}, "not rejected"),
    ("no variance, wrong", lambda rng, n: np.full(n, 0.25001), ref(0.25), {"variance": 0.0}, "rejected"),
    ("constant, unexplained", lambda rng, n: np.full(n, 0.3), ref(0.25), {}, "inconclusive"),
    ("infinite variance", lambda rng, n: rng.lognormal(0, 4, n), ref(np.exp(8)), {}, "inconclusive"),
    ("NaN", lambda rng, n: np.where(rng.random(n) < 1e-3, np.nan, 1.0), ref(1.0), {}, "rejected"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "draw", "reference", "options", "outcome"), CASES, ids=[c[0] for c in CASES])
def test_outcome(name, draw, reference, options, outcome):
    verdict = check_estimator(draw, reference, alpha=1e-9, **{"samples": N, **options})
    assert verdict.outcome == outcome, str(verdict)


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
