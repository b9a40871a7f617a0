"""Numbers, shares, points and directions, simple ones first."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

_FAR = 10.0


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """Draw numbers, whole and round ones first; closer to another than rounding is nothing that anybody means."""
    return st.one_of(
        st.integers(math.ceil(low), math.floor(high)).map(float), st.floats(low, high).map(lambda x: round(x, 9))
    )


def positive(high: float) -> st.SearchStrategy[float]:
    """Draw positive numbers, whole ones first."""
    return st.one_of(st.integers(1, math.floor(high)).map(float), st.floats(1e-3, high))


points = st.tuples(*3 * [numbers(-_FAR, _FAR)])
share = st.one_of(st.sampled_from([0.0, 1.0, 0.5]), st.floats(0, 1))


def unit(v: tuple[float, ...]) -> tuple[float, ...]:
    """Return the unit vector along v, twice divided: once leaves rounding where v is tiny."""
    array = np.array(v) / np.linalg.norm(v)
    return tuple((array / np.linalg.norm(array)).tolist())


directions = st.one_of(
    st.sampled_from([(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)]),
    st.tuples(*3 * [numbers(-1, 1)]).filter(lambda v: math.hypot(*v) > 1e-3).map(unit),
)
"""Unit vectors (x, y, z), often along an axis."""
