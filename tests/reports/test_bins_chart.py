"""Bins of a law are drawn over an axis that shows them, however far its tail goes."""

import re

import numpy as np
import pytest
from scipy import stats

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
