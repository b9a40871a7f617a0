"""Where charts put a point: up is more, and decades are equally wide."""

import numpy as np
import pytest

from fogproof.reports.charts.axes import Axes
from fogproof.reports.charts.scale import Scale, spanning
from fogproof.reports.charts.sheet import Sheet


def test_y_grows_upwards_and_x_to_the_right():
    axes = Axes(Sheet(200, 150, "white"), (20, 10, 100, 80), Scale(0, 4), Scale(-1, 1))
    assert axes.at([0, 4, 1], [-1, 1, 0.5]) == [(20, 90), (120, 10), (45, 30)]


@pytest.mark.parametrize(
    ("scale", "values", "places"),
    [
        (Scale(1, 1000, True), [1, 10, 100, 1000], [0, 1 / 3, 2 / 3, 1]),
        (Scale(1, 1001), [1, 11, 501, 1001], [0, 0.01, 0.5, 1]),
    ],
)
def test_places_on_a_scale(scale, values, places):
    assert np.allclose(scale(values), places, rtol=0, atol=1e-15)


def test_what_a_logarithm_does_not_know_is_no_place():
    assert np.isneginf(Scale(1, 10, True)([0.0])).all()
    assert np.isnan(Scale(1, 10, True)([-1.0])).all()
    around = spanning([-1.0, 0.0, 1e-3, 1e3, np.inf], log=True)
    assert 0 < around.low < 1e-3 < 1e3 < around.high < np.inf
