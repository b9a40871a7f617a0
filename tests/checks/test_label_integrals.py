"""No integral of a pdf is printed with an interval that is false; the short form of `tools/label_integrals.py`."""

import numpy as np
import pytest
from label_integrals import deviation, lobes, visible_normals

from fogproof import UnitHemisphere, check_sampler
from fogproof.checks.statistics.integrated import Integrated

SEEDS = range(6)


@pytest.mark.parametrize("family", [visible_normals, lobes])
def test_samples_that_crowd_at_an_edge_move_no_integral(family):
    found = [deviation(seed, 20_000, family, 1) for seed in SEEDS]
    stated = [z for _, z, why_not in found if not why_not]
    assert stated
    assert max(map(abs, stated)) < 6


def test_visible_normals_without_their_warp_have_another_shape():
    domain, pdf, (_, without_warp), k = visible_normals(np.random.default_rng(5))
    verdict = check_sampler(without_warp, pdf, domain, dimensions=k, samples=60_000)
    assert isinstance(domain, UnitHemisphere)
    assert (verdict.outcome, verdict.cause) == ("rejected", "shape")


def test_ratios_of_a_heavy_tail_are_no_interval():
    rng = np.random.default_rng(1)
    light, heavy = rng.random(20_000), rng.random(20_000) ** -0.9
    assert Integrated.of(light).why_not == ""
    assert abs(Integrated.of(light).mean - 0.5) < 5 * Integrated.of(light).error
    assert "few points" in Integrated.of(heavy).why_not
    assert "too few" in Integrated.of(light[:99]).why_not
    assert "rounding" in Integrated.of(np.append(light, np.nan)).why_not


def test_sums_of_parts_are_the_sums_of_the_whole():
    ratio = np.random.default_rng(2).random(5000)
    parts = Integrated(Integrated.of(ratio[:2000]).sums + Integrated.of(ratio[2000:]).sums)
    assert parts.mean == pytest.approx(Integrated.of(ratio).mean)
    assert parts.error == pytest.approx(Integrated.of(ratio).error)
