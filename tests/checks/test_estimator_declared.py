"""What is declared decides whatever the law; what is not declared is never relied on, and every scale is as good as another."""

import re
import sys

import numpy as np
import pytest

from fogproof import Draws, Reference, check_estimator, compare_estimators, samples_for
from fogproof.errors import InvalidValueError, SubjectError


def constant(value):
    return lambda rng, n: np.full(n, value)


def far(rng, n):
    return 1000 + rng.normal(size=n)


def skewed(rng, n):
    """Nothing that Student's law may judge from a hundred values."""
    return 1000 + rng.exponential(size=n)


DECIDED = [
    ("black pixel", constant(0.0), 0.3, {}, "inconclusive", "bounds="),
    ("black pixel, its variance", constant(0.0), 0.3, {"variance": 0.1}, "rejected", "variance 0.1"),
    ("black pixel, its bounds", constant(0.0), 0.3, {"bounds": (0, 1)}, "rejected", "bounds (0, 1)"),
    ("black pixel, a few of it", constant(0.0), 0.3, {"bounds": (0, 1), "samples": 20}, "inconclusive", "ask for more"),
    ("black pixel, rare light", constant(0.0), 1e-6, {"bounds": (0, 1)}, "not rejected", "chance"),
    ("too bright", constant(0.6), 0.3, {"nonnegative": True}, "rejected", "bounds (0, inf)"),
    ("too bright, undeclared", constant(0.6), 0.3, {}, "rejected", "no value is negative"),
    ("too bright, too few", constant(0.6), 0.3, {"samples": 15}, "inconclusive", "bounds="),
    ("too dark, not negative", constant(0.2), 0.3, {"nonnegative": True}, "inconclusive", "bounds="),
    ("far off, a hundred", skewed, 0.0, {"samples": 100, "bounds": (-2e3, 2e3)}, "rejected", "whatever the law"),
    ("far off, bounds too wide to tell", far, 0.0, {"samples": 100, "bounds": (-1e4, 1e4)}, "inconclusive", "ask for more"),
    ("far off, thirty, light tails", far, 0.0, {"samples": 30, "tails": "light"}, "rejected", "light"),
    ("right, thirty, light tails", far, 1000.0, {"samples": 30, "tails": "light"}, "not rejected", "light"),
    ("far off, thirty, signed", lambda rng, n: far(rng, n) * -1, 0.0, {"samples": 30}, "inconclusive", "unseen in 30"),
    ("outside its bounds", lambda rng, n: rng.normal(0.5, 0.2, n), 0.5, {"bounds": (0, 1)}, "rejected", ""),
    ("tolerance", constant(0.3003), 0.3, {"tolerance": 2e-3, "variance": 0}, "not rejected", "+- 0.0006"),
    ("less tolerance", constant(0.3003), 0.3, {"tolerance": (1e-4, 1e-4), "variance": 0}, "rejected", ""),
    ("float32", lambda rng, n: np.full(n, 0.1, np.float32), 0.1, {"precision": "float32", "variance": 0}, "not rejected", ""),
    ("known too coarsely", constant(0.0), Reference(1e-33, 3e-33), {}, "inconclusive", "coarsely"),
    ("noise about nothing", lambda rng, n: rng.normal(size=n), Reference(0.0, 1e-16), {}, "not rejected", ""),
    ("constant cost", lambda rng, n: Draws(rng.random(n), np.full(n, 48.0)), 0.5, {"cost": 12.0}, "rejected", ""),
    ("constant cost, too small", lambda rng, n: Draws(rng.random(n), np.full(n, 6.0)), 0.5, {"cost": 12.0}, "rejected", ""),
    ("two, light tails", lambda rng, n: rng.normal(1, 0.01, n), 2.0, {"samples": 2, "tails": "light"}, "inconclusive", "too few"),
    ("ten, light tails", lambda rng, n: rng.normal(1, 0.1, n), 1.0, {"samples": 10, "tails": "light"}, "not rejected", "light"),
    ("variance too small, bounds", lambda rng, n: rng.random(n), 0.5, {"variance": 0.1, "bounds": (0, 1)}, "rejected", ""),
    ("variance too small, no bounds", lambda rng, n: rng.random(n), 0.5, {"variance": 0.1}, "inconclusive", "bounds="),
    ("largest variance", lambda rng, n: rng.random(n) < 0.3, 0.3, {"variance": 0.21, "bounds": (0, 1)}, "not rejected", ""),
    ("rounding is no scatter", lambda rng, n: 0.1 + rng.choice([0, 1e-17, 3e-17], n), 0.1, {}, "not rejected", ""),
]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "draw", "reference", "options", "outcome", "words"), DECIDED, ids=[c[0] for c in DECIDED]
)
def test_what_is_declared_decides(name, draw, reference, options, outcome, words):
    verdict = check_estimator(draw, reference, **{"samples": 50_000, **options})
    assert verdict.outcome == outcome, str(verdict)
    assert words in " ".join(f.message for f in verdict.findings)


@pytest.mark.parametrize("scale", [1e-300, 1e-131, 1e-20, 1e150, 1e300])
def test_every_scale_is_judged_alike(scale):
    def draw(rng, n):
        return scale * rng.exponential(size=n)

    def reported(rng, n):
        x = scale * rng.normal(3, 1, size=(n, 20))
        return Draws(x.mean(axis=1), stderr=(x / scale).std(axis=1, ddof=1) * (scale / np.sqrt(20)))

    with np.errstate(over="raise"):
        assert check_estimator(draw, scale, samples=50_000).outcome == "not rejected"
    wrong = check_estimator(draw, 1.1 * scale, samples=50_000)
    assert wrong.outcome == "rejected", str(wrong)
    assert check_estimator(reported, 3 * scale, samples=20_000).outcome == "not rejected"
    assert compare_estimators(draw, draw, samples=50_000).outcome == "not rejected"
    assert compare_estimators(draw, lambda rng, n: 1.1 * draw(rng, n), samples=50_000).outcome == "rejected"


def test_rare_bright_values_are_no_error_where_their_variance_is_declared():
    def draw(rng, n):
        return rng.normal(1, 0.1, n) + (rng.random(n) < 1e-5) * 1e3

    for _ in range(8):
        verdict = check_estimator(draw, 1.01, variance=0.01 + 1e-5 * (1 - 1e-5) * 1e6, samples=100_000)
        assert verdict.outcome != "rejected", str(verdict)
        assert verdict.samples == 100_000


def test_a_finite_set_is_judged_as_it_is_and_nothing_is_drawn_twice():
    pixels = np.random.default_rng().exponential(size=(70_000, 3)) * [1, 2, 3]
    verdict = check_estimator(pixels, [1, 2, 3])
    assert verdict.outcome == "not rejected", str(verdict)
    assert verdict.samples == 70_000
    assert check_estimator(Draws(pixels[:, 0], cost=np.full(70_000, 2.0)), 1.0, cost=2.0).outcome == "not rejected"
    assert check_estimator(pixels[:, 0], 1.1).outcome == "rejected"
    with pytest.raises(SubjectError, match=r"reshape\(-1, 3\)"):
        check_estimator(np.zeros((4, 4, 3)), [1, 2, 3])


@pytest.mark.parametrize(("samples", "most"), [(30, 1), (900, 1), (5000, 2), (65536, 8), (1_000_000, 28)])
def test_a_renderer_is_not_asked_often(samples, most):
    asked = []

    def draw(rng, n):
        asked.append(n)
        return rng.lognormal(0, 2, n)

    check_estimator(draw, np.exp(2), samples=samples)
    assert len(asked) <= most
    assert sum(asked) == samples


def test_a_resolution_ends_the_check():
    quick = check_estimator(lambda rng, n: rng.normal(2, 1, n), 2.0, resolution=0.1)
    assert quick.outcome == "not rejected", str(quick)
    assert quick.samples < 20_000
    assert quick.resolution.value <= 0.1
    assert check_estimator(lambda rng, n: rng.normal(2.1, 1, n), 2.0, resolution=0.1).outcome == "rejected"
    coarse = check_estimator(lambda rng, n: rng.normal(2, 1, n), 2.0, resolution=1e-3, samples=10_000)
    assert coarse.outcome == "inconclusive"
    assert "ask for about" in str(coarse)


def test_orders_without_a_reference_are_counted():
    def draw(rng, n):
        return Draws(rng.exponential(size=n), order=rng.integers(0, 4, n))

    verdict = check_estimator(draw, {0: 0.25, 1: 0.25}, samples=20_000)
    other = next(f for f in verdict.findings if f.check == "other orders")
    assert "(2, 3)" in other.message
    assert other.effect == pytest.approx(0.5, abs=0.05)


def test_the_plan_is_kept():
    n = samples_for(bias=0.02, variance=0.25)
    outcomes = [check_estimator(lambda rng, m: rng.normal(0.52, 0.5, m), 0.5, samples=n).outcome for _ in range(60)]
    assert outcomes.count("rejected") >= 54  # fewer with probability 3e-6
    n = samples_for(bias=0.02, probability=0.1)
    outcomes = [check_estimator(lambda rng, m: (rng.random(m) < 0.08) * 1.0, 0.1, samples=n).outcome for _ in range(60)]
    assert outcomes.count("rejected") >= 54
    assert samples_for(bias=0.02, variance=0.25) < samples_for(bias=0.02, variance=0.25, false_fail=1e-9)
    assert samples_for(bias=0.02, bounds=(0, 1)) > samples_for(bias=0.02, variance=0.25)
    with pytest.raises(InvalidValueError, match="one of them"):
        samples_for(bias=0.02)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"bounds": (1, 0)}, "low < high"),
        ({"bounds": (0, 0.4)}, "within the declared bounds"),
        ({"tails": "thin"}, "light"),
        ({"tolerance": -1}, "tolerance"),
        ({"precision": "half"}, "float32"),
        ({"samples": 1.5}, "whole number"),
        ({"samples": 1}, ">= 2"),
        ({"seed": -1}, "seed"),
        ({"alpha": 1e-320}, "alpha"),
        ({"resolution": 0}, "resolution"),
        ({"variance": 0.5, "bounds": (0, 1)}, "Bhatia"),
    ],
)
def test_wrong_arguments_are_explained(options, words):
    with pytest.raises(InvalidValueError, match=words):
        check_estimator(lambda rng, n: rng.random(n), 0.5, **options)


class Foreign:
    def __init__(self, x):
        self.x = x

    def __dlpack__(self, **options):
        return self.x.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.x.__dlpack_device__()


def test_arrays_of_others_are_read_or_refused_with_the_fix():
    def refused(draw, words, reference=0.5):
        with pytest.raises(SubjectError, match=words):
            check_estimator(draw, reference, samples=1e3)

    assert check_estimator(lambda rng, n: Foreign(rng.random(n)), 0.5, samples=1e4).outcome == "not rejected"
    assert check_estimator(lambda rng, n: rng.random((n, 1)), 0.5, samples=1e4).outcome == "not rejected"
    refused(lambda rng, n: rng.random(n).astype(np.float32), 'precision="float32"')
    refused(lambda rng, n: np.ma.masked_less(rng.random(n), 0.5), "masked")
    refused(lambda rng, n: rng.random((3, n)), "transpose", [0.5, 0.5, 0.5])
    refused(lambda rng, n: rng.random((n, 3)), "one value a channel")


def test_orders_are_whole_numbers():
    with pytest.raises(InvalidValueError, match="labels"):
        check_estimator(lambda rng, n: Draws(rng.random(n), order=np.ones(n)), {"first": 0.5})
    with pytest.raises(SubjectError, match="whole"):
        check_estimator(lambda rng, n: Draws(rng.random(n), order=np.full(n, 1.5)), {1: 0.5})


def test_half_precision_is_refused_with_the_fix():
    for precision in ("float64", "float32"):
        with pytest.raises(SubjectError, match="half precision"):
            check_estimator(np.full(100, 0.3, np.float16), 0.3, precision=precision)


@pytest.mark.parametrize(
    "options",
    [
        {"bias": 0.1, "bounds": (1, 0)},
        {"bias": 2, "bounds": (0, 1)},
        {"bias": 0.1, "bounds": (0, np.nan)},
        {"bias": 0.7, "probability": 0.5},
    ],
)
def test_no_plan_for_what_cannot_be(options):
    with pytest.raises(InvalidValueError):
        samples_for(**options)


def uniform(rng, n):
    return rng.random(n)


def averaged(factor, size=10):
    """Averages of so many numbers, and their standard errors times a factor."""

    def draw(rng, n):
        x = rng.random((n, size))
        return Draws(x.mean(axis=1), stderr=factor * x.std(axis=1, ddof=1) / np.sqrt(size))

    return draw


COMPARED = [
    ("two constants", constant(1.0), constant(0.0), {}, "inconclusive"),
    ("two constants, the other way", constant(0.0), constant(1.0), {}, "inconclusive"),
    ("two constants, bounds", constant(1.0), constant(0.0), {"bounds": (0, 1)}, "rejected"),
    ("two constants, no variance", constant(1.0), constant(0.0), {"variance": (0, 0)}, "rejected"),
    ("one constant", constant(1.0), constant(1.0), {}, "not rejected"),
    ("hits", lambda rng, n: rng.random(n) < 0.1, lambda rng, n: rng.random(n) < 0.12, {}, "rejected"),
    ("right standard errors", averaged(1), averaged(1), {}, "not rejected"),
    ("right standard errors of one", uniform, averaged(1), {}, "not rejected"),
    ("standard errors too large", uniform, averaged(1.2), {}, "rejected"),
    ("standard errors too small", averaged(0.8), uniform, {}, "rejected"),
    ("sets", np.random.default_rng(1).random(4001), np.full(4001, 0.6), {"bounds": (0, 1)}, "rejected"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "first", "second", "options", "outcome"), COMPARED, ids=[c[0] for c in COMPARED])
def test_what_is_compared(name, first, second, options, outcome):
    verdict = compare_estimators(first, second, samples=50_000, **options)
    assert verdict.outcome == outcome, str(verdict)


def test_standard_errors_are_right_where_random_numbers_are_shared():
    shared = np.random.default_rng(5).random((5000, 10))
    reported = Draws(shared.mean(axis=1), stderr=shared.std(axis=1, ddof=1) / np.sqrt(10))
    other = Draws(reported.value + 1e-3 * np.random.default_rng(6).normal(size=5000), stderr=reported.stderr)
    names = [f.check for f in compare_estimators(reported, other).findings if f.outcome == "rejected"]
    assert not [name for name in names if "error" in name]


@pytest.mark.parametrize(
    ("second", "options", "words"),
    [
        (0.5, {}, "check_estimator"),
        (Reference(0.5), {}, "check_estimator"),
        (None, {}, "estimators"),
        (uniform, {"variance": 0.1}, "pair"),
    ],
)
def test_comparisons_that_are_none_are_explained(second, options, words):
    with pytest.raises(InvalidValueError, match=words):
        compare_estimators(uniform, second, **options)
    with pytest.raises(InvalidValueError, match="pairs"):
        compare_estimators(np.zeros(10), np.zeros(11))


@pytest.mark.parametrize("base", [1e15, -1e15, 1e6])
def test_rounding_of_large_values_counts_in_their_exact_variance(base):
    for _ in range(3):
        verdict = check_estimator(lambda r, n: base + r.random(n), base + 0.5, variance=1 / 12, samples=400_000)
        assert verdict.outcome == "not rejected", str(verdict)
    wrong = check_estimator(lambda r, n: base + 2 * r.random(n), base + 1, variance=1 / 12, samples=100_000)
    assert wrong.outcome == "rejected"


def reported(values, less=0):
    """Return an estimator of means of so many normal values with their standard errors, divided by their number less one or not."""

    def draw(rng, n):
        x = rng.normal(1, 1, (n, values))
        return Draws(x.mean(axis=1), stderr=x.std(axis=1, ddof=1 - less) / np.sqrt(values))

    return draw


def test_standard_errors_that_divide_by_n_are_found_or_it_is_said_with_how_many():
    # Of some samples the skewness is too large yet to say it: the next will.
    verdicts = (check_estimator(reported(12), 1.0, samples=12_000) for _ in range(60))
    said = (re.search(r"would show with (\S+) realisations", str([f.message for f in v.findings])) for v in verdicts)
    needed = float(next(filter(None, said))[1])
    assert 14_000 < needed < 40_000
    found = [check_estimator(reported(12, less=1), 1.0, samples=needed).outcome for _ in range(4)]
    assert found.count("rejected") >= 2  # each with probability 0.99 or so
    assert check_estimator(reported(12), 1.0, samples=needed).outcome == "not rejected"


def test_standard_errors_of_two_halves_have_one_degree_of_freedom():
    def halves(rng, n, factor=0.5):
        even, odd = rng.normal(1, 1, (2, n))
        return Draws((even + odd) / 2, stderr=factor * np.abs(even - odd))

    verdict = check_estimator(halves, 1.0, samples=100_000)
    assert verdict.outcome == "not rejected", str(verdict)
    assert "with 1 degree of freedom" in str([f.message for f in verdict.findings])
    assert check_estimator(lambda r, n: halves(r, n, 1.0), 1.0, samples=100_000).cause == "wrong standard errors"


def test_values_nearly_as_large_as_there_are():
    for mean, outcome in ((0.0, "not rejected"), (1e307, "rejected")):
        verdict = check_estimator(lambda r, n: (r.random(n) - 0.5) * 1.7e308, mean, samples=20_000)
        assert verdict.outcome == outcome, str(verdict)


def test_an_estimator_that_ends_the_program_is_a_subject_that_fails():
    with pytest.raises(SubjectError, match="SystemExit: 3"):
        check_estimator(lambda r, n: sys.exit(3), 0.5)


def test_a_reference_is_no_image():
    with pytest.raises(InvalidValueError, match="reshape"):
        check_estimator(lambda r, n: r.random(n), [[0.5]])


@pytest.mark.parametrize("outside", [-1e-3, -50.0, -1e300])
def test_what_lies_outside_one_declared_bound_is_rejected_for_that_alone(outside):
    x = np.random.default_rng(1).random(100)
    x[3] = outside
    for sign, options in ((1, {"nonnegative": True}), (-1, {"bounds": (-np.inf, 0.0)})):
        verdict = check_estimator(sign * x, sign * 0.5, **options)
        found = [f.check for f in verdict.findings if f.outcome == "rejected"]
        assert "bounds" in found, str(verdict)
        assert all(f.p_value is None or 0 <= f.p_value <= 1 for f in verdict.findings)
