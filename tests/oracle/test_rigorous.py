"""Invariant: what ball arithmetic proves lies inside [value - error, value + error] of the ordinary answer, for every
medium, quantity and phase function; and the golden tables are what the committed script makes."""

import json
import math
import sys
from fractions import Fraction
from pathlib import Path

import airlight_truth
import make_golden
import media_truth as truth
import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from media_truth import exact, within
from test_radiance_three_ways import MEDIA, RAYS

from fogproof.analytic import (
    airlight_integral,
    ambient_fog,
    emitted_radiance,
    optical_thickness,
    transmittance,
)
from fogproof.analytic.proven.golden import golden_values
from fogproof.errors import NotInstalledError, UnsupportedError
from fogproof.oracle import answer
from fogproof.scene import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    LinearMedium,
    Medium,
    Mie,
    Mixture,
    Murky,
    Procedural,
    Ray,
    Rayleigh,
    Schlick,
    VoxelGrid,
)

PROVABLE = {name: medium for name, medium in MEDIA.items() if not isinstance(medium, Procedural)}
QUANTITIES = {
    "optical thickness": optical_thickness,
    "transmittance": transmittance,
    "fog": lambda medium, ray, **how: ambient_fog(medium, ray, 1.5, 0.25, **how),
    "coloured fog": lambda medium, ray, **how: ambient_fog(medium, ray, (1.5, 0.0, 3.0), 0.25, **how),
    "emission": emitted_radiance,
    "emission per volume": lambda medium, ray, **how: emitted_radiance(medium, ray, times_sigma_a=False, **how),
}


def contains(ordinary, proven):
    """The ordinary interval contains the whole proven one, in exact arithmetic."""
    assert ordinary.value.shape == proven.value.shape == proven.error.shape
    for o, e, p, r in zip(
        *(x.ravel() for x in (ordinary.value, ordinary.error, proven.value, proven.error)), strict=True
    ):
        if math.isinf(p) or math.isinf(e):
            assert o == p or e == math.inf
        else:
            assert abs(Fraction(o) - Fraction(p)) + Fraction(r) <= Fraction(e)


def is_tight(proven):
    """At most half a unit in the last place, and the bound's own rounding."""
    finite = np.isfinite(proven.value)
    assert (proven.error[finite] <= 0.51 * np.spacing(np.abs(proven.value[finite]))).all()


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("name", PROVABLE)
def test_every_medium(name, quantity):
    medium, ask = PROVABLE[name], QUANTITIES[quantity]
    if quantity == "coloured fog" and medium.channels not in (None, 3):
        ask = QUANTITIES["fog"]
    proven = ask(medium, RAYS, rigorous=True)
    contains(ask(medium, RAYS), proven)
    is_tight(proven)


seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=30, deadline=None)
@given(seeds)
@example(2814)  # what absorbs has a small share, next to a plane
def test_random_voxels(seed):
    rng = np.random.default_rng(seed)
    shape = rng.integers(1, 5, size=3)
    cells = {name: rng.random(shape) * (rng.random(shape) < 0.8) for name in ("sigma_t", "albedo", "emission")}
    cells["sigma_t"] = cells["sigma_t"] * 10.0 ** rng.uniform(-9, 2)
    w = rng.normal(size=(4, 3))
    ray = Ray(2 * rng.normal(size=3), w / np.linalg.norm(w, axis=-1, keepdims=True), [0.1, 2.0, 30.0, np.inf])
    for interpolation in ("nearest", "trilinear"):
        grid = VoxelGrid(lower=(-1, -1, -1), upper=(1, 1, 1), interpolation=interpolation, **cells)
        for ask in QUANTITIES.values():
            contains(ask(grid, ray), ask(grid, ray, rigorous=True))


@settings(max_examples=50, deadline=None)
@given(
    st.floats(-300, 8),
    st.floats(-300, 8),
    st.one_of(st.just(np.inf), st.floats(-300, 300).map(lambda x: 10.0**x)),
    st.floats(0, 9),
)
def test_homogeneous_extremes(log_a, log_s, s, emission):
    medium, ray = Medium(10.0**log_a, 10.0**log_s, emission=emission), Ray((0, 0, 0), (0, 0, 1), s)
    for ask in QUANTITIES.values():
        contains(ask(medium, ray), ask(medium, ray, rigorous=True))
    proven = ambient_fog(medium, ray, 1.5, 0.25, rigorous=True)
    within(proven, truth.fog(10.0**log_a, 10.0**log_s, emission, s, 1.5, 0.25))


def test_infinite_rays_through_graded_media():
    rays = Ray((0, 0, 0), [(0, 0, 1), (0, 0, -1), (1, 0, 0)])
    for medium in (LinearMedium(1.0, (0, 0, -0.5), 0.5, emission=1.0), PROVABLE["exponential"]):
        for ask in (optical_thickness, transmittance, emitted_radiance):
            contains(ask(medium, rays), ask(medium, rays, rigorous=True))


PHASES = [
    Isotropic(),
    HenyeyGreenstein(0.9999),
    HenyeyGreenstein(-0.6),
    DoubleHenyeyGreenstein(0.9, -0.3, 0.25),
    Schlick(0.8),
    Hazy(),
    Murky(),
    Rayleigh(),
    CornetteShanks(0.7),
    Draine(-0.4, 2.5),
    Mixture((Isotropic(), Mixture((Hazy(), Rayleigh()), (0.5, 0.5))), (0.25, 0.75)),
]


@pytest.mark.parametrize("phase", PHASES, ids=repr)
@settings(max_examples=5, deadline=None)
@given(
    st.floats(-9, 2.4).map(lambda x: 10.0**x),
    st.one_of(st.just(0.0), st.floats(-12, 1.4).map(lambda x: 10.0**x)),
    st.floats(-5, 5),
    st.one_of(st.just(np.inf), st.floats(1e-6, 10)),
)
def test_airlight(phase, sigma_t, h, a, length):
    """Contained in the ordinary answer, and containing the truth found by quite another formula."""
    b = a + length
    proven = airlight_integral(sigma_t, h, a, b, phase, rigorous=True)
    contains(airlight_integral(sigma_t, h, a, b, phase), proven)
    if h > 0 or a > 0 or b < 0:
        expected = airlight_truth.airlight(sigma_t, h, a, b, phase)
        with mp.workprec(200):
            assert abs(exact(proven.value) - expected) <= exact(proven.error) + mp.mpf(2) ** -80 * expected


def test_airlight_broadcasts_and_knows_its_limits():
    proven = airlight_integral([[0.1], [1.0]], 0.5, -1.0, [0.0, 1.0, np.inf], rigorous=True)
    contains(airlight_integral([[0.1], [1.0]], 0.5, -1.0, [0.0, 1.0, np.inf]), proven)
    assert proven.value.shape == (2, 3)
    assert airlight_integral(1.0, 0.5, 2.0, 2.0, rigorous=True).value == 0
    assert airlight_integral(1.0, 0.0, -1.0, 2.0, rigorous=True).value == np.inf
    with pytest.raises(UnsupportedError, match="rigorous"):
        airlight_integral(1.0, 1.0, -1.0, 1.0, Mie(1e-6, 5e-7, 1.33), rigorous=True)


def test_a_user_function_is_refused():
    with pytest.raises(UnsupportedError, match="user's function"):
        transmittance(MEDIA["procedural"], RAYS, rigorous=True)


def test_without_python_flint_the_install_line_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(NotInstalledError, match=r"fogproof\[rigorous\]"):
        transmittance(Medium(0.1, 0.2), RAYS, rigorous=True)


def interval(golden):
    value, radius = Fraction(golden.value), Fraction(golden.radius)
    return value - radius, value + radius


@pytest.mark.parametrize("quantity", sorted({golden.request["quantity"] for golden in golden_values()}))
def test_golden_values_lie_in_the_ordinary_interval(quantity):
    entries = [golden for golden in golden_values() if golden.request["quantity"] == quantity]
    assert len(entries) >= 15
    for golden in entries:
        found = answer(golden.request)
        value, error = float(found["value"]), float(found["error"])
        if golden.value == "inf":
            assert value == math.inf
            continue
        low, high = interval(golden)
        assert Fraction(value) - Fraction(error) <= low, golden
        assert high <= Fraction(value) + Fraction(error), golden
        assert high - low <= Fraction(1, 10**36) * abs(high)


def shipped():
    return json.loads((Path(__file__).parents[2] / "analytic" / "proven" / "golden.json").read_text())["values"]


def test_golden_tables_are_made_by_the_committed_script():
    """Every question; every ninth answer here, all of them by `make golden`."""
    questions, answers = list(make_golden.requests()), shipped()
    assert questions == [old["request"] for old in answers]
    for old in answers[::9]:
        new = make_golden.entry(old["request"])
        assert make_golden.same(new, old), (new, old)


def test_a_changed_digit_would_be_noticed():
    old = shipped()[5]
    digits = old["value"]
    changed = {**old, "value": digits[:20] + str((int(digits[20]) + 1) % 10) + digits[21:]}
    assert make_golden.same(old, dict(old))
    assert not make_golden.same(old, changed)
