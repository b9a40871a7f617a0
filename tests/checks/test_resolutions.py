"""An error of exactly the stated size is caught as often as stated, for atoms and shares of any probability."""

import numpy as np
import pytest

from fogproof.checks.statistics.goodness import binomial, binomial_resolution

ALPHA = 1e-6


@pytest.mark.parametrize("n", [1000, 100_000])
@pytest.mark.parametrize("q", [1e-4, 0.02, 0.5, 0.999])
def test_a_probability_off_by_the_resolution_is_caught(n, q):
    rng = np.random.default_rng()
    size = binomial_resolution(n, q, q, ALPHA)
    caught = {}
    for sign in (1, -1):
        wrong = q + sign * size
        if 0 <= wrong <= 1:
            counts = rng.binomial(n, wrong, 2000)
            values, times = np.unique(counts, return_counts=True)
            hits = [binomial("atom", "atom", int(k), n, q, q, "atom", ALPHA).outcome == "rejected" for k in values]
            caught[sign] = np.average(hits, weights=times)
    assert min(caught.values()) > 0.975, f"99 of 100 were promised: {caught}"
    counts = rng.binomial(n, q + 0.7 * size * min(caught, key=lambda sign: caught[sign]), 300)
    hits = [binomial("atom", "atom", int(k), n, q, q, "atom", ALPHA).outcome == "rejected" for k in counts]
    assert np.mean(hits) < 0.97, "a resolution is as small as it can be"
