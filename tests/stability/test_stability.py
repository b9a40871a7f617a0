"""Invariant: our formulas keep their bounds over hard regions, naive forms are seen to fail, and truth is not ours."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from types import CodeType, FunctionType, ModuleType

import flint
import numpy as np
import pytest

from fogproof import analytic, checks, estimators
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, NotInstalledError
from fogproof.stability import measure
from fogproof.stability.axes import decades, fine_uniforms, symmetric, uniforms
from fogproof.stability.exact import exactly
from fogproof.stability.formula import Formula, HardRegion, Naive
from fogproof.stability.formulas.phase_truth import PHASES, PhaseTruth
from fogproof.stability.measuring import POINTS_SHORT
from fogproof.stability.record import exit_code, hidden, select, short
from fogproof.stability.table import formulas

NAMES = [formula.name for formula in formulas()]


@pytest.fixture(scope="module")
def measured():
    return [row for formula in short(formulas()) for row in measure(formula, POINTS_SHORT)]


def test_every_bound_of_ours_is_kept(measured):
    broken = [row for row in measured if row.form == "ours" and row.violations]
    told = [f"{row.formula} {row.precision} {row.region}: {row.worst:.3g} at {row.at} {row.reason}" for row in broken]
    assert not told, told


def test_every_naive_form_is_seen_to_fail(measured):
    assert hidden(measured) == []
    assert exit_code(measured) == 0


def test_bounds_are_within_reach(measured):
    """A bound far above what ever happens would let a lost digit pass."""
    assert all(formula.bound <= 14 for formula in formulas() if formula.bound is not None)
    worst = {}
    for row in measured:
        if row.form == "ours" and row.bound is not None:
            worst[row.formula] = max(worst.get(row.formula, 0.0), row.worst / row.bound)
    assert sorted(worst.values())[len(worst) // 2] > 0.2


OURS = ("fogproof.analytic", "fogproof.estimators", "numpy", "scipy", "math")
TRUTHS = ("pdf", "cdf", "place", "mean")


def borrowed(value, seen):
    """What a truth refers to, through closures and helpers, that is floating point or ours."""
    if id(value) in seen:
        return set()
    seen.add(id(value))
    home = value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", None) or ""
    if home.startswith(OURS):
        return {home}
    if isinstance(value, PhaseTruth):
        return set().union(*(borrowed(getattr(value, name), seen) for name in TRUTHS))
    if not isinstance(value, FunctionType):
        return set()

    def names(code):
        return set(code.co_names).union(*(names(part) for part in code.co_consts if isinstance(part, CodeType)))

    inner = [value.__globals__[name] for name in names(value.__code__) if name in value.__globals__]
    inner += [cell.cell_contents for cell in value.__closure__ or ()]
    return set().union(*(borrowed(part, seen) for part in inner))


@pytest.mark.parametrize("formula", formulas(), ids=NAMES)
def test_truth_is_not_ours(formula):
    assert not borrowed(formula.truth, set())


def test_the_guard_of_truth_sees_ours():
    def helper(xi):
        return estimators.phase_value(xi, xi)

    assert borrowed(lambda xi: helper(xi), set()) == {"fogproof.estimators"}
    assert borrowed(lambda xi: np.exp(xi), set()) == {"numpy"}
    oracle = replace(PHASES[0], pdf=lambda mu: analytic.phase_pdf(mu, mu))
    assert borrowed(lambda mu: oracle.pdf(mu), set()) == {"fogproof.analytic"}


def test_every_formula_proves_something_public():
    rooms = {"analytic": analytic, "estimators": estimators, "checks": checks}
    for formula in formulas():
        room, name = formula.of.split(".")
        assert name in rooms[room].__all__, formula


# --- broken twins: each planted error must be found -----------------------------------------------------------------------------

HARD = HardRegion("thin", {"xi": fine_uniforms, "sigma_t": decades(1e-3, 1e3)})


def log1p(xi, sigma_t):
    return -np.log1p(-xi) / sigma_t


RIGHT = Formula(
    "test/right", "", "estimators.FreePath", log1p, lambda xi, sigma_t: -(-xi).log1p() / sigma_t, (HARD,), 2.0
)


def the_only(formula, points=12):
    rows = measure(formula, points)
    assert len(rows) == 1
    return rows[0]


def test_a_right_formula_keeps_its_bound():
    row = the_only(RIGHT)
    assert row.violations == 0
    assert 0.05 < row.worst < 1
    assert exit_code([row]) == 0


@pytest.mark.parametrize(
    "planted",
    [
        lambda xi, sigma_t: -np.log(1 - xi) / sigma_t,
        lambda xi, sigma_t: -np.log1p(-xi) / sigma_t * (1 + 1e-15),
        lambda xi, sigma_t: np.where(xi > 0.9999, np.nan, -np.log1p(-xi) / sigma_t),
        lambda xi, sigma_t: np.where(xi > 0.9999, np.inf, -np.log1p(-xi) / sigma_t),
        lambda xi, sigma_t: (-np.log1p(-xi) / sigma_t).astype(np.float32).astype(float),
        lambda xi, sigma_t: 1 / (0 * xi).sum(),
    ],
    ids=["cancellation", "nine ulps", "nan", "inf", "single precision", "raises"],
)
def test_a_planted_error_is_found(planted):
    row = the_only(replace(RIGHT, ours=planted))
    assert row.violations > 0
    assert row.worst > 2
    assert exit_code([row]) == 1


@pytest.mark.parametrize("where", ["at once", "in a truth alone"])
def test_a_missing_package_is_no_fault_of_the_formula(monkeypatch, where):
    """Without what the truth is made of, every form would lose every digit."""
    formula = RIGHT
    if where == "at once":
        monkeypatch.setitem(sys.modules, "flint", None)
    else:

        def lost(xi, sigma_t):
            raise NotInstalledError("python-flint", "rigorous")

        formula = replace(RIGHT, truth=lost)
    with pytest.raises(NotInstalledError, match="python-flint is not installed; install it with"):
        measure(formula, 3)


def test_an_oracle_that_states_too_small_an_error_is_found():
    def claims(share):
        return lambda xi, sigma_t: Reference(log1p(xi, sigma_t), share * np.spacing(log1p(xi, sigma_t)), "", "")

    honest, bold = (the_only(replace(RIGHT, ours=claims(share), bound=None)) for share in (2.0, 1e-3))
    assert honest.violations == 0 < honest.share < 1
    assert 1 < honest.stated < 3
    assert bold.violations > 0
    assert bold.share > 1


def test_a_naive_form_that_fails_nowhere_is_told():
    same = replace(RIGHT, naive=(Naive("the same", "a test", log1p),))
    rows = measure(same, 6)
    assert hidden(rows) == [("test/right", "the same")]
    assert exit_code(rows) == 3


def test_single_precision_has_its_own_ulps():
    rows = measure(replace(RIGHT, precisions=("float64", "float32")), 8)
    assert [row.violations for row in rows] == [0, 0]
    wide = measure(replace(RIGHT, precisions=("float32",), ours=lambda **x: log1p(**x) * np.float32(1 + 2e-6)), 8)
    assert wide[0].violations > 0


# --- the truth ------------------------------------------------------------------------------------------------------------------


def test_truth_has_fifty_digits_whatever_cancels():
    found = exactly(lambda x: 1 - (-x).exp(), {"x": 1e-300})
    assert found.value.rel_accuracy_bits() >= 167
    assert abs(float(found.value) / 1e-300 - 1) < 1e-15
    assert exactly(lambda x: (1 + x).sqrt() - (1 + x).sqrt(), {"x": 0.3}).value.is_zero()
    with pytest.raises(ArithmeticError, match="no enclosure"):
        exactly(lambda x: x + flint.arb(0, 1), {"x": 1.0})


@pytest.mark.parametrize(
    ("function", "x", "condition"),
    [(lambda x: x**3, 0.7, 3.0), (lambda x: 1 - x, 1 - 2.0**-30, 2.0**30 - 1), (lambda x: x - x, 0.5, 0.0)],
)
def test_condition_numbers(function, x, condition):
    found = exactly(function, {"x": x})
    assert float(found.reach) == pytest.approx(condition * abs(float(found.value)), rel=1e-9)


def test_ends_of_a_domain_are_looked_at_from_inside():
    found = exactly(lambda x: (1 - x * x).sqrt(), {"x": 1.0})
    assert math.isfinite(float(found.reach))


# --- the regions ----------------------------------------------------------------------------------------------------------------


def test_axes_hold_what_they_promise():
    for dtype, grain in ((np.float64, 2.0**-53), (np.float32, 2.0**-24)):
        xi = uniforms(16, np.dtype(dtype)).astype(float)
        assert xi[0] == 0
        assert xi[1] == grain
        assert xi[-1] == 1 - grain
        assert np.all(np.modf(xi / grain)[0] == 0)
    wide = decades(1e-300, 1e3, 0.0, math.inf)(20, np.dtype(float))
    assert [wide[0], wide[-1]] == [0, math.inf]
    assert wide[1] == pytest.approx(1e-300)
    g = symmetric(1e-12)(24, np.dtype(float))
    assert g.max() == -g.min() == pytest.approx(1 - 1e-12, abs=1e-16)
    assert 0 in g
    assert np.all(np.abs(decades(1e-300, 1e300)(9, np.dtype(np.float32))) < np.inf)


def test_selection():
    assert {formula.name for formula in select(["free_path"])} == {n for n in NAMES if n.startswith("free_path/")}
    assert [formula.name for formula in select(["free_path/dist*", "free_path/distance"])] == ["free_path/distance"]
    with pytest.raises(InvalidValueError, match="themes are"):
        select(["nothing"])
