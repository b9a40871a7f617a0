"""Right samplers are rejected as often as promised and no more: exact p-values are uniform, bounds never too small.

The short form of `tools/calibrate.py`. Fresh seeds; the bands are crossed with probability 1e-9.
"""

from calibrate import small_verdicts, too_small, uniformity

from fogproof.checks import fresh_seed


def test_p_values_of_right_samplers():
    seed = fresh_seed()
    p_values = small_verdicts(count=600, samples=4000, seed=seed)
    assert p_values.rejected == 0, f"seed {seed}: {p_values.examples}"
    assert len(p_values.exact) == 600
    assert uniformity(p_values.exact) > 1e-9, f"seed {seed}"
    for level in (1e-3, 1e-2, 0.1):
        assert not too_small(p_values.bounds, level, 1e-9), f"seed {seed}, level {level}"
