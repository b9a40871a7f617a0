"""Invariant: a free path is where the oracle says the optical depth is reached, in double and in single precision; its density
and its atoms add up, on every ray, and nothing in [0, 1) leads out of the domain.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import free_path, transmittance
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators import (
    AnalogFog,
    Constant,
    Exponential,
    FreePath,
    HomogeneousSpectralFreePath,
    Linear,
    TruncatedFreePath,
    Vanishing,
    along,
)
from fogproof.scene import ExponentialMedium, LinearMedium, Medium, OpenGLFog, Procedural, Ray, VoxelGrid

EPS = 2.0**-52
EPS32 = 2.0**-23
EDGES = np.array([[0.0], [5e-324], [0.5], [1 - 2.0**-53]])

sizes = st.floats(-9, 9).map(lambda e: 10.0**e)
signed = st.one_of(st.just(0.0), sizes, sizes.map(lambda x: -x))
moderate = st.floats(-3, 2).map(lambda e: 10.0**e)
media = st.one_of(
    sizes.map(lambda s: Medium(s, 0.0)),
    st.builds(lambda s, k: LinearMedium(s, (0, 0, k)), signed, signed),
    st.builds(lambda s, k: ExponentialMedium(s, (0, 0, k)), sizes, signed),
)
uniforms = st.floats(0, 1, exclude_max=True)
UP = Ray((0, 0, 0), (0, 0, 1))


@given(media, st.lists(uniforms, min_size=1, max_size=6))
@settings(deadline=None)
def test_the_depth_is_reached_where_the_oracle_says(medium, xi):
    depth = np.maximum(-np.log1p(-np.array(xi)), 1e-300)  # depth 0 is reached at once, but nothing collides in vacuum
    right = free_path(medium, UP, depth)
    t = along(medium, UP).reach(depth)
    sure = np.isfinite(right.error)  # on the verge of escaping the oracle does not commit itself
    finite = sure & np.isfinite(right.value)
    assert np.all(np.isinf(t[sure & np.isinf(right.value)]))
    assert np.all(np.abs(t[finite] - right.value[finite]) <= 4 * right.error[finite] + 8 * EPS * right.value[finite])


@given(media, st.lists(st.floats(-6, 6).map(lambda e: 10.0**e), min_size=1, max_size=6))
@settings(deadline=None)
def test_the_optical_depth_is_the_oracles(medium, t):
    t = np.array(t)
    right = transmittance(medium, Ray((0, 0, 0), (0, 0, 1), t))
    got = np.exp(-along(medium, UP).depth(t))
    assert np.all(
        np.abs(got - right.value) <= right.error + 64 * EPS * right.value * (1 - np.log(right.value + 1e-300))
    )


@given(
    st.one_of(
        moderate.map(Constant),
        st.builds(Linear, moderate, st.floats(-1, 1)),
        st.builds(Exponential, moderate, st.floats(-1, 1)),
        st.builds(lambda a, b: Vanishing(a, a + b), moderate, moderate),
    ),
    st.lists(st.floats(0, 1 - 2.0**-20), min_size=1, max_size=6),
)
@settings(deadline=None)
def test_single_precision_has_its_own_bound(extinction, xi):
    """A relative error of 4 eps in the optical depth, and 8 eps in what is made of it."""
    xi = np.array(xi, dtype=np.float32)
    depth = -np.log1p(-xi)
    got = extinction.reach(depth)
    assert got.dtype == np.float32
    exact = -np.log1p(-xi.astype(np.float64))
    low, high = (extinction.reach(exact * (1 + s)) for s in (-4 * EPS32, 4 * EPS32))
    scale = max(extinction.end, 0.0) if isinstance(extinction, Vanishing) else 0.0
    bend = {Linear: lambda e: 2 * e.slope / e.sigma_0**2, Exponential: lambda e: e.rate / e.sigma_0}
    condition = 1 + np.abs(bend.get(type(extinction), lambda e: 0.0)(extinction)) * exact
    escaping = ~(high < 1.01 * low + 1e-30)  # where the path all but escapes, the distance reacts more than linearly
    with np.errstate(invalid="ignore"):
        slack = 8 * EPS32 * (condition * high + scale) + 1e-37  # below that, single precision is denormal
        assert np.all(escaping | ((got >= low - slack) & (got <= high + slack)))


@given(media, st.one_of(st.just(math.inf), sizes))
@settings(deadline=None)
def test_edges_lead_to_points_of_the_domain(medium, surface):
    path = FreePath(along(medium, UP), surface)
    draw = path.sample(EDGES)
    assert np.all((draw.x >= 0) & (draw.x <= surface))
    assert np.all(draw.pdf >= 0)
    assert np.all((draw.event == 1) == (draw.x == surface))
    assert np.all(draw.pdf[draw.event == 1] == path.atoms.get(surface, 0.0))


@given(st.lists(st.one_of(st.just(0.0), moderate), min_size=1, max_size=4), st.one_of(st.just(math.inf), moderate))
@settings(deadline=None)
def test_channels_share_one_density(sigma_t, surface):
    path = HomogeneousSpectralFreePath(tuple(sigma_t), surface)
    u = np.random.default_rng(7).random((200, 2))
    draw = path.sample(u)
    alone = [FreePath(s, surface) for s in sigma_t]
    inside = draw.event == 0
    mean = np.mean([p.pdf(draw.x[inside]) for p in alone], axis=0)
    assert np.allclose(draw.pdf[inside], mean, rtol=1e-14)
    reached = np.mean([p.atoms.get(surface, 0.0) for p in alone])
    assert np.allclose(draw.pdf[~inside], reached, rtol=1e-14)
    # One sample's balance heuristic bounds every weight: sigma_i w_i by the channels' number.
    assert np.all(draw.weight[inside] * np.array(sigma_t) <= len(sigma_t) * (1 + 1e-12))


def test_a_truncated_path_is_uniform_in_the_thin_limit():
    u = np.linspace(0, 1, 11, endpoint=False)[:, None]
    for sigma in (1e-300, 1e-20, 1e-12):
        assert np.allclose(TruncatedFreePath(sigma, 3.0).sample(u).x, 3.0 * u[:, 0], rtol=1e-11)


@pytest.mark.parametrize("extinction", [0.0, Constant(0.0), Linear(-2.0, 0.1), Vanishing(5.0, 9.0)])
def test_a_path_that_cannot_collide_is_not_truncated(extinction):
    with pytest.raises(InvalidValueError, match="vanish"):
        TruncatedFreePath(extinction, 3.0)


@pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf])
def test_bad_extinctions_are_refused(bad):
    with pytest.raises(InvalidValueError):
        FreePath(bad)
    with pytest.raises(InvalidValueError):
        HomogeneousSpectralFreePath((1.0, bad))


@pytest.mark.parametrize("surface", [0.0, -1.0, math.nan])
def test_bad_surfaces_are_refused(surface):
    with pytest.raises(InvalidValueError, match="surface"):
        FreePath(1.0, surface)


def test_nobody_ever_collides_in_vacuum():
    path = FreePath(0.0)
    assert path.atoms == {math.inf: 1.0}
    draw = path.sample(EDGES)
    assert np.all(np.isinf(draw.x))
    assert np.all(draw.pdf == 1)


def test_rays_and_media_without_a_closed_form_are_refused():
    grid = VoxelGrid(np.ones((2, 2, 2)), (0, 0, 0), (1, 1, 1))
    for medium in (grid, Procedural(lambda x: np.ones(x.shape[:-1]), 1.0)):
        with pytest.raises(UnsupportedError, match="track"):
            FreePath(along(medium, Ray((0, 0, 0), (0, 0, 1), 1.0)), 1.0).sample(EDGES)
    with pytest.raises(UnsupportedError, match="eye"):
        along(OpenGLFog("exp"), Ray((0, 0, 1), (0, 0, 1)))
    with pytest.raises(UnsupportedError, match="batch"):
        along(Medium(1.0, 0.0), Ray(np.zeros((2, 3)), (0, 0, 1)))
    with pytest.raises(UnsupportedError, match="channels"):
        AnalogFog(Medium((1.0, 2.0), 0.0), UP, 1.0, 0.0).draw(np.random.default_rng(), 10)
