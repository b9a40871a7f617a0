"""Invariant: |value - truth| <= error for the airlight integral, and error <= 1e-14 value until it underflows, over
every scale of extinction, distance and length, for lights before, beside and behind the camera and for |g| <= .9999
(isotropic, Henyey-Greenstein, Schlick, Rayleigh; a few times that for the others).

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

from fogproof.analytic import airlight_integral, airlight_table, phase_pdf
from fogproof.errors import InvalidValueError
from fogproof.scene import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mie,
    Mixture,
    Murky,
    Rayleigh,
    Schlick,
    Tabulated,
)

TABLE = json.loads((Path(__file__).parents[1] / "data" / "reference-values.json").read_text())["single_scattering"]
KINDS = {
    "isotropic": lambda g: Isotropic(),
    "hg": HenyeyGreenstein,
    "rayleigh": lambda g: Rayleigh(),
    "schlick": Schlick,
    "hazy": lambda g: Hazy(),
}


def powers(low, high):
    return st.floats(low, high).map(lambda e: 10.0**e)


asymmetries = st.one_of(
    st.floats(-0.9999, 0.9999), powers(-4, 0).map(lambda d: 1 - d), powers(-4, 0).map(lambda d: d - 1)
).filter(lambda g: abs(g) <= 0.9999)
phases = st.one_of(
    st.just(Isotropic()), st.just(Rayleigh()), asymmetries.map(HenyeyGreenstein), asymmetries.map(Schlick)
)
other_phases = st.one_of(
    st.just(Hazy()),
    st.just(Murky()),
    asymmetries.map(CornetteShanks),
    st.builds(Draine, asymmetries, powers(-3, 3)),
    st.builds(DoubleHenyeyGreenstein, asymmetries, asymmetries, st.floats(0, 1)),
    asymmetries.map(lambda g: Mixture((Murky(), HenyeyGreenstein(g), Rayleigh()), (0.25, 0.25, 0.5))),
)


@st.composite
def segments(draw):
    """(sigma_t, h, a, b): the hard ensemble; the attenuation to the light is at most e^-645."""
    h = draw(powers(-12, 1.5))
    near = st.one_of(powers(-6, 2), powers(-1, 2).map(lambda x: x * h))
    a = draw(near) * draw(st.sampled_from([-1, -1, 1]))
    b = draw(st.one_of(st.just(math.inf), near.map(lambda x: a + x), near.filter(lambda x: x > a)))
    sigma = draw(st.one_of(powers(-9, 2.5), st.just(0.0)))
    return min(sigma, 645 / math.hypot(a, h)), h, a, max(a, b)


@pytest.mark.parametrize("row", TABLE, ids=lambda r: f"{r['phase']}-{r['sigma_t']}-{r['h']}-{r['a']}-{r['b']}")
def test_table_of_known_values(row):
    phase = KINDS[row["phase"]](row.get("g_or_k"))
    reference = airlight_integral(row["sigma_t"], row["h"], row["a"], float(row["b"]), phase)
    with mp.workdps(40):
        assert within(reference, mp.mpf(row["I"])) <= 1e-14


@pytest.mark.parametrize("end", [1.0, 10.0, 25.5, 25.6, 30.0, 1e3, math.inf])
@pytest.mark.parametrize("g", [-0.9999, -0.97, -0.5, 0.5, 0.97, 0.9999])
def test_a_ray_that_ends_in_the_peak_of_the_phase_function(g, end):
    """The edges of the quadrature's panels matter to their last digit where the integrand ends at its largest."""
    h = 10.0**-10.75
    phase = HenyeyGreenstein(g)
    within(airlight_integral(0.0, h, -100.0, end * h, phase), airlight(0.0, h, -100.0, end * h, phase))


@given(segments(), phases)
@settings(max_examples=300, deadline=None)
def test_hard_cases(segment, phase):
    sigma, h, a, b = segment
    reference = airlight_integral(sigma, h, a, b, phase)
    within(reference, airlight(sigma, h, a, b, phase))
    assert reference.error <= 1e-14 * reference.value + 1e-300
    assert reference.value > 0 or a == b


@given(segments(), other_phases)
@settings(max_examples=100, deadline=None)
def test_hard_cases_of_other_phase_functions(segment, phase):
    sigma, h, a, b = segment
    reference = airlight_integral(sigma, h, a, b, phase)
    within(reference, airlight(sigma, h, a, b, phase))
    assert reference.error <= 3e-14 * reference.value + 1e-300


def test_a_table_is_integrated_between_its_kinks():
    """A table of a linear phase function is that function; one with a gap leaves the light of its directions out."""
    grid = np.linspace(-1, 1, 101)
    linear = Tabulated(tuple(grid), tuple((1 + 0.5 * grid) / (4 * np.pi)))
    reference = airlight_integral(0.3, [0.1, 1e-9, 2.0], -3.0, [4.0, np.inf, -2.9], linear)
    for i, (h, b) in enumerate([(0.1, 4.0), (1e-9, np.inf), (2.0, -2.9)]):
        flat, mean = airlight(0.3, h, -3.0, b), airlight(0.3, h, -3.0, b, "mu")
        within(reference, flat + mean / 2, i)
    assert np.all(reference.error <= 1e-12 * reference.value)

    tent = Tabulated.normalised((-1, 0, 0.5, 1), (0, 0, 1, 0))
    assert airlight_integral(0.3, 1.0, 0.5, 9.0, tent).value == 0  # only backward directions
    reference = airlight_integral(0.3, 1.0, -5.0, 9.0, tent)
    with mp.workdps(30):  # F = 8 mu up to 1/2, 8 (1 - mu) beyond; mu = 1/2 at t = -1/sqrt(3), 0 at t = 0
        a, knee, sigma = mp.mpf(-5), -1 / mp.sqrt(3), mp.mpf(0.3)

        def piece(t):
            r = mp.sqrt(t * t + 1)
            F = 8 * min(-t / r, 1 + t / r)
            return mp.exp(-sigma * (t - a + r)) / r**2 * F

        within(reference, mp.quad(piece, [a, -3, knee]) + mp.quad(piece, [knee, 0]))


def test_a_water_drop():
    """Lorenz-Mie, 10 um: against 2000 Gauss-Legendre nodes in the angle seen from the light."""
    pytest.importorskip("miepython", reason="python -m pip install 'fogproof[mie]'")
    drop, sigma, a, b = Mie(10e-6, 550e-9, 1.33), 0.3, -5.0, 5.0
    reference = airlight_integral(sigma, 1.0, a, b, drop)
    x, weights = np.polynomial.legendre.leggauss(2000)
    theta = math.atan(5.0) * x
    way = np.tan(theta) + 1 / np.cos(theta) - a
    f = np.exp(-sigma * way) * 4 * np.pi * phase_pdf(drop, -np.sin(theta)).value
    other = math.atan(5.0) * float(weights @ f)
    assert abs(other - reference.value) <= reference.error + 1e-12 * other
    assert reference.error <= 1e-12 * reference.value


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


def test_tables_are_the_same_numbers_in_one_call():
    h, a, b = [0.1, 1.0], [-2.0, -1.0, 0.5], [-1.5, 0.0, 1.0, math.inf]
    table = airlight_table(0.7, h, a, b, Schlick(0.5))
    assert table.value.shape == table.error.shape == (2, 3, 4)
    assert np.isnan(table.value[:, 1, 0]).all()
    assert np.isnan(table.value[:, 2, 1]).all()
    alone = airlight_integral(0.7, 1.0, -2.0, math.inf, Schlick(0.5)).value
    assert abs(table.value[1, 0, 3] - alone) <= 1e-15 * alone


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
