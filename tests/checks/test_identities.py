"""Identities of functions are checked point by point: weights that sum to one and fit their densities, majorants that bound."""

from types import SimpleNamespace

import numpy as np
import pytest

from fogproof import Box, Interval, UnitSphere, UnitSquare, check_bound, check_mis
from fogproof.errors import InvalidValueError, SubjectError

UNIFORM = (lambda u: u[:, 0], lambda x: np.ones(len(x)), 1)
LINEAR = (lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, 1)
LEFT = (lambda u: 0.5 * u[:, 0], lambda x: np.where(x < 0.5, 2.0, 0.0), 1)


def heuristic(*densities, exponent=1.0, counts=None):
    def weights(x):
        p = np.stack([d(x) for d in densities], axis=-1) * (np.ones(len(densities)) if counts is None else counts)
        return p**exponent / np.sum(p**exponent, axis=-1, keepdims=True)

    return weights


BALANCE = heuristic(UNIFORM[1], LINEAR[1])
WEIGHTS = [
    ("balance heuristic", BALANCE, {}, set()),
    ("power heuristic", heuristic(UNIFORM[1], LINEAR[1], exponent=2), {"exponent": 2}, set()),
    ("counts", heuristic(UNIFORM[1], LINEAR[1], counts=[1, 4]), {"counts": [1, 4]}, set()),
    ("single precision", lambda x: BALANCE(x).astype(np.float32), {"precision": "float32"}, set()),
    ("any partition", lambda x: np.stack([x, 1 - x], -1), {"exponent": None}, set()),
    ("counts forgotten", BALANCE, {"counts": [1, 4]}, {"weights of strategy 0", "weights of strategy 1"}),
    ("power taken for balance", BALANCE, {"exponent": 2}, {"weights of strategy 0", "weights of strategy 1"}),
    ("exchanged", lambda x: BALANCE(x)[:, ::-1], {}, {"weights of strategy 0", "weights of strategy 1"}),
    ("no weight at all", lambda x: np.full((len(x), 2), 0.6), {"exponent": None}, {"sum of weights"}),
    ("off by a part in a million", lambda x: BALANCE(x) * (1 + 1e-6), {"exponent": None}, {"sum of weights"}),
    ("0/0", lambda x: np.where(x < 0.01, np.nan, BALANCE(x).T).T, {"exponent": None}, {"sum of weights"}),
]


@pytest.mark.parametrize(("name", "weights", "options", "rejecting"), WEIGHTS, ids=[c[0] for c in WEIGHTS])
def test_weights_of_multiple_importance_sampling(name, weights, options, rejecting):
    verdict = check_mis([UNIFORM, LINEAR], weights, **options)
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} == rejecting, str(verdict)


def test_weights_are_nothing_where_a_strategy_cannot_sample():
    right = heuristic(UNIFORM[1], LEFT[1])
    assert check_mis([UNIFORM, LEFT], right).outcome == "not rejected"
    wrong = check_mis([UNIFORM, LEFT], lambda x: np.full((len(x), 2), 0.5), exponent=None)
    assert [f.check for f in wrong.findings if f.outcome == "rejected"] == ["weights without samples"]
    hole = check_mis([LEFT, LEFT], lambda x: np.full((len(x), 2), 0.5))
    assert hole.outcome == "not rejected"


def test_densities_in_two_measures_are_told_apart():
    """A light sampled by area, its density wrongly left per area where the other strategy's is per solid angle."""

    def light(u):
        x = np.stack([2 * u[:, 0] - 1, 2 * u[:, 1] - 1, np.full(len(u), 2.0)], -1)
        return x / np.linalg.norm(x, axis=1, keepdims=True)

    def solid_angle(x):
        t = 2 / np.where(x[:, 2] > 0, x[:, 2], np.nan)
        inside = (x[:, 2] > 0) & (np.abs(x[:, :2] * t[:, None]).max(axis=1) <= 1 + 1e-12)
        return np.where(inside, 0.25 * t * t / np.abs(x[:, 2]), 0.0)

    def sphere(u):
        z, phi = 1 - 2 * u[:, 0], 2 * np.pi * u[:, 1]
        return np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], -1)

    def isotropic(x):
        return np.full(len(x), 0.25 / np.pi)

    strategies = [(light, solid_angle, 2), (sphere, isotropic, 2)]
    assert check_mis(strategies, heuristic(solid_angle, isotropic)).outcome == "not rejected"
    by_area = heuristic(lambda x: np.where(solid_angle(x) > 0, 0.25, 0.0), isotropic)
    verdict = check_mis(strategies, by_area)
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} == {
        f"weights of strategy {i}" for i in (0, 1)
    }


def test_bad_strategies_and_weights_are_explained():
    with pytest.raises(InvalidValueError, match="at least two"):
        check_mis([UNIFORM], BALANCE)
    with pytest.raises(InvalidValueError, match="sample"):
        check_mis([UNIFORM, np.sqrt], BALANCE)
    with pytest.raises(InvalidValueError, match="counts"):
        check_mis([UNIFORM, LINEAR], BALANCE, counts=[1, 0])
    with pytest.raises(SubjectError, match="shape"):
        check_mis([UNIFORM, LINEAR], lambda x: x)


def needle(at, width, height=1.0):
    return lambda x: 1 + height * np.exp(-np.sum((np.atleast_2d(x.T).T - at) ** 2, axis=-1) / width**2)


BOUNDS = [
    ("sine", lambda x: 1 + 0.8 * np.sin(3 * x), 1.8, Interval(0.0, 4.0), "not rejected"),
    ("sine, short by a millionth", lambda x: 1 + 0.8 * np.sin(3 * x), 1.8 * (1 - 1e-6), Interval(0.0, 4.0), "rejected"),
    ("at the end alone", lambda x: x, 1.0 - 1e-6, Interval(0.0, 1.0), "rejected"),
    ("majorant of blocks", lambda x: x, lambda x: np.ceil(8 * x) / 8, Interval(0.0, 1.0), "not rejected"),
    (
        "a block forgotten",
        lambda x: x,
        lambda x: np.where((x > 0.3) & (x < 0.301), 0.3, 1.0),
        Interval(0.0, 1.0),
        "rejected",
    ),
    (
        "a peak in three dimensions",
        needle(np.array([0.3, 0.7, 0.55]), 0.02, 9.0),
        9.99,
        Box((0, 0, 0), (1, 1, 1)),
        "rejected",
    ),
    ("its right bound", needle(np.array([0.3, 0.7, 0.55]), 0.02, 9.0), 10.0, Box((0, 0, 0), (1, 1, 1)), "not rejected"),
    ("on the sphere", lambda x: 1 + x[:, 2] ** 2, 1.999999, UnitSphere(), "rejected"),
    ("loose", lambda x: 1 + x[:, 0] * x[:, 1], 10.0, UnitSquare(), "inconclusive"),
    ("not a number", lambda x: np.where(np.abs(x - 0.5) < 1e-3, np.nan, 1.0), 1.0, Interval(0.0, 1.0), "rejected"),
    ("nothing", lambda x: 0 * x, 0.0, Interval(0.0, 1.0), "not rejected"),
]


@pytest.mark.parametrize(("name", "f", "bound", "domain", "outcome"), BOUNDS, ids=[c[0] for c in BOUNDS])
def test_majorants(name, f, bound, domain, outcome):
    verdict = check_bound(f, bound, domain)
    assert verdict.outcome == outcome, str(verdict)
    assert verdict.samples <= 110_000
    if outcome == "rejected":
        assert verdict.cause == "wrong bound"


def test_single_precision_may_exceed_its_bound_by_rounding():
    def f(x):
        return np.float32(1.8) * np.ones(len(x), dtype=np.float32)

    assert check_bound(f, 1.8, Interval(0.0, 1.0), precision="float32").outcome == "not rejected"
    assert check_bound(f, 1.8 - 1e-5, Interval(0.0, 1.0), precision="float32").outcome == "rejected"
    with pytest.raises(InvalidValueError, match="domain"):
        check_bound(f, 1.8, (0, 1))


def test_the_resolution_of_a_bound_is_kept():
    """A peak on the stated share of the domain, anywhere, is missed one time in a hundred by uniform points; here by no more."""
    share = check_bound(lambda x: np.ones(len(x)), 1.0, Interval(0.0, 1.0), evaluations=400).resolution.value
    assert share == pytest.approx(1 - 0.01 ** (1 / 100))
    rng, missed = np.random.default_rng(), 0
    for _ in range(300):
        cells = rng.random(1000) < share  # not one place, which evenly spread points would find: so many small ones

        def f(x, cells=cells):
            return np.where(cells[np.minimum((x * 1000).astype(int), 999)], 2.0, 0.9)

        missed += check_bound(f, 1.0, Interval(0.0, 1.0), evaluations=400).outcome != "rejected"
    assert missed <= 12  # P(more | 1 %) < 1e-5


def test_a_strategy_may_draw_from_a_generator():
    uniform = (lambda rng, n: rng.random(n), np.ones_like, None)
    linear = SimpleNamespace(sample=lambda rng, n: np.sqrt(rng.random(n)), pdf=lambda x: 2 * x, dimensions=None)
    right = check_mis([uniform, linear], lambda x: np.stack([1 / (1 + 2 * x), 2 * x / (1 + 2 * x)], axis=-1))
    assert right.outcome == "not rejected"
    assert check_mis([uniform, linear], lambda x: np.full((len(x), 2), 0.5)).outcome == "rejected"
    with pytest.raises(InvalidValueError, match=r"strategies\[1\]\.dimensions must be a whole number"):
        check_mis([uniform, (linear.sample, linear.pdf, 0.5)], lambda x: x)


def test_the_resolution_of_weights_is_kept():
    """Wrong where as many points lie as is stated, found as often."""
    right = check_mis([UNIFORM, LINEAR], BALANCE, samples=2000)
    assert right.resolution.kind.startswith("share of points with wrong")
    end = 0.5 * (np.sqrt(1 + 8 * right.resolution.value) - 1)  # (x + x^2) / 2 of both strategies' points lie below x
    found = [
        check_mis(
            [UNIFORM, LINEAR], lambda x: np.where(x < end, 0.9, 1.0)[:, None] * BALANCE(x), samples=2000, seed=seed
        )
        for seed in range(20)
    ]
    assert sum(verdict.outcome == "rejected" for verdict in found) >= 17
