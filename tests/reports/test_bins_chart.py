"""Bins of a law are drawn over an axis that shows them, however far its tail goes."""

import re

import numpy as np
import pytest
from scipy import stats

from fogproof import HalfLine, check_sampler
from fogproof.reports.charts.bins import Bins
from fogproof.reports.charts.pictures import render

FAR_END = float(np.finfo(float).max)


def drawn(law, n=64, end=FAR_END):
    edges = np.clip(law.ppf(np.linspace(0, 1, n + 1)), -end, end)
    return render(Bins(tuple(edges), "x", (1 / n,) * n, (1 / n,) * n), "bins").svg


def words_of(svg):
    return re.findall(r"<text[^>]*>([^<]*)</text>", svg)


@pytest.mark.parametrize(
    "law", [stats.expon(), stats.norm(), stats.cauchy(), stats.gamma(3)], ids=lambda it: it.dist.name
)
@pytest.mark.parametrize("end", [FAR_END, np.inf, 1e5])
def test_a_far_tail_is_an_open_bin(law, end):
    words = words_of(drawn(law, end=end))
    assert "x (the outermost bin is open)" in words
    assert not any("10" in word and "·" in word for word in words)  # no tick of 10^308


@pytest.mark.parametrize("law", [stats.uniform(), stats.triang(0.5)], ids=lambda it: it.dist.name)
def test_a_range_without_a_tail_is_drawn_as_it_is(law):
    assert "x" in words_of(drawn(law))


@pytest.mark.parametrize("law", [stats.pareto(0.2), stats.loguniform(1e-9, 1)], ids=lambda it: it.dist.name)
def test_widths_that_no_axis_shows_together_are_numbered(law):
    assert "number of the bin of x" in words_of(drawn(law))


@pytest.mark.parametrize(("share", "where"), [((0.4, 0.1, 0.5), "beyond 2 "), ((0.4, 0.5, 0.1), "from 1 to 2 ")])
def test_the_end_of_numbers_is_no_place(share, where):
    """Where the domain has no end, a bin lies beyond its edge: nobody reads 1.798e+308."""
    words = render(Bins((0.0, 1.0, 2.0, FAR_END), "x", (0.5, 0.3, 0.2), share), "bins").words
    assert f"in the bin {where}" in words
    assert "e+308" not in words


def test_a_verdict_names_no_end_of_numbers():
    """Samples of half the rate: the places that are told end nowhere."""
    verdict = check_sampler(
        lambda u: -2 * np.log1p(-u[:, 0]), lambda x: np.exp(-x), HalfLine(0.0), dimensions=1, seed=3
    )
    told = " ".join(f"{f.message} {f.region}" for f in verdict.findings if f.outcome == "rejected")
    assert " < x" in told
    assert "e+308" not in told
