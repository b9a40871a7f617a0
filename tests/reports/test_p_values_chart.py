"""The histogram of p-values has bins that so many fill, ticks at whole numbers, and is not drawn of a few."""

import re

import numpy as np
import pytest

from fogproof.reports.charts.p_values import FEWEST, PValueHistogram, PValues
from fogproof.reports.charts.pictures import render
from fogproof.reports.charts.scale import Scale
from fogproof.reports.pages import page as page_module


@pytest.mark.parametrize(("n", "bins"), [(FEWEST, 5), (39, 5), (40, 10), (80, 20), (5000, 20)])
def test_each_bin_expects_enough(n, bins):
    words = render(PValueHistogram(tuple(np.random.default_rng(n).random(n))), "p").words
    assert f"{n / bins:.1f} are expected in each of {bins} bins" in words


@pytest.mark.parametrize("high", [1.08, 2.2, 4.3, 7.0, 11.0, 23.7, 119.0, 2.4e4])
def test_counts_have_whole_ticks(high):
    for most in (4, 5, 6):
        ticks = Scale(0, high, whole=True).ticks(most)
        assert 2 <= len(ticks) <= most + 1 or high < 2
        assert all(re.fullmatch(r"\d+", name) and float(name) == value for value, name in ticks)


def test_a_few_p_values_make_no_histogram():
    def figures(n):
        finding = type("Finding", (), {"exact": True, "p_value": 0.5, "figure": None})
        verdict = type("Verdict", (), {"findings": [finding] * n, "resolution": None})
        case = type("Case", (), {"verdict": verdict, "expected": "not rejected", "status": "passed"})
        run = type("Run", (), {"cases": [case]})
        return {name for name, _, _ in page_module._overview(run)}

    assert figures(FEWEST - 1) == {"p-values"}
    assert figures(FEWEST) == {"p-values", "p-value-histogram"}


def test_a_p_value_too_small_for_a_number_is_not_called_0():
    assert "the smallest is < 1e-300;" in render(PValues((0.0, 0.4, 0.7)), "p").words


def test_p_values_that_chance_explains_do_not_lie_at_the_top_of_an_empty_picture():
    svg = render(PValues((0.2, 0.5, 0.8)), "p").svg
    assert "10⁻⁶" not in svg
