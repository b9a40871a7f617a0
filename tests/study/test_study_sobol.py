"""Sobol points reach every estimator that declares itself a pure function of uniforms, without a bias of their own."""

import numpy as np
import pytest
from study_fixtures import LIT, SMALL, drawn, estimator, kinds, study_from

from fogproof.errors import SubjectError
from fogproof.study.cells import cells_of
from fogproof.study.sobol import SobolPoints, SobolSequence


def sequence(dimensions, seed, start=0):
    return SobolSequence(dimensions, np.random.default_rng(seed), np.random.default_rng(seed + start + 1), start)


@pytest.mark.parametrize("dimensions", [1, 3, 16])
def test_points_are_balanced_and_inside(dimensions):
    u = sequence(dimensions, int(np.random.default_rng().integers(2**40))).points(256).random((256, dimensions))
    assert np.all((u >= 0) & (u < 1))
    for column in u.T:  # one point in each of 256 equal stretches, on every axis
        assert np.array_equal(np.sort(np.floor(column * 256)), np.arange(256))


def test_a_stretch_of_a_sequence_goes_on_where_it_was():
    whole = sequence(2, 7).points(64).random((64, 2))
    rest = sequence(2, 7, 32).points(32).random((32, 2))
    assert np.abs(whole[32:] - rest).max() < 2.0**-31  # the digits behind the net's are drawn anew


def test_digits_behind_the_net_are_random():
    """The mean of many scrambled sets of points is 1/2 to a precision that 32 digits alone would miss."""
    rng = np.random.default_rng()
    means = [sequence(1, int(rng.integers(2**40))).points(1 << 14).random(1 << 14) for _ in range(16)]
    means = np.array([float(np.mean(u - 0.5)) for u in means])
    digits = np.concatenate([np.modf(sequence(1, 3).points(4096).random(4096) * 2.0**32)[0]])
    assert abs(digits.mean() - 0.5) < 8 / np.sqrt(12 * 4096)
    assert abs(means.mean()) < 8 * means.std() / 4


def test_who_asks_for_more_than_declared_is_told():
    points = SobolPoints(np.zeros((8, 2)))
    points.random((8, 1))
    points.random(8)
    with pytest.raises(SubjectError, match="no pure function of its uniforms"):
        points.random(8)
    with pytest.raises(SubjectError, match="no pure function of its uniforms"):
        SobolPoints(np.zeros((8, 2))).random((4, 2))


FOG = {"name": "fog", "quantity": "fog", "medium": {"sigma_a": 0.1, "sigma_s": 0.4}, "ambient": 1.0,
       "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 2}, "estimators": kinds("analog-fog")}  # fmt: skip


def test_pure_functions_of_uniforms_are_better_with_them(tmp_path):
    """The smooth ones by far; hits and misses at least by N^1/2 to N^1."""
    lit = {**LIT, "estimators": kinds("airlight", {"kind": "marched-airlight", "rule": "jittered", "steps": 4})}
    study = study_from({**SMALL, "samples": [64, 1024, 16384], "scenes": [lit, FOG]})
    record = drawn(study, tmp_path)
    for scene, name, least in (
        (0, "airlight", 100),
        (0, "marched-airlight (rule = jittered, steps = 4)", 100),
        (1, "analog-fog", 5),
    ):
        points, plain = estimator(record, f"{name} + sobol", scene), estimator(record, name, scene)
        assert points["outcome"] == "not rejected", points["findings"]
        assert plain["counts"][-1]["rmse"] > least * points["counts"][-1]["rmse"]
        assert points["order"] is None or points["order"]["low"] > 0.6
        assert plain["order"]["low"] < 0.6


def test_a_study_may_leave_them_out():
    assert {c.points for c in cells_of(study_from(SMALL))} == {"random", "sobol"}
    assert {c.points for c in cells_of(study_from({**SMALL, "sobol": False}))} == {"random"}


def test_counts_are_powers_of_two():
    cell = next(c for c in cells_of(study_from({**SMALL, "samples": [100, 120, 1000]})) if c.points == "sobol")
    assert cell.counts == (128, 1024)


def test_what_random_points_do_not_find_right_sobol_points_cannot_be(tmp_path):
    """An error that both share is told of both."""
    study = study_from({**SMALL, "samples": [64, 4096], "scenes": [FOG]})
    cells = cells_of(study)
    for cell in cells:
        truth = cell.reference
        cell.__dict__["reference"] = truth.__class__(truth.value * 1.1, truth.error, "off by a tenth", "")
    record = drawn(study, tmp_path, cells=cells)
    assert [e["outcome"] for e in record["scenes"][0]["estimators"]] == ["rejected", "rejected"]
    assert record["scenes"][0]["answer"]["best"] is None
