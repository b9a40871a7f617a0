"""Tails heavier than their bulk shows: on one side alone, of little weight, or seen by no sample that sets the scale."""

import numpy as np
import pytest
from scipy import stats

from fogproof import HalfLine, RealLine, check_sampler
from fogproof.checks.density.charts import chart_of
from fogproof.domains.line import Tail

N = 30_000


def tail_and_exponential(index, weight, side):
    """A sampler and its pdf: index weight (1 + |x|)^(-1 - index) on one side of 0, (1 - weight) exp(-|x|) on the other."""

    def sample(u):
        far = (1 - u[:, 1]) ** (-1 / index) - 1
        return side * np.where(u[:, 0] < weight, far, np.log1p(-u[:, 1]))

    def pdf(x):
        t = np.abs(x)
        return np.where(side * x > 0, weight * index * (1 + t) ** (-1 - index), (1 - weight) * np.exp(-t))

    return sample, pdf


def checked(sample, pdf, domain=None, **options):
    options = {"dimensions": 2, "samples": N} | options
    return check_sampler(sample, pdf, domain or RealLine(), **options)


def integral(verdict):
    return next(f.message for f in verdict.findings if f.check == "normalisation")


@pytest.mark.parametrize("index", [0.5, 0.7])
def test_a_tail_on_one_side_and_nothing_on_the_other(index):
    law = stats.invgamma(index)
    verdict = checked(lambda rng, n: 1 / rng.gamma(index, 1, n), law.pdf, dimensions=None)
    assert verdict.outcome == "not rejected", str(verdict)
    assert integral(verdict) == "the pdf integrates to 1 +- 2e-07"


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(("index", "weight"), [(0.3, 0.1), (0.2, 0.9), (0.2, 0.01)])
def test_a_heavy_and_a_light_side(index, weight, side):
    verdict = checked(*tail_and_exponential(index, weight, side), samples=4 * N)
    assert verdict.outcome == "not rejected", str(verdict)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("index", [0.1, 0.3])
def test_a_tail_that_hardly_a_sample_shows(index, side):
    verdict = checked(*tail_and_exponential(index, 1e-4, side))
    assert verdict.outcome == "not rejected", str(verdict)


def test_a_tail_of_little_weight_on_a_half_line():
    def sample(u):
        return np.where(u[:, 0] < 1e-3, (1 - u[:, 1]) ** -5 - 1, -np.log1p(-u[:, 1]))

    verdict = checked(sample, lambda x: 0.2e-3 * (1 + x) ** -1.2 + 0.999 * np.exp(-x), HalfLine())
    assert verdict.outcome == "not rejected", str(verdict)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_tail_a_hundredth_too_high_is_seen(side):
    sample, pdf = tail_and_exponential(0.3, 0.1, side)
    verdict = checked(sample, lambda x: pdf(x) * np.where(side * x > 1e6, 1.01, 1.0))
    assert verdict.cause == "normalisation", str(verdict)
    effect = next(f.effect for f in verdict.findings if f.check == "normalisation")
    assert abs(effect / (0.001 * (1 + 1e6) ** -0.3) - 1) < 1e-3


@pytest.mark.parametrize("side", [-1, 1])
def test_a_tail_of_another_index_is_seen(side):
    sample, _ = tail_and_exponential(0.33, 0.1, side)
    _, pdf = tail_and_exponential(0.3, 0.1, side)
    verdict = checked(sample, pdf, samples=10 * N)
    assert verdict.outcome == "rejected", str(verdict)


def test_points_far_to_the_left_have_coordinates_of_their_own():
    u, x = (np.arange(4096) + 0.5) / 4096, -np.logspace(3, 60, 58)
    law, chart = RealLine().law(stats.t(0.5).ppf(u)), chart_of(RealLine(), stats.norm.ppf(u), None)
    for there, back in ((law.coordinates(x, x), law.place), (chart.coordinates(x), chart.to_point)):
        assert np.all(np.diff(there[:, 0]) < 0)
        assert np.allclose(back(there), x, rtol=1e-9)


def test_the_tail_is_as_heavy_as_the_farthest_points_show():
    u = (np.arange(1 << 14) + 0.5) / (1 << 14)
    assert Tail.of(stats.expon.ppf(u)).b == 1.0
    mixed = np.concatenate([stats.expon.ppf(u), (1 - u[::64]) ** (-1 / 0.3)])
    assert abs(Tail.of(mixed).b - 0.3) < 0.06
