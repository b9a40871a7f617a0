"""Parts of the judgement of one mean, each by the input that needs it."""

import math

import numpy as np
import pytest

from fogproof import check_estimator
from fogproof.checks.escalation import EARLY
from fogproof.checks.mean_claim import MeanClaim
from fogproof.checks.quantities import CheckedQuantity
from fogproof.checks.statistics.coverage import degrees_of_freedom, of_few_values
from fogproof.checks.statistics.known import Known
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.power import student_reach
from fogproof.checks.verdict import Finding
from fogproof.contracts import Draws

ALPHA = 1e-6


def claim(x, value, error=0.0, known=()):
    """A mean of the numbers x (n,) that should be `value`."""

    def numbers(draws):
        return draws.value

    quantity = CheckedQuantity("mean", numbers, np.array([value]), np.array([error]), "bias", known)
    return MeanClaim(quantity, 0, "mean", Moments.of(x), len(x), ALPHA)


def again(x):
    """What a second look at all numbers is given."""
    return lambda: [(Draws(x[:, None]), [len(x)])]


@pytest.mark.parametrize("number", [0.1, 0.7, 1 / 3])
@pytest.mark.parametrize("n", [3, 10, 1000])
def test_equal_numbers_have_their_own_mean_and_do_not_scatter(number, n):
    """The rounded sum of three times 0.1 is not three times as large, but nothing scatters there."""
    data = Moments.of(np.full(n, number))
    assert (data.mean, data.m2, data.stderr) == (number, 0.0, 0.0)


def test_a_value_that_none_may_differ_from_is_held_by_all():
    """The value farthest from the reference decides, on either side."""
    for x in ([0.3, 0.3, 0.5], [0.3, 0.1, 0.3]):
        assert claim(np.array(x), 0.3).exactly().outcome == "rejected"
        assert claim(np.array(x), 0.3, error=0.25).exactly().outcome == "not rejected"


@pytest.mark.parametrize("bounds", [(0.0, 1.0), (-math.inf, 1.0), (0.2, math.inf)])
def test_one_value_outside_declared_bounds_is_told(bounds):
    odd = 1.5 if math.isfinite(bounds[1]) else 0.1
    x = np.append(np.linspace(0.4, 0.6, 1000), odd)
    known = (Known(low=bounds[0], high=bounds[1]),)
    assert [f.outcome for f in claim(x, 0.5, known=known).outside()] == ["rejected"]
    assert claim(x[:-1], 0.5, known=known).outside() == []


def test_bets_allow_for_the_error_of_the_reference():
    """Rare large values, a reference that is off by nearly all of its error: right. Off by half of it more: wrong."""
    rng, n = np.random.default_rng(), 200_000
    x = np.where(rng.random(n) < 1e-3, 1000.0, rng.random(n))  # mean 1.4995, standard error 0.07
    known, error = (Known(low=0.0, high=1000.0),), 0.9
    for off, rejected in ((0.8, False), (-0.8, False), (-1.4, True)):
        one = claim(x, 1.4995 + off, error, known)
        found = one._second_look(one.judged(again(x), True), again(x), True)
        assert (found.outcome == "rejected") is rejected, (off, str(found))


def test_only_what_is_beyond_doubt_ends_a_run_early():
    one = claim(np.linspace(0, 1, 100), 0.5)
    for p, final in ((EARLY * ALPHA / 2, True), (EARLY * ALPHA * 2, False), (ALPHA / 2, False)):
        finding = Finding("mean", "rejected", "", p, ALPHA, distribution_free=True)
        assert one.beyond_doubt(finding) is final


@pytest.mark.parametrize("n", [6000, 30_000])
def test_what_would_just_be_caught_has_made_up_for_its_skewness(n):
    """Half of the time a bias of `reach` is caught: a sample that lies just so far off has a p-value of alpha."""
    data = Moments.of(np.random.default_rng().gamma(2.0, size=n))
    growth = data.skewness / (3 * math.sqrt(n))
    reach = student_reach(data, ALPHA, miss=0.5) / (1 + growth)
    p = [mean_test("", "", data, data.mean - part * reach, 0.0, ALPHA).p_value for part in (1.02, 0.9)]
    assert p[0] <= ALPHA < p[1]
    assert p[0] > ALPHA / 10, "and not much smaller"


@pytest.mark.parametrize("freedom", [1, 4, 16])
def test_degrees_of_freedom_are_those_of_the_squares(freedom):
    rng = np.random.default_rng()
    squares = Moments.of(rng.chisquare(freedom, 200_000) / freedom)
    normal = Moments.of(rng.normal(size=2_000_000))
    assert degrees_of_freedom(squares, normal) == pytest.approx(freedom, rel=0.1)
    assert of_few_values(squares, normal) == (freedom < 10)


def test_degrees_of_freedom_of_values_that_are_not_normal():
    """Four uniforms have three, though their squared standard errors scatter as those of five or six normal ones."""
    x = np.random.default_rng().random((200_000, 4))
    squares, means = Moments.of(x.var(axis=1, ddof=1)), Moments.of(x.mean(axis=1))
    assert degrees_of_freedom(squares, means) == pytest.approx(3, rel=0.1)
    assert of_few_values(squares, means)


def test_an_order_is_0_where_another_order_was_drawn():
    """Values lie in (1, 3), one order each: those of order 1 are 0 half of the time, outside what is declared of a value."""

    def draw(rng, n):
        return Draws(rng.uniform(1, 3, n), order=rng.integers(0, 2, n))

    verdict = check_estimator(draw, {0: 1.0, 1: 1.0}, bounds=(1.0, 3.0), samples=20_000, seed=1)
    assert verdict.outcome == "not rejected", str(verdict)
    wrong = check_estimator(draw, {0: 1.0, 1: 1.3}, bounds=(1.0, 3.0), samples=20_000, seed=1)
    assert [f.check for f in wrong.findings if f.outcome == "rejected"] == ["mean of order 1"]
