"""Invariant: equiangular positions are where the angle says, to a few roundings of the angle and of the ends, in double and in
single precision; they stay on the segment, and their density is positive everywhere on it.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.errors import InvalidValueError
from fogproof.estimators import Equiangular

sizes = st.floats(-6, 3).map(lambda e: 10.0**e)
ends = st.one_of(st.just(0.0), sizes, sizes.map(lambda x: -x))
lengths = st.floats(-3, 4).map(lambda e: 10.0**e)
uniforms = st.one_of(
    st.floats(0, 1, exclude_max=True),
    st.floats(2.0**-53, 1).map(lambda d: 1 - d),
    st.sampled_from([0.0, 5e-324, 0.5, 1 - 2.0**-53]),
)


@given(sizes, ends, lengths, uniforms, st.sampled_from([np.float64, np.float32]))
@settings(deadline=None)
def test_positions_are_where_the_angle_says(h, a, length, u, kind):
    """The bound: 8 roundings of the angle, of both ends and of t itself."""
    sampler = Equiangular(h, a, a + length)
    u = min(kind(u), np.nextafter(kind(1), kind(0)))
    draw = sampler.sample(np.array([[u]]))
    assert draw.x.dtype == kind
    with mp.workdps(60):
        H, A, B = mp.mpf(h), mp.mpf(a), mp.mpf(a + length)
        start = mp.atan(A / H)
        t = H * mp.tan(start + (mp.atan(B / H) - start) * mp.mpf(float(u)))
        moved = (H * H + t * t) / H * mp.mpf(sampler.angle) + abs(A) + abs(B)
        assert abs(mp.mpf(float(draw.x[0])) - t) <= 8 * mp.mpf(float(np.finfo(kind).eps)) * moved


@given(sizes, ends, st.one_of(st.just(math.inf), lengths), st.sampled_from([np.float64, np.float32]))
@settings(deadline=None)
def test_edges_stay_on_the_segment(h, a, length, kind):
    sampler = Equiangular(h, a, a + length)
    one = kind(1)
    edges = np.array([0.0, np.finfo(kind).smallest_subnormal, 0.5, np.nextafter(one, kind(0))], dtype=kind)
    draw = sampler.sample(edges[:, None])
    low, high = kind(a), kind(a + length)
    assert np.all((draw.x >= low) & (draw.x <= high))
    assert np.all(np.diff(draw.x) >= 0)
    assert np.all(draw.pdf > 0)


def test_rounding_past_infinity_does_not_come_back_from_behind(monkeypatch):
    """In single precision the last uniform may reach an angle beyond that of infinity, where the tangent has changed its sign.

    Whether it does depends on the processor's tangent: one that is four units off, as fast ones are, stands for all.
    """
    exact = np.tan

    def fast(t, out):
        out[...] = exact(t) * np.float32(1 + 4 * 2.0**-23)

    monkeypatch.setattr(np, "tan", fast)
    u = np.array([[1 - 2.0**-24]], np.float32)
    for a in np.random.default_rng().uniform(0.1, 10, 200):
        assert Equiangular(1.0, a, np.inf).sample(u).x[0] > 1e3


@pytest.mark.parametrize(
    ("h", "a", "b", "argument"),
    [
        (0.0, 0.0, 1.0, "h"),
        (-1.0, 0.0, 1.0, "h"),
        (math.inf, 0.0, 1.0, "h"),
        (1e200, 0.0, 1.0, "h"),
        (1.0, -math.inf, 1.0, "a"),
        (1.0, 1.0, 1.0, "b"),
    ],
)
def test_what_has_no_angle_is_refused(h, a, b, argument):
    with pytest.raises(InvalidValueError) as caught:
        Equiangular(h, a, b)
    assert caught.value.argument == argument
