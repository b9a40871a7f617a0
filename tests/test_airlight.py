"""Invariant: |value - truth| <= error for the airlight integral, and error <= 1e-14 value until it underflows, over
every scale of extinction, distance and length, for lights before, beside and behind the camera and for |g| <= .9999.

The truth is ball arithmetic by other formulas (`airlight_truth`), and the table of high-precision values.
"""

import json
import math
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from airlight_truth import airlight
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import within

from fogproof.analytic import airlight_integral
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein, Isotropic, Rayleigh

TABLE = json.loads((Path(__file__).parent / "data" / "reference-values.json").read_text())["single_scattering"]
KINDS = {"isotropic": lambda g: Isotropic(), "hg": HenyeyGreenstein, "rayleigh": lambda g: Rayleigh()}
KNOWN = [row for row in TABLE if row["phase"] in KINDS]


def powers(low, high):
    return st.floats(low, high).map(lambda e: 10.0**e)


asymmetries = st.one_of(
    st.floats(-0.9999, 0.9999), powers(-4, 0).map(lambda d: 1 - d), powers(-4, 0).map(lambda d: d - 1)
).filter(lambda g: abs(g) <= 0.9999)
phases = st.one_of(st.just(Isotropic()), st.just(Rayleigh()), asymmetries.map(HenyeyGreenstein))


@st.composite
def segments(draw):
    """(sigma_t, h, a, b): the hard ensemble; the attenuation to the light is at most e^-645."""
    h = draw(powers(-12, 1.5))
    near = st.one_of(powers(-6, 2), powers(-1, 2).map(lambda x: x * h))
    a = draw(near) * draw(st.sampled_from([-1, -1, 1]))
    b = draw(st.one_of(st.just(math.inf), near.map(lambda x: a + x), near.filter(lambda x: x > a)))
    sigma = draw(st.one_of(powers(-9, 2.5), st.just(0.0)))
    return min(sigma, 645 / math.hypot(a, h)), h, a, max(a, b)


@pytest.mark.parametrize("row", KNOWN, ids=lambda r: f"{r['phase']}-{r['sigma_t']}-{r['h']}-{r['a']}-{r['b']}")
def test_table_of_known_values(row):
    phase = KINDS[row["phase"]](row.get("g_or_k"))
    reference = airlight_integral(row["sigma_t"], row["h"], row["a"], float(row["b"]), phase)
    with mp.workdps(40):
        assert within(reference, mp.mpf(row["I"])) <= 1e-14


@given(segments(), phases)
@settings(max_examples=300, deadline=None)
def test_hard_cases(segment, phase):
    sigma, h, a, b = segment
    reference = airlight_integral(sigma, h, a, b, phase)
    within(reference, airlight(sigma, h, a, b, phase))
    assert reference.error <= 1e-14 * reference.value + 1e-300
    assert reference.value > 0 or a == b


@given(powers(-9, 2.5), powers(-6, 2), powers(-6, 2), st.booleans(), st.booleans(), phases)
@settings(max_examples=60, deadline=None)
def test_light_on_the_line_but_not_on_the_segment(sigma, distance, length, behind, endless, phase):
    sigma = min(sigma, 300 / (distance + length))
    if behind:
        a, b = distance, math.inf if endless else distance + length
    else:
        a, b = -distance - length, -distance
    within(airlight_integral(sigma, 0.0, a, b, phase), airlight(sigma, 0.0, a, b, phase))


@pytest.mark.parametrize(("a", "b"), [(-1.0, 1.0), (-1.0, 0.0), (0.0, 1.0), (-1.0, math.inf), (0.0, math.inf)])
@pytest.mark.parametrize("sigma", [0.0, 1.0])
def test_light_on_the_segment_is_infinite(sigma, a, b):
    reference = airlight_integral(sigma, 0.0, a, b)
    assert reference.value == math.inf
    assert reference.error == 0


@pytest.mark.parametrize(
    ("sigma", "h", "a", "b", "truth"),
    [
        (0.0, 1.0, -2.0, math.inf, mp.pi / 2 + mp.atan(2)),
        (0.0, 1.0, -math.pi, math.pi, 2 * mp.atan(mp.mpf(math.pi))),
        (0.0, 0.0, 3.0, math.inf, mp.mpf(1) / 3),
        (0.0, 0.0, -4.0, -2.0, mp.mpf(1) / 4),
        (0.0, 1e-200, 1.0, 2.0, mp.mpf(1) / 2),
        (1.0, 1e-200, -2.0, -1.0, mp.exp(-2) / 2),
        (1e-300, 1e200, 0.0, 1e200, mp.atan(1) / mp.mpf(1e200)),
        (2.0, 1.0, 3.0, 3.0, mp.mpf(0)),
        (1.0, 0.0, 0.0, 0.0, mp.mpf(0)),
        (1e4, 1.0, -1.0, 1.0, mp.mpf(0)),
        (1e308, 1e308, -1e308, math.inf, mp.mpf(0)),
    ],
)
def test_extreme_and_empty_segments(sigma, h, a, b, truth):
    with mp.workdps(40):
        within(airlight_integral(sigma, h, a, b), truth)


def test_nearly_on_the_light_where_the_attenuation_alone_would_underflow():
    within(airlight_integral(1000.0, 1e-290, -0.8, 0.3), airlight(1000.0, 1e-290, -0.8, 0.3))


def test_broadcasting_equals_one_by_one():
    rng = np.random.default_rng(20240611)
    sigma, a = 10.0 ** rng.uniform(-3, 1, (40, 1)), rng.uniform(-9, 9, 60)
    together = airlight_integral(sigma, 0.3, a, a + 4, HenyeyGreenstein(0.9))
    assert together.value.shape == together.error.shape == (40, 60)
    for i, j in [(0, 0), (7, 59), (39, 31)]:
        alone = airlight_integral(sigma[i, 0], 0.3, a[j], a[j] + 4, HenyeyGreenstein(0.9))
        assert alone.value.shape == ()
        assert abs(alone.value - together.value[i, j]) <= 1e-15 * alone.value
    assert airlight_integral(np.ones((0, 3)), 1.0, 0.0, 1.0).value.shape == (0, 3)


def test_segments_add_up_once_the_attenuation_between_them_is_counted():
    whole = airlight_integral(0.7, 0.2, -2.0, 5.0)
    first, second = airlight_integral(0.7, 0.2, -2.0, 0.5), airlight_integral(0.7, 0.2, 0.5, 5.0)
    joined = first.value + math.exp(-0.7 * 2.5) * second.value
    assert abs(joined - whole.value) <= whole.error + first.error + 2 * second.error + 4e-16 * joined


@pytest.mark.parametrize(
    ("arguments", "argument", "got"),
    [
        ((-0.1, 1.0, 0.0, 1.0), "sigma_t", "-0.1"),
        ((math.inf, 1.0, 0.0, 1.0), "sigma_t", "inf"),
        ((1.0, -1.0, 0.0, 1.0), "h", "-1.0"),
        ((1.0, math.nan, 0.0, 1.0), "h", "nan"),
        ((1.0, 1.0, -math.inf, 1.0), "a", "-inf"),
        ((1.0, 1.0, [0.0, 2.0], 1.0), "b", "1.0"),
        ((1.0, 1.0, 0.0, math.nan), "b", "nan"),
        (("thick", 1.0, 0.0, 1.0), "sigma_t", "thick"),
        (([1.0, 2.0], [1.0, 2.0, 3.0], 0.0, 1.0), "sigma_t", "broadcast"),
    ],
)
def test_bad_input_names_the_argument_and_the_value(arguments, argument, got):
    with pytest.raises(InvalidValueError, match=argument) as caught:
        airlight_integral(*arguments)
    assert caught.value.argument == argument
    assert got in str(caught.value)
