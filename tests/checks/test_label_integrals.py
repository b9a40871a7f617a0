"""No integral of a pdf is printed with an interval that is false; the short form of `tools/label_integrals.py`."""

import numpy as np
import pytest
from label_integrals import deviation, lobes, visible_normals

from fogproof import UnitHemisphere, check_sampler
from fogproof.checks.sampled_integrals import reach
from fogproof.checks.statistics.integrated import Integrated
from fogproof.checks.statistics.labels import Sums, whole

SEEDS = range(6)


@pytest.mark.parametrize("family", [visible_normals, lobes])
def test_samples_that_crowd_at_an_edge_move_no_integral(family):
    found = [deviation(seed, 20_000, family, 1) for seed in SEEDS]
    stated = [z for _, z, why_not in found if not why_not]
    assert stated
    assert max(map(abs, stated)) < 6


def test_visible_normals_without_their_warp_lie_on_the_horizon_too_often():
    domain, pdf, (_, without_warp), k = visible_normals(np.random.default_rng(5))
    verdict = check_sampler(without_warp, pdf, domain, dimensions=k, samples=60_000)
    assert isinstance(domain, UnitHemisphere)
    assert (verdict.outcome, verdict.cause) == ("rejected", "atom"), str(verdict)
    assert "x[2] = 0" in verdict.diagnosis


def test_ratios_of_a_heavy_tail_are_no_interval():
    rng = np.random.default_rng(1)
    light, heavy = rng.random(20_000), rng.random(20_000) ** -0.9
    assert Integrated.of(light).why_not == ""
    assert abs(Integrated.of(light).mean - 0.5) < 5 * Integrated.of(light).error
    assert "few points" in Integrated.of(heavy).why_not
    assert "too few" in Integrated.of(light[:99]).why_not
    assert "rounding" in Integrated.of(np.append(light, np.nan)).why_not


def test_sums_of_parts_are_the_sums_of_the_whole():
    ratio = np.random.default_rng(2).random(5000)
    parts = Integrated(Integrated.of(ratio[:2000]).sums + Integrated.of(ratio[2000:]).sums)
    assert parts.mean == pytest.approx(Integrated.of(ratio).mean)
    assert parts.error == pytest.approx(Integrated.of(ratio).error)


@pytest.mark.parametrize("expected", [1, 4, 9, 20])
def test_few_high_points_do_not_deny_an_integral(expected):
    """Of 10 000 points `expected` ones, on average, are 300 times as high as the others: 0 to 3 of them may be seen."""
    rng = np.random.default_rng()
    base, high, n = 1.0, 300.0, 10_000
    for seen in rng.poisson(expected, 2000):
        if seen:  # what nobody has seen nobody can allow for
            found = Integrated.of(np.concatenate([np.full(seen, high), np.full(n - seen, base)]))
            truth = base + (high - base) * expected / n
            assert abs(found.mean - truth) <= reach(found), f"{seen} seen"
    lone = Integrated.of(np.concatenate([[high], np.full(n - 1, base)]))
    assert abs(lone.mean - (base + (high - base) * 9 / n)) > 8 * lone.error, "one of nine expected, by the normal law"
    assert lone.dominated
    assert high / n <= lone.largest < 1.1 * high / n


def whole_of(integral, error, variance=1e5):
    """Return the finding of residuals that sum to 0 beside an integral and its standard error, of 10 000 points."""
    n = 1e4
    square = n * (error**2 * n + integral**2)
    sums = np.array([[0.0], [variance], [0.0], [0.0]])
    empty = np.empty(0)
    return whole(
        "labels", (Sums(sums, sums, np.array([n, n * integral, square, square, 0]), empty, empty, empty),), 1e-7
    )


def test_an_integral_that_is_off_beside_labels_that_are_not_says_why_it_is_no_test():
    off, near = whole_of(0.977, 0.003), whole_of(0.99, 0.003)
    assert off.outcome == near.outcome == "not rejected"
    assert "0.977 +- 0.003, 7.7 standard errors off: no test" in off.message
    assert near.message.endswith("0.99 +- 0.003")
