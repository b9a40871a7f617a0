"""Names beside curves stay inside the picture, and axes leave room for their ticks, whatever they are."""

import re

import numpy as np
import pytest

from fogproof.reports.charts.convergence import Convergence, ErrorCurve
from fogproof.reports.charts.pictures import render
from fogproof.reports.charts.scale import spanning
from fogproof.reports.charts.sheet import FONT_SIZE
from fogproof.reports.charts.sheet_png import text_width


def drawn(error, name="a"):
    effort = tuple(10.0 ** np.arange(len(error)))
    same = tuple(error)
    curve = ErrorCurve(name, 0, effort, same, same, same, (float("nan"),) * len(error))
    drawing = Convergence("samples", "relative root mean square error", (curve,), 0.99)
    return render(drawing, "c", drawing.size)


def words(picture):
    """Return (x, anchor, turned, text) of every text."""
    found = re.findall(r"<text ([^>]*)>([^<]+)<", picture.svg)
    return [(look, text) for look, text in found]


@pytest.mark.parametrize("name", ["W" * 200, "x" * 200, "Mixed Weights With Wide Words " * 6])
def test_a_long_name_stays_inside_the_picture(name):
    picture = drawn((0.1, 0.01), name)
    for look, text in words(picture):
        x = float(re.search(r'x="([\d.]+)"', look)[1])
        if "text-anchor" not in look:
            assert x + text_width(text, FONT_SIZE) <= 700


@pytest.mark.parametrize("error", [(2.05e-9, 2.1e-9), (1.234e-7, 1.235e-7), (0.1, 0.01)])
def test_ticks_do_not_lie_over_the_name_of_their_axis(error):
    picture = drawn(error)
    (title,) = (look for look, text in words(picture) if text == "relative root mean square error")
    middle = float(
        re.search(r"rotate\(-90 ([\d.]+)", title)[1] if "rotate" in title else re.search(r'x="([\d.]+)"', title)[1]
    )
    ends = [
        float(re.search(r'x="([\d.]+)"', look)[1]) - text_width(text, FONT_SIZE)
        for look, text in words(picture)
        if 'text-anchor="end"' in look
    ]
    assert ends
    assert min(ends) >= middle


def test_errors_that_hardly_differ_do_not_fill_the_picture():
    """A per mille of noise is no fall."""
    ticks = [text for look, text in words(drawn((0.1000, 0.1001))) if 'text-anchor="end"' in look]
    assert len(ticks) >= 2
    assert all(re.fullmatch(r"0\.\d|0\.0\d", tick) for tick in ticks)


@pytest.mark.parametrize("low", [0.126, 0.3, 0.9, 0.011])
def test_a_logarithmic_axis_has_three_ticks_or_more(low):
    assert len(spanning([low, 8.9, 10.5], log=True).ticks(6)) >= 3
