"""A change of speed is told from a change of the machine: by fixed work beside the batches, else by the other estimators."""

import copy
import json
import math

import numpy as np
import pytest
from scipy.stats import ttest_ind
from study_fixtures import SMALL, drawn, kinds, study_from

from fogproof.errors import InvalidInputError
from fogproof.study import batches as drawing
from fogproof.study import run_study
from fogproof.study.fixed_work import COLUMNS, GROUPS, over_fixed_work, summed_up, time_fixed_work
from fogproof.study.history import compare
from fogproof.study.speed_change import ASIDE, LEAST, SHARE, became, speed_changes

ALPHA = 1e-6


@pytest.fixture
def rng():
    seed = int(np.random.default_rng().integers(2**40))
    print("seed", seed)
    return np.random.default_rng(seed)


def estimator(rng, seconds=1e-3, machine=(1.0, 1.0, 1.0), batches=96, scatter=0.1):
    """Return what a record has of an estimator's times, on a machine that takes so many times as long for each sort of work.

    What the estimator does is a mixture of the sorts.
    """
    weights = rng.dirichlet(np.ones(3))
    own = seconds * float(weights @ np.array(machine)) * np.exp(scatter * rng.standard_normal(batches))
    fixed = 2e-5 * np.array(machine) * np.exp(scatter * rng.standard_normal((batches, 3)))
    own[rng.random(batches) < 0.02] *= 5  # something came between
    middle = float(np.median(own))
    timing = {"count": 64, "seconds": middle, "low": 0.98 * middle, "high": 1.02 * middle}
    return {"speed": {"counts": [{**timing, "fixed_work": summed_up(over_fixed_work(own, fixed))}]}}


def test_the_work_takes_time_and_is_told_apart():
    times = np.array([time_fixed_work() for _ in range(5)])
    assert times.shape == (5, 3)
    assert (times >= 0).all()
    assert times.max() < 0.1


def test_trimmed_means_are_those_of_yuen(rng):
    a, b = rng.standard_normal((2, 30, 4)) + 0.3 * np.arange(2)[:, None, None]
    first, second = summed_up(a), summed_up(b)
    off = math.log(second["all"] / first["all"])
    t = ttest_ind(b[:, -1], a[:, -1], equal_var=False, trim=0.2)
    assert off / math.hypot(first["stderr"], second["stderr"]) == pytest.approx(t.statistic)
    ((change,),) = speed_changes([timed(first, second)], True).changes
    assert change.freedom == pytest.approx(t.df)


def timed(*works):
    return [
        {"speed": {"counts": [{"count": 1, "seconds": 1.0, "low": 0.9, "high": 1.1, "fixed_work": w}]}} for w in works
    ]


@pytest.mark.parametrize("batches", [1, 5, 31, 32, 33, 1000])
def test_what_the_machine_takes_longer_for_cancels(rng, batches):
    machine = np.exp(rng.standard_normal((batches, 1)))
    logs = over_fixed_work(3e-3 * machine[:, 0], 1e-3 * machine * np.ones(3))
    assert logs == pytest.approx(math.log(3))
    assert logs.shape == (min(batches, GROUPS), len(COLUMNS))


def test_a_clock_that_saw_no_time_pass_says_nothing():
    assert summed_up(over_fixed_work(np.zeros(9), np.ones((9, 3)))) is None
    assert summed_up(over_fixed_work(np.ones(9), np.zeros((9, 3)))) is None
    none = timed(None, None)
    assert speed_changes([none], True).against == "nothing"


def test_no_change_is_said_of_equal_code_whatever_the_machine_does(rng):
    for _ in range(50):
        machine = math.exp(rng.normal()) * np.exp(0.1 * rng.standard_normal(3))
        speeds = speed_changes([(estimator(rng), estimator(rng, machine=machine))], True)
        assert speeds.against == "fixed-work"
        assert became(speeds.changes[0], ALPHA) == []
        assert 0.7 < speeds.machine / machine.mean() < 1.4


def test_a_change_of_the_stated_resolution_is_said(rng):
    said = 0
    for _ in range(50):
        before, machine = estimator(rng), np.full(3, math.exp(0.02 * rng.normal()))
        factor = speed_changes([(before, estimator(rng, machine=machine))], True).changes[0][0].resolution(ALPHA)
        assert factor < 1.8  # and it is a resolution that serves
        ((change,),) = speed_changes([(before, estimator(rng, 1e-3 * factor, machine))], True).changes
        said += change.became(ALPHA) == ["slower"]
        assert abs(change.off - math.log(factor)) < change.reach(1e-9)
    assert said >= 47  # the scatter of the second run is another than that of the first, which foretold it


def test_sorts_that_disagree_leave_a_change_open(rng):
    before, after = estimator(rng, scatter=1e-3), estimator(rng, scatter=1e-3)
    work = after["speed"]["counts"][0]["fixed_work"]
    work |= {"interpreted": 2 * work["interpreted"], "all": 2 ** (1 / 3) * work["all"]}
    ((change,),) = speed_changes([(before, after)], True).changes
    assert change.aside == pytest.approx(ASIDE + (2 + SHARE) / 3 * math.log(2), abs=0.02)
    assert change.became(ALPHA) == []


def test_a_machine_that_ran_otherwise_leaves_more_open(rng):
    """Fixed work follows the machine in part: a change is said where both runs met it alike, not where one took twice as long."""
    before, after = estimator(rng, scatter=1e-3), estimator(rng, 1.3e-3, scatter=1e-3)
    slow = estimator(rng, 1.3e-3, machine=(2.0, 2.0, 2.0), scatter=1e-3)
    ((alike,),), ((other,),) = (speed_changes([(before, one)], True).changes for one in (after, slow))
    assert alike.became(ALPHA) == ["slower"]
    assert other.off == pytest.approx(math.log(1.3), abs=0.02)
    assert other.aside == pytest.approx(ASIDE + SHARE * math.log(2), abs=0.02)
    assert other.became(ALPHA) == []
    assert other.resolution(ALPHA) > 1.8 * alike.resolution(ALPHA)


def test_times_are_compared_at_a_count_that_both_runs_have(rng):
    before, after = estimator(rng), estimator(rng)
    larger = copy.deepcopy(after["speed"]["counts"][0]) | {"count": 128}
    larger["fixed_work"]["all"] *= 3
    after["speed"]["counts"].append(larger)
    assert speed_changes([(before, after)], True).changes[0][0].became(ALPHA) == []


ALONE = study_from(
    {
        **SMALL,
        "sobol": False,
        "samples": [64],
        "replicates": 64,
        "scenes": [{**SMALL["scenes"][0], "estimators": kinds("airlight")}],
    }
)


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The record of a study of one estimator."""
    return drawn(ALONE, tmp_path_factory.mktemp("alone"))


def times_as_slow(record, factor):
    after = copy.deepcopy(record)
    for timing in after["scenes"][0]["estimators"][0]["speed"]["counts"]:
        timing |= {key: factor * timing[key] for key in ("seconds", "low", "high")}
        timing["fixed_work"] |= {key: factor * timing["fixed_work"][key] for key in COLUMNS}
    return after


def test_one_estimator_alone_is_told_to_be_slower(alone):
    found = compare(alone, {**alone, "started": "later"})
    assert found["against"] == "fixed-work"
    (change,) = found["changes"]
    assert f"an estimator {change['time']['resolution']:.3g} times as slow, or as fast, would" in found["text"]
    for factor, word in ((1.01, "slower"), (0.99, "faster")):
        off = change["time"]["resolution"] ** (1 if factor > 1 else -1)
        assert compare(alone, times_as_slow(alone, factor * off))["changes"][0]["became"] == [word]
    assert not compare(alone, times_as_slow(alone, 1.05))["worse"]


def with_variance(record, factor, **more):
    """Return the record with so many times the variance, of other draws."""
    after = copy.deepcopy(record)
    e = after["scenes"][0]["estimators"][0]
    e["variance"] |= {key: factor * e["variance"][key] for key in ("measured", "low", "high")} | more
    e["moments"]["m2"] *= factor
    return after


@pytest.mark.parametrize(
    ("slow", "noisy", "worse"),
    [(8, 1 / 8, False), (8, 1 / 80, False), (8, 1 / 2, True), (1 / 8, 8, False), (1, 8, True)],
)
def test_what_comes_to_an_error_as_soon_as_before_is_not_worse(alone, slow, noisy, worse):
    """Eight times the time of a sample at an eighth of the variance is the same time to an error."""
    found = compare(alone, with_variance(times_as_slow(alone, slow), noisy))
    assert found["changes"][0]["became"]
    assert (found["worse"], found["changes"][0]["worse"]) == (worse, worse)
    assert ("to the same error as soon as before" in found["text"]) != worse


def test_a_variance_without_an_upper_end_is_compared(alone):
    """As it stands in a record: a tail that may hold more of it makes nobody less noisy, and hides nothing that became noisier."""
    heavy = with_variance(alone, 1.0, high="inf")
    assert compare(heavy, alone)["changes"][0]["variance"]["low"] == 0
    assert compare(heavy, with_variance(alone, 1 / 8))["changes"][0]["became"] == ["less noisy"]
    assert compare(heavy, with_variance(alone, 8))["changes"][0]["became"] == []
    assert compare(alone, with_variance(alone, 8, high="inf"))["changes"][0]["became"] == ["noisier"]
    assert compare(alone, with_variance(alone, 1 / 8, high="inf"))["changes"][0]["became"] == []


@pytest.mark.parametrize("other", [{"numpy": "1.0"}, {"cores": 1000}])
def test_on_another_machine_fixed_work_tells_nothing(alone, other):
    after = times_as_slow(alone, 3)
    assert compare(alone, after)["worse"]
    after["environment"] = after["environment"] | other
    found = compare(alone, after)
    assert found["against"] == "nothing"
    assert not found["worse"]
    assert f"of less than {LEAST} estimators" in found["text"]


def test_other_code_of_ours_is_the_same_machine(alone):
    after = times_as_slow(alone, 100)
    after["sessions"] = [{"started": "", "environment": after["environment"] | {"code": "changed"}}]
    assert compare(alone, after)["worse"]


def test_work_of_another_version_is_not_compared(alone):
    after = times_as_slow(alone, 100)
    after["scenes"][0]["estimators"][0]["speed"]["counts"][0]["fixed_work"]["version"] += 1
    assert compare(alone, after)["against"] == "nothing"


@pytest.mark.parametrize("value", [0, "text", None, 1e300])
def test_a_record_that_was_changed_is_told_before_anything_is_drawn(alone, tmp_path, value):
    before = copy.deepcopy(alone)
    before["scenes"][0]["estimators"][0]["speed"]["counts"][0]["fixed_work"] |= {"stderr": value, "all": value}
    (tmp_path / "results.json").write_text(json.dumps(before))
    with pytest.raises(InvalidInputError, match=r"cannot be compared with, as if changed by hand: \w+Error"):
        run_study(ALONE, tmp_path / "run", against=tmp_path)
    assert not (tmp_path / "run").exists()


def test_work_is_timed_beside_each_batch_and_kept(monkeypatch, tmp_path):
    monkeypatch.setattr(drawing, "time_fixed_work", lambda: np.array([1e-3, 2e-3, 4e-3]))
    work = drawn(ALONE, tmp_path)["scenes"][0]["estimators"][0]["speed"]["counts"][0]["fixed_work"]
    assert work["interpreted"] / work["memory"] == pytest.approx(4)
    assert work["all"] == pytest.approx(work["arithmetic"])


def test_many_estimators_are_held_against_each_other_as_well(rng):
    """Of so few batches each alone tells little; one that is slower stands out from the others."""
    before = [estimator(rng, batches=6) for _ in range(2 * LEAST)]
    after = [estimator(rng, batches=6) for _ in range(2 * LEAST)]
    for e in (*before, *after):
        e["speed"]["counts"][0] |= {"seconds": 1.0, "low": 0.98, "high": 1.02}
    after[0]["speed"]["counts"][0] |= {"seconds": 2.0, "low": 1.96, "high": 2.04}
    speeds = speed_changes(list(zip(before, after, strict=True)), True)
    said = [became(ways, ALPHA) for ways in speeds.changes]
    assert said == [["slower"], *([[]] * (2 * LEAST - 1))]
