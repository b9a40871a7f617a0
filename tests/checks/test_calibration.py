"""Right subjects are rejected as often as promised and no more: exact p-values are uniform, bounds never too small.

The short form of `tools/calibrate.py`. Fresh seeds; a band is crossed with probability 1e-9.
"""

import pytest
from calibrate import allowed, estimator_tally, sampler_tally, whole_verdicts
from calibrate_subjects import RIGHT, SUBJECTS
from calibrate_tally import LEVEL, kind_of, uniformity

from fogproof.checks import Finding, fresh_seed


def too_many(hits, n, level):
    from scipy.special import bdtrc

    return hits > 0 and bdtrc(hits - 1, n, level) < 1e-9


def check(tally, seed):
    for kind, n in tally.counted.items():
        assert not too_many(tally.small[kind], n, LEVEL), f"{kind}: {tally.small[kind]} of {n}, seed {seed}"
    for kind, values in tally.values.items():
        if tally.exact[kind]:
            assert uniformity(values) > 1e-9, f"{kind}, seed {seed}"


@pytest.mark.parametrize("name", SUBJECTS)
def test_p_values_of_right_samplers(name):
    seed = fresh_seed() >> 2
    check(sampler_tally(name, 60, 4000, seed), seed)


def test_p_values_of_right_estimators():
    seed = fresh_seed() >> 2
    check(estimator_tally(100, 2000, seed), seed)


@pytest.mark.parametrize("name", RIGHT)
def test_right_samplers_pass_whole(name):
    seed = fresh_seed() >> 2
    assert set(whole_verdicts(name, 1, 100_000, seed)) <= allowed(name), f"seed {seed}"


def test_kinds_have_no_axis():
    assert kind_of(Finding("chi-square in mu", "not rejected", "")) == "chi-square"
    assert kind_of(Finding("dependence of the axes", "not rejected", "")) == "dependence of the axes"
    assert kind_of(Finding("distribution of cdf of x", "not rejected", "")) == "distribution"
