"""Invariant: scattered directions are the exact images of their uniforms to a few eps, at every parameter and at the poles, in
double and in single precision; values agree with the oracle, frames lose nothing, and no uniform in [0, 1) breaks a sampler.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import phase_pdf, phase_quantile
from fogproof.errors import UnsupportedError
from fogproof.estimators import Cosines, Directions, phase_table, phase_value
from fogproof.estimators.phase.frames import turn
from fogproof.estimators.phase.functions import cosines, density, polar
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

EPS = 2.0**-52
EPS32 = 2.0**-23
EDGES = np.array([0.0, 5e-324, 0.5, 1 - 2.0**-53])

asymmetries = st.one_of(
    st.floats(-0.9999, 0.9999), st.floats(-16, 0).map(lambda e: 0.99 * 10.0**e), st.sampled_from([0.0, -0.0, 0.9999])
)
uniforms = st.one_of(
    st.floats(0, 1, exclude_max=True), st.floats(2.0**-53, 1).map(lambda d: 1 - d), st.sampled_from(EDGES.tolist())
)
alphas = st.one_of(st.floats(0, 3), st.floats(-6, 6).map(lambda e: 10.0**e))


@st.composite
def tables(draw):
    inner = draw(st.lists(st.floats(-0.99, 0.99), unique=True, max_size=6))
    cosines = [-1.0, *sorted(inner), 1.0]
    values = draw(st.lists(st.floats(0.01, 100), min_size=len(cosines), max_size=len(cosines)))
    return Tabulated.normalised(cosines, values)


inverted = st.one_of(
    st.just(Isotropic()),
    st.just(Rayleigh()),
    asymmetries.map(HenyeyGreenstein),
    asymmetries.map(Schlick),
    asymmetries.map(CornetteShanks),
    st.builds(Draine, asymmetries, alphas),
    tables(),
)
"""Those whose sampler inverts the cdf of mu."""

chosen = st.one_of(
    st.just(Hazy()),
    st.just(Murky()),
    st.builds(DoubleHenyeyGreenstein, asymmetries, asymmetries, st.floats(0, 1)),
    st.builds(lambda a, b, w: Mixture((a, b), (w, 1 - w)), inverted, inverted, st.floats(0, 1)),
)
"""Those that choose a lobe first."""

axes = st.one_of(
    st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: math.hypot(*v) > 0.1),
    st.tuples(st.floats(-1e-7, 1e-7), st.floats(-1e-7, 1e-7), st.sampled_from([-1.0, 1.0])),
    st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]),
).map(lambda v: tuple(x / math.hypot(*v) for x in v))


@given(inverted, st.lists(uniforms, min_size=1, max_size=8))
@settings(deadline=None)
def test_the_cosine_is_the_quantile(phase, xi):
    xi = np.array(xi)
    right = phase_quantile(phase, xi)
    angles = polar(phase, xi)
    alone = np.empty_like(xi)
    cosines(phase, xi, alone)
    for mu in (0.5 * (angles.coversine - angles.versine), alone):
        assert np.all(np.abs(mu - right.value) <= right.error + 10 * EPS)


@given(inverted, st.lists(uniforms, min_size=1, max_size=8))
@settings(deadline=None)
def test_single_precision_has_its_own_bound(phase, xi):
    """Where the cosine reacts to xi, that of a rounding of xi counts too: 1 - mu moves by d mu / d xi = 1/(2 pi f)."""
    xi = np.minimum(np.array(xi, dtype=np.float32), np.float32(1 - 2.0**-24))
    angles, wanted = polar(phase, xi), polar(phase, xi.astype(np.float64))
    assert {a.dtype for a in angles} == {np.dtype(np.float32)}
    response = 1 / (2 * np.pi * np.maximum(wanted.pdf, 1e-300))
    for got, right in zip(angles[:2], wanted[:2], strict=True):
        assert np.all(np.abs(got - right) <= np.minimum(EPS32 * (8 + 8 * response), 2))


@given(st.one_of(asymmetries.map(HenyeyGreenstein), asymmetries.map(Schlick), st.just(Rayleigh())), uniforms)
@settings(deadline=None)
def test_versines_keep_their_digits_at_the_poles(phase, xi):
    angles = polar(phase, np.array([xi]))
    with mp.workdps(1000):  # xi and g may be denormal
        x = mp.mpf(xi)
        match phase:
            case HenyeyGreenstein(g) if g != 0:
                g = mp.mpf(g)
                mu = (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * x)) ** 2) / (2 * g)
            case Schlick(k):
                k = mp.mpf(k)
                mu = (2 * x + k - 1) / (2 * k * x - k + 1)
            case Rayleigh():
                mu = 2 * mp.sinh(mp.asinh(4 * x - 2) / 3)
            case _:
                mu = 2 * x - 1
        for got, right in ((angles.versine[0], 1 - mu), (angles.coversine[0], 1 + mu)):
            assert abs(got - right) <= 16 * EPS * right + mp.mpf(10) ** -300


@given(st.one_of(inverted, chosen), st.lists(uniforms, min_size=1, max_size=8))
@settings(deadline=None)
def test_angles_are_angles_and_the_pdf_is_the_density(phase, xi):
    xi = np.append(np.array(xi), EDGES)
    angles = polar(phase, xi)
    assert np.all(angles.versine >= 0)
    assert np.all(angles.coversine >= 0)
    assert np.all(np.abs(angles.versine + angles.coversine - 2) <= 16 * EPS)
    right = density(phase, angles.versine, angles.coversine)
    if not isinstance(phase, Tabulated):
        assert np.all(np.abs(angles.pdf - right) <= 64 * EPS * right)


@given(st.one_of(inverted, chosen), st.lists(st.floats(-1, 1), min_size=1, max_size=8))
@settings(deadline=None)
def test_values_agree_with_the_oracle(phase, mu):
    mu = np.array(mu)
    right = phase_pdf(phase, mu)
    # A cosine is known to a few roundings of 1: what those change is no error.
    near = [phase_pdf(phase, np.clip(mu + s, -1, 1)) for s in (-4 * EPS, 4 * EPS)]
    slack = np.sum([np.abs(one.value - right.value) + one.error + right.error for one in near], axis=0)
    assert np.all(np.abs(phase_value(phase, mu) - right.value) <= right.error + slack + 64 * EPS * right.value)


@given(st.one_of(inverted, chosen), axes, st.lists(st.tuples(uniforms, uniforms), min_size=1, max_size=8))
@settings(deadline=None)
def test_directions_are_turned_without_loss(phase, axis, u):
    u = np.array(u)
    angles = polar(phase, u[:, 0])
    x = Directions(phase, axis).sample(u).x
    assert np.all(np.abs(np.linalg.norm(x, axis=-1) - 1) <= 16 * EPS)
    assert np.all(np.abs(x @ np.array(axis) - 0.5 * (angles.coversine - angles.versine)) <= 16 * EPS)
    sine = np.sqrt(angles.versine * angles.coversine)
    off_axis = np.linalg.norm(np.cross(x, axis), axis=-1)
    assert np.all(np.abs(off_axis - sine) <= 8 * EPS)


@given(axes, st.floats(0, 1, exclude_max=True))
def test_turning_keeps_angles(axis, u):
    """Four directions of one polar angle at right angles in azimuth stay so about any axis."""
    one = np.full(4, 1.0)
    x = turn(axis, one, one, (u + np.arange(4) / 4) % 1, np.empty((4, 3)))
    gram = x @ x.T
    assert np.all(np.abs(gram - [[1, 0, -1, 0], [0, 1, 0, -1], [-1, 0, 1, 0], [0, -1, 0, 1]]) <= 16 * EPS)


@pytest.mark.parametrize("weight", [1e-300, 1e-17, 1e-9])
def test_what_is_left_of_a_uniform_stays_below_one(weight):
    """A component of tiny weight is chosen by a few uniforms only; what is left of them is still a uniform in [0, 1)."""
    phase = Mixture((Isotropic(), Murky(), HenyeyGreenstein(0.9)), (1 - weight, weight / 2, weight / 2))
    for xi in (np.array([1 - 2.0**-53, 1 - weight, np.nextafter(1 - weight, 0)]), EDGES):
        angles = polar(phase, np.minimum(xi, 1 - 2.0**-53))
        assert np.all(np.isfinite(np.stack(angles)))
        assert np.all((angles.versine >= 0) & (angles.versine <= 2))


def test_a_batch_is_the_same_in_one_piece_or_in_many():
    u = np.random.default_rng().random((40_000, 2))
    for phase in (HenyeyGreenstein(0.3), CornetteShanks(0.8), Mixture((Hazy(), Rayleigh()), (0.5, 0.5))):
        whole = Directions(phase, (2 / 7, -3 / 7, 6 / 7)).sample(u)
        parts = [Directions(phase, (2 / 7, -3 / 7, 6 / 7)).sample(v) for v in np.array_split(u, 7)]
        assert np.array_equal(whole.x, np.concatenate([part.x for part in parts]))
        assert np.array_equal(Cosines(phase).sample(u[:1]).x, Cosines(phase).sample(u).x[:1])


@pytest.mark.parametrize(
    "sphere",
    [
        Mie(1e-7, 550e-9, 1.5),
        Mie(2e-6, 550e-9, complex(1.5, 1)),
        Mie(2e-5, 550e-9, 1.33),
        Mie(3e-6, 600e-9, 1.2, medium_index=1.33),
    ],
    ids=["small", "absorbing", "large", "bubble"],
)
def test_lorenz_mie_values_and_weights(sphere):
    pytest.importorskip("miepython")
    mu = np.linspace(-1, 1, 301)
    right = phase_pdf(sphere, mu)
    size = np.pi * sphere.diameter * sphere.medium_index / sphere.wavelength
    rounding = 1e-14 * (1 + size) * np.sqrt(right.value * right.value.max())
    assert np.all(np.abs(phase_value(sphere, mu) - right.value) <= right.error + rounding)
    draw = Directions(sphere).sample(np.random.default_rng().random((1000, 2)))
    exact, table = phase_pdf(sphere, draw.x[:, 2]), phase_pdf(phase_table(sphere), draw.x[:, 2])
    assert np.allclose(draw.weight, exact.value / table.value, rtol=1e-8)


def test_a_sphere_too_large_for_a_table_is_refused():
    with pytest.raises(UnsupportedError, match="size parameter"):
        Directions(Mie(1e-3, 550e-9, 1.33)).sample(np.zeros((1, 2)))
