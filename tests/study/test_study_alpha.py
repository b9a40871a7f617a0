"""A study spends its false-alarm probability once, over all its cells, and its tests see errors on either side."""

import numpy as np
import pytest
from scipy import stats
from study_fixtures import LIT, SMALL, drawn, kinds, study_from

from fogproof.study.convergence import Z, order_of, rmse
from fogproof.study.replicate_means import judged_by_replicates


@pytest.mark.parametrize("alpha", [1e-6, 0.01])
def test_the_findings_of_a_study_share_alpha(tmp_path, alpha):
    scenes = [{**LIT, "estimators": kinds("airlight", {"kind": "airlight", "placing": "distance"})}, SMALL["scenes"][1]]
    record = drawn(study_from({**SMALL, "scenes": scenes, "alpha": alpha, "samples": [256, 4096]}), tmp_path)
    findings = [f for scene in record["scenes"] for e in scene["estimators"] for f in e["findings"]]
    assert {"mean", "variance", "scatter of replicates", "value"} <= {f["check"] for f in findings}
    spent = sum(f["alpha"] for f in findings if f["alpha"] is not None)
    assert 0.5 * alpha < spent <= alpha * (1 + 1e-9)


def test_means_of_scrambled_points_have_students_law_with_room_for_skewness():
    """Whatever the error of the reference, and if all means are alike: then one hit more or less is no bias."""
    means, alpha = np.random.default_rng().gamma(4.0, size=40), 0.01
    stderr = means.std(ddof=1) / np.sqrt(40)
    growth = abs(stats.skew(means)) / (3 * np.sqrt(40)) * stats.norm.isf(alpha / 2) ** 3
    for z, error in ((1.0, 0.0), (4.0, 0.0), (4.0, 2 * stderr)):
        found = judged_by_replicates("mean", means, means.mean() + z * stderr, error, alpha)
        right = 2 * stats.t.sf(z - error / stderr, 39) * np.exp(growth)
        assert found.p_value == pytest.approx(min(1.0, right), rel=1e-6)
    alike = np.full(8, 0.5)
    assert judged_by_replicates("mean", alike, 0.51, 0.0, alpha, step=1 / 64).outcome == "not rejected"
    assert judged_by_replicates("mean", alike, 0.52, 0.0, alpha, step=1 / 64).outcome == "rejected"


def test_intervals_of_rmse_and_order_are_as_wide_as_they_say():
    """Of normal errors: 99 of 100 intervals hold the truth, and they are no wider than that takes."""
    rng = np.random.default_rng()
    counts, replicates, tries = np.array([100, 1000, 10_000]), 32, 500
    held, slopes, widths = [], [], []
    for _ in range(tries):
        found = [rmse(rng.normal(0, n**-0.5, replicates), 0.0, 0.0) for n in counts]
        held.append([e.low <= n**-0.5 <= e.high for e, n in zip(found, counts, strict=True)])
        line = order_of(counts, np.array([e.value for e in found]), np.full(3, float(replicates)), np.zeros(3))
        if line is not None:  # but for one in a thousand, whose errors lie on no line
            slopes.append(line.value)
            widths.append(line.high - line.value)
    hits = int(np.sum(held))
    assert stats.binom.cdf(hits, 3 * tries, 0.99) > 1e-9
    assert stats.binom.sf(hits - 1, 3 * tries, 0.997) > 1e-9, "wider than 99 % takes"
    ratio = np.mean(widths) / (Z * np.std(slopes))
    assert len(slopes) > 0.97 * tries
    assert abs(np.mean(slopes) - 0.5) < 6 * np.std(slopes) / np.sqrt(tries)
    assert 0.8 < ratio < 1.25
    skewed = rmse(rng.normal(0, 1, replicates), 6.0, 0.0)
    plain = rmse(rng.normal(0, 1, replicates), 0.0, 0.0)
    assert skewed.high / skewed.value > 1.2 * plain.high / plain.value
    known = rmse(np.full(8, 0.5), 0.0, 0.2)
    exact = rmse(np.full(8, 0.5), 0.0, 0.0)
    assert (known.low, known.high) == (pytest.approx(max(exact.low - 0.2, 0.0)), pytest.approx(exact.high + 0.2))
