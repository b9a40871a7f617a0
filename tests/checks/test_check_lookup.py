"""The fast search finds the very cell that `searchsorted` finds, whatever the edges and wherever the numbers lie."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fogproof.checks.density.lookup import Lookup

NUMBERS = st.floats(-1e6, 1e6, allow_subnormal=False)


def expected(edges, t):
    return np.clip(np.searchsorted(edges, t, side="right") - 1, 0, len(edges) - 2)


@settings(max_examples=300, deadline=None)
@given(arrays(float, st.integers(2, 60), elements=NUMBERS, unique=True), arrays(float, 50, elements=NUMBERS))
def test_any_edges_and_numbers(edges, t):
    edges = np.sort(edges)
    t = np.concatenate([t, edges, np.nextafter(edges, -np.inf), np.nextafter(edges, np.inf), [-1e300, 1e300]])
    np.testing.assert_array_equal(Lookup.of(edges)(t), expected(edges, t))


def test_peaks_a_million_times_narrower_than_the_range():
    rng = np.random.default_rng(5)
    for draw in (
        lambda n: 1e-6 * rng.exponential(size=n),
        lambda n: np.where(rng.random(n) < 0.5, 0.2, 0.7) + 1e-7 * rng.normal(size=n),
        lambda n: rng.exponential(size=n) ** 20,
        lambda n: 1 - 1e-13 * rng.random(n),
    ):
        edges = np.unique(np.concatenate([[0.0], draw(20_000), [1e3]]))
        edges = edges[edges >= 0]
        t = draw(50_000)
        np.testing.assert_array_equal(Lookup.of(edges)(t), expected(edges, t))


def test_edges_one_rounding_apart():
    edges = 1 + np.arange(20) * np.spacing(1.0)
    t = np.concatenate([edges, [0.0, 2.0]])
    np.testing.assert_array_equal(Lookup.of(edges)(t), expected(edges, t))
    tiny = np.array([0.0, 5e-324, 1e-323])
    np.testing.assert_array_equal(Lookup.of(tiny)(tiny), expected(tiny, tiny))
