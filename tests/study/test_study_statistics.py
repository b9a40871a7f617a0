"""What a study says is true of what was drawn: merged moments are those of the whole, intervals hold what they claim to, and an
estimator that is wrong, in whatever way, wins no ranking."""

import copy
import json
import math
import re
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from study_coverage import COUNTS, Synthetic, held
from study_coverage import MEAN as TRUE_MEAN
from study_coverage import study as synthetic
from study_fixtures import LIT, SMALL, drawn, estimator, kinds, study_from

from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import binomial_at_most
from fogproof.contracts import Reference
from fogproof.study import fixed_work
from fogproof.study.aggregate import Level, merged, pooled
from fogproof.study.batches import TAIL, TAIL_SHARE, _largest, moments_of
from fogproof.study.cells import cells_of
from fogproof.study.convergence import ABOVE, Z, floor_of, order_of, rmse
from fogproof.study.history import _perhaps, compare
from fogproof.study.methods import table as methods
from fogproof.study.methods.method import Method
from fogproof.study.speed import Times, times_of

MEAN, SIGMA = 2.0, 0.5


@given(st.integers(0, 2**32), st.integers(1, 40), st.sampled_from(["normal", "hits", "constant"]))
@settings(max_examples=60, deadline=None)
def test_moments_merge_to_those_of_the_whole(seed, parts, law):
    rng = np.random.default_rng(seed)
    x = {"normal": lambda n: 5 + rng.normal(size=n), "hits": lambda n: (rng.random(n) < 0.3) * 2.0,
         "constant": lambda n: np.full(n, 0.1)}[law](parts * 7)  # fmt: skip
    rows = np.concatenate([moments_of(part[None]) for part in np.split(x, parts)])
    found, whole = pooled(rows), Moments.of(x)
    for name in ("n", "mean", "m2", "m3", "m4", "low", "high"):
        assert getattr(found, name) == pytest.approx(getattr(whole, name), rel=1e-9, abs=1e-9), name
    assert found.values == whole.values
    if law == "constant":
        assert found.m2 == 0
    starts = np.arange(parts)
    assert np.array_equal(merged(rows, starts), rows)


def test_the_largest_deviations_are_those():
    for n in (1, 63, 64, 1000, 4096, 70_001):
        x = np.random.default_rng().exponential(size=n)
        kept = _largest(x)
        assert np.array_equal(kept, np.sort(x)[n - len(kept) :])
        assert len(kept) == min(TAIL, n // TAIL_SHARE)
    x[::2] = np.inf
    assert np.isfinite(_largest(x)).all()
    assert len(_largest(x)) == TAIL


def test_what_is_not_finite_is_counted_and_left_out():
    rows = moments_of(np.array([[1.0, np.nan, 3.0], [np.inf, np.nan, np.nan], [1.0, 2.0, 3.0]]))
    assert rows[:, -1].tolist() == [1, 3, 0]
    assert pooled(rows).n == 5
    assert pooled(rows).mean == 2


def covered(trials, hits, confidence):
    """Fail if so few hits are as unlikely as 1e-9."""
    assert binomial_at_most(hits, trials, confidence) > 1e-9, hits / trials


def test_the_interval_of_an_rmse_holds_the_truth():
    rng, trials = np.random.default_rng(), 4000
    errors = rng.normal(size=(trials, 16)) * 0.3
    found = [rmse(e, 0.0, 0.0) for e in errors]
    covered(trials, sum(e.low <= 0.3 <= e.high for e in found), 0.98)
    heavy = rng.laplace(size=(trials, 16)) * 0.3 / math.sqrt(2)  # excess kurtosis 3
    covered(trials, sum(e.low <= 0.3 <= e.high for e in (rmse(x, 3.0, 0.0) for x in heavy)), 0.97)
    assert rmse(errors[0], 1e5, 0.0).high == math.inf
    assert rmse(errors[0], 0.0, 0.1).high == pytest.approx(found[0].high + 0.1)


def test_the_order_of_random_errors_and_its_interval():
    rng, counts, nothing = np.random.default_rng(), np.array([100, 1000, 10_000, 100_000]), np.zeros(4)
    freedom = np.full(4, 16.0)
    exact = order_of(counts, 3 / np.sqrt(counts), freedom, nothing)
    assert exact.value == pytest.approx(0.5, abs=1e-12)
    noise = np.sqrt(rng.chisquare(16, size=(3000, 4)) / 16)
    found = [order_of(counts, noise_ / counts**0.5, freedom, nothing) for noise_ in noise]
    covered(3000, sum(o.low <= 0.5 <= o.high for o in found if o is not None), 0.98)
    covered(3000, sum(o is not None and o.points == 4 for o in found), 0.99)
    assert order_of(counts[:2], np.ones(2), freedom[:2], nothing[:2]) is None


@pytest.mark.parametrize("order", [1, 2, 4])
def test_the_order_of_a_march_and_its_floor(order):
    counts = np.round(10 * 2.0 ** np.arange(8)).astype(int)
    clean = 0.5 * counts.astype(float) ** -order
    sure = np.full(8, np.inf)
    found = order_of(counts, clean, sure, np.zeros(8))
    assert found.value == pytest.approx(order, abs=1e-9)
    assert (found.first, found.last, found.points) == (10, 1280, 8)
    assert found.misfit == pytest.approx(1)
    hidden = np.full(8, clean[4] / (2 * ABOVE))
    rounded = np.where(np.arange(8) > 5, hidden / 3, clean)
    found = order_of(counts, rounded, sure, hidden)
    assert found.value == pytest.approx(order, abs=1e-9)
    assert found.last <= counts[5]
    assert floor_of(counts, rounded, hidden).reached
    assert not floor_of(counts, clean, np.zeros(8)).reached
    assert order_of(counts, np.full(8, 1e-16), sure, np.full(8, 1e-12)) is None


def test_an_order_is_that_of_the_asymptote():
    """Errors that first fall faster: nothing is told of the start, and nothing where the asymptote is not reached."""
    counts = np.round(10 * 2.0 ** np.arange(12)).astype(int)
    n, sure, nothing = counts.astype(float), np.full(12, np.inf), np.zeros(12)
    early = n**-2.0 + 50 * np.exp(-n / 20)
    found = order_of(counts, early, sure, nothing)
    assert found.low <= 2 <= found.high
    assert found.high - found.low < 0.5
    assert found.first >= 160
    assert order_of(counts[:5], 1e6 * np.exp(-n[:5] / 20), sure[:5], nothing[:5]) is None  # no power at all yet


def test_scattered_errors_have_a_wide_interval():
    """Steps that meet the borders of voxels anyhow: of order 1, scattered by a factor."""
    rng, counts = np.random.default_rng(), np.round(10 * 2.0 ** np.arange(10)).astype(int)
    hits = 0
    for _ in range(300):
        errors = np.exp(0.6 * rng.normal(size=10)) / counts
        found = order_of(counts, errors, np.full(10, np.inf), np.zeros(10))
        hits += found is None or found.low <= 1 <= found.high
    covered(300, hits, 0.95)


# ---- Estimators whose variance, cost and order are known


def test_times_orders_and_ranks_are_the_true_ones():
    seed = int(np.random.default_rng().integers(2**40))
    print("seed", seed)
    results = list(held(synthetic(seed, replicates=16)))
    wrong = sum(not holds for _, holds in results)
    assert len(results) > 90
    assert binomial_at_most(len(results) - wrong, len(results), 0.96) > 1e-6, [
        sort for sort, holds in results if not holds
    ]
    assert all(holds for sort, holds in results if sort in ("the soonest is named", "said to be never"))


def test_times_are_of_whole_calls_and_never_before_the_first_count():
    """One that needs 4 samples for 1 % was tried with 16: it takes less than those do, of which most is the call's own cost."""
    seed = int(np.random.default_rng().integers(2**40))
    print("seed", seed)
    law = Synthetic("independent", 0.04, 1e-4, 1e-7)
    (entry,) = synthetic(seed, (law,), replicates=16)["scenes"][0]["estimators"]
    first, second, third = entry["speed"]["targets"]
    assert (first["how"], first["samples"], first["low"]) == ("less-than", COUNTS[0], 0)
    assert 1 / 2.5 < first["seconds"] / law.time(COUNTS[0]) < 2.5  # the machine's moods are in it
    assert (second["how"], third["how"]) == ("measured", "extrapolated")
    assert second["samples"] == pytest.approx((0.04 / (0.001 * TRUE_MEAN)) ** 2, rel=0.1)
    assert 1 / 2.5 < second["seconds"] / 1.4e-4 < 2.5


def test_bias_is_part_of_the_error_and_no_gate():
    """A cheap march is soonest to 1 %, and said to be biased; who is unbiased is named beside it; the small bias stays for ever."""
    seed = int(np.random.default_rng().integers(2**40))
    print("seed", seed)
    laws = (
        Synthetic("independent", 0.5, 1e-5, 1e-6),
        Synthetic("march", 3.0, 1e-6, 1e-8, order=2.0),
        Synthetic("biased", 0.01, 1e-5, 1e-6, bias_of=0.003),
    )
    scene = synthetic(seed, laws, replicates=8)["scenes"][0]
    plain, march, biased = scene["estimators"]
    answer = scene["answer"]
    assert (answer["best"], answer["best_unbiased"]) == (march["name"], plain["name"])
    assert answer["ranking"] == [march["name"], biased["name"], plain["name"]]
    assert [e["speed"]["rank"] for e in (plain, march, biased)] == [3, 1, 2]
    assert "biased by construction" in answer["text"]
    assert "Of the unbiased" in answer["text"]
    assert [t["how"] for t in biased["speed"]["targets"]] == ["less-than", "never", "never"]
    assert march["order"]["low"] <= 2 <= march["order"]["high"]


def test_what_was_not_followed_far_enough_is_no_loser():
    """Errors that fall twice as fast but were not followed to 0.1 %: nobody is called soonest there."""
    seed = int(np.random.default_rng().integers(2**40))
    print("seed", seed)
    laws = (Synthetic("independent", 1.0, 1e-5, 1e-6), Synthetic("quasi", 60.0, 1e-5, 1e-7, order=1.0))
    scene = synthetic(seed, laws, replicates=16)["scenes"][0]
    assert scene["estimators"][1]["speed"]["targets"][1]["how"] == "not-reached"
    assert "Who is soonest to 0.1 % and 0.01 % these counts do not tell" in scene["answer"]["text"]
    assert re.search("(is|are) not there yet. So far: 0.1 % .* in .*, 0.01 % .* in ", scene["answer"]["text"])


# ---- Planted estimators: a study of one scene whose estimators are the test's own.


@dataclass(frozen=True)
class Planted(Method):
    """An estimator of MEAN with the law `what`."""

    what: str
    quantity: ClassVar[str] = "transmittance"

    @property
    def title(self):
        return f"The estimator that is {self.what}"

    def make(self, scene, count):
        return self

    def variance(self, scene):
        known = {"sharp": 0.01, "right": SIGMA**2, "biased": 1e-6, "wrongly sure": SIGMA**2 / 1.3, "dependent": 1 / 12}
        return Reference(np.asarray(known[self.what]), np.asarray(0.0), "", "") if self.what in known else None

    def draw(self, rng, n):
        match self.what:
            case "right" | "wrongly sure":
                return MEAN + SIGMA * rng.normal(size=n)
            case "sharp":
                return MEAN + 0.1 * rng.normal(size=n)
            case "biased":
                return MEAN * 1.002 + 1e-3 * rng.normal(size=n)
            case "dependent":  # stratified the wrong way: the right variance, but neighbours are alike
                return MEAN - 0.5 + np.repeat(rng.random(-(-n // 16)), 16)[:n]
            case "heavy":  # Pareto, index 1.2: the mean exists, the variance does not
                return MEAN / 6 * (1 - rng.random(n)) ** (-1 / 1.2)
            case "skewed":  # a lognormal law
                return MEAN * np.exp(1.2 * rng.normal(size=n) - 0.72)
            case "broken":
                return np.where(rng.random(n) < 1e-4, np.nan, MEAN)
        raise AssertionError(self.what)


def planted(monkeypatch, tmp_path, *whats, samples=(64, 1024, 16384), seed=None):
    monkeypatch.setitem(methods.METHODS, "planted", Planted)
    seed = int(np.random.default_rng().integers(2**40)) if seed is None else seed
    print("seed", seed)
    scene = {"name": "s", "question": "Which?", "quantity": "transmittance", "medium": {"sigma_a": 1, "sigma_s": 0},
             "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 1}, "estimators": kinds("ratio")}  # fmt: skip
    study = study_from({"samples": list(samples), "replicates": 16, "seed": seed, "sobol": False, "scenes": [scene]})
    (cell,) = cells_of(study)
    truth = Reference(np.asarray(MEAN), np.asarray(1e-15), "", "")
    cells = []
    for index, what in enumerate(whats):
        own = replace(cell, index=index, method=Planted(what), _made={})
        own.__dict__["reference"] = truth
        cells.append(own)
    return drawn(study, tmp_path, cells=cells)


def named(record, what):
    return estimator(record, f"planted (what = {what})")


def test_a_right_estimator_is_measured_as_it_is(monkeypatch, tmp_path):
    record = planted(monkeypatch, tmp_path, "right", "sharp")
    right = named(record, "right")
    assert right["outcome"] == "not rejected"
    n = right["moments"]["n"]
    assert abs(right["variance"]["measured"] / SIGMA**2 - 1) < 7 * math.sqrt(2 / n)
    assert right["variance"]["high"] / right["variance"]["low"] == pytest.approx(
        math.exp(2 * Z * math.sqrt(2 / n)), rel=0.01
    )
    assert [c["predicted"] for c in right["counts"]] == pytest.approx(
        [SIGMA / math.sqrt(c["count"]) for c in right["counts"]]
    )
    assert right["order"]["expected"] == 0.5
    target = right["speed"]["targets"][0]
    assert target["samples"] == pytest.approx((SIGMA / (0.01 * MEAN)) ** 2)
    assert record["exit_code"] == 0


WRONG = {
    "biased": ("mean", "rejected"),
    "wrongly sure": ("variance", "rejected"),
    "dependent": ("scatter of replicates", "rejected"),
    "broken": ("finite values", "rejected"),
    "heavy": ("mean", "inconclusive"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_estimator_is_not_called_unbiased(monkeypatch, tmp_path, what):
    record = planted(monkeypatch, tmp_path, what, "right")
    check, outcome = WRONG[what]
    wrong = named(record, what)
    assert next(f for f in wrong["findings"] if f["check"] == check)["outcome"] == outcome
    assert wrong["outcome"] == outcome
    answer = record["scenes"][0]["answer"]
    assert answer["best_unbiased"] == "planted (what = right)"
    if outcome == "rejected":
        assert "Rejected: the estimator" in answer["text"]
        assert record["exit_code"] == 1
        assert (wrong["name"] in answer["unranked"]) == (what == "broken")  # what is no number has no error
    else:
        assert "infinite variance suspected" in wrong["warning"]
        assert "Not judged unbiased yet" in answer["text"]
        assert record["exit_code"] == 3
    assert planted(monkeypatch, tmp_path / "alone", what)["scenes"][0]["answer"]["best_unbiased"] is None


def test_dependent_realisations_err_as_measured(monkeypatch, tmp_path):
    """Sixteen alike at a time: the variance of one says nothing of the mean, whose error is four times as large."""
    record = planted(monkeypatch, tmp_path, "dependent", samples=(64, 512, 4096, 32768))
    target = named(record, "dependent")["speed"]["targets"][0]
    assert target["how"] == "measured"
    assert (
        1 / 5 < target["samples"] / (16 / 12 / (0.01 * MEAN) ** 2) < 5
    )  # sixteen replicates: a fifth of noise in the error


def test_a_bias_that_stays_makes_small_errors_unreachable(monkeypatch, tmp_path):
    targets = named(planted(monkeypatch, tmp_path, "biased"), "biased")["speed"]["targets"]
    assert [t["how"] for t in targets] == ["less-than", "never", "never"]
    assert "leave 0.002" in targets[-1]["why"]


def test_what_is_too_skewed_to_judge_asks_for_more_and_is_no_failure(monkeypatch, tmp_path):
    record = planted(monkeypatch, tmp_path, "skewed", samples=(64, 256))
    skewed = named(record, "skewed")
    assert skewed["outcome"] == "inconclusive"
    assert record["exit_code"] == 0
    for turn in range(6):  # the skewness of few samples is mostly too small, and so is what they ask for
        raised = re.search(
            r"Raise `replicates` to (\d+) at least, or the last of `samples` to (\d+);", record["advice"]
        )
        assert int(raised[1]) >= 4 * 16
        record = planted(monkeypatch, tmp_path / str(turn), "skewed", samples=(64, int(raised[2])))
        if named(record, "skewed")["outcome"] != "inconclusive":
            break
    assert named(record, "skewed")["outcome"] == "not rejected"
    assert record["advice"] == ""


def test_more_samples_never_take_less_time():
    def level(count, *seconds):
        rows = np.zeros((2, 10))
        return Level(
            count, rows, 2, np.zeros(10), np.empty(0), math.nan, np.array(seconds), 0.0, 2, 0.0, np.empty((0, 4))
        )

    found = [
        t.estimate.value
        for t in times_of([level(1, 2.0, 2.0), level(2, 8.0, 8.0), level(4, 2.0, 2.0), level(8, 9.0, 9.0)])
    ]
    assert found == pytest.approx([2, 4, 4, 9])
    untouched = times_of([level(1, 1.0, 3.0), level(2, 5.0, 4.0)])
    assert [t.seconds.tolist() for t in untouched] == [pytest.approx([1, 3]), pytest.approx([5, 4])]


@pytest.mark.parametrize("length", [1e-9, 200.0])
def test_events_too_rare_to_be_met_reject_nothing(length, tmp_path):
    """All paths end, or none does: nothing varies, where the exact variance is tiny and not 0."""
    ray = {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": length}
    scene = {"name": "s", "quantity": "transmittance", "medium": {"sigma_a": 0.25, "sigma_s": 0.25}, "ray": ray}
    study = study_from(
        {"samples": [1, 16, 256], "replicates": 4, "scenes": [{**scene, "estimators": kinds("analog", "ratio")}]}
    )
    record = drawn(study, tmp_path)
    assert [e["status"] for e in record["scenes"][0]["estimators"] if e["status"] == "rejected"] == []


def test_one_point_of_each_scrambling_rejects_nothing(tmp_path):
    ray = {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 4}
    scene = {"name": "s", "quantity": "transmittance", "medium": {"sigma_a": 0.25, "sigma_s": 0.25}, "ray": ray}
    for seed in range(12):  # of four hits or misses all are often alike
        study = study_from(
            {"samples": [1], "replicates": 4, "seed": seed, "scenes": [{**scene, "estimators": kinds("analog")}]}
        )
        assert drawn(study, tmp_path / str(seed))["exit_code"] == 0


def test_values_outside_of_what_was_declared_are_told(monkeypatch, tmp_path):
    monkeypatch.setattr(Planted, "bounds", lambda self, scene: (0.0, MEAN))
    right = named(planted(monkeypatch, tmp_path, "right"), "right")
    assert right["outcome"] == "rejected"
    assert next(f for f in right["findings"] if f["check"] == "bounds")["cause"] == "contract"


def test_the_scatter_of_rounds_is_the_interval_of_a_time():
    times = Times(np.array([1.0, 2.0, 4.0, np.nan])).estimate
    assert times.value == pytest.approx(2)
    assert times.high / times.value == pytest.approx(math.exp(9.9248 * math.log(2) / math.sqrt(3)), rel=1e-3)
    assert Times(np.array([3.0])).estimate.low == 0
    moods = np.exp(np.random.default_rng().normal(size=8))
    paired = Times(2 * moods).relative_to(Times(moods))
    assert (paired.low, paired.value, paired.high) == pytest.approx((2, 2, 2))


# ---- History


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    return drawn(study_from(SMALL), tmp_path_factory.mktemp("before"))


def test_nothing_changed_between_a_run_and_itself(record):
    found = compare(record, record)
    assert found["same_draws"]
    assert not found["worse"]
    assert found["text"] == "both are one and the same run"
    again = compare(record, {**record, "started": "later"})
    assert again["text"].startswith("nothing changed beyond noise")


def test_nothing_is_compared_where_nothing_is_in_both_runs(record):
    other = {**record, "scenes": [{**scene, "name": f"another {scene['name']}"} for scene in record["scenes"]]}
    assert compare(record, other)["text"] == "no estimator is in both runs: nothing was compared"
    part = compare(record, {**record, "scenes": record["scenes"][:1]})
    assert part["text"].startswith("nothing changed beyond noise")
    assert "; gone: grid / regular, grid / ratio, grid / march" in part["text"]


def test_a_change_that_its_interval_shows_and_the_verdict_does_not_is_called_perhaps(record):
    change = next(c for c in compare(record, record)["changes"] if c["estimator"] == "airlight")
    assert _perhaps([{**change, "became": [], "time": {"value": 0.6, "low": 0.45, "high": 0.8}}]) == (
        "; perhaps, and not beyond noise: lit / airlight, 0.6 [0.45, 0.8] of the time"
    )
    assert _perhaps([{**change, "became": ["faster"], "time": {"value": 0.6, "low": 0.45, "high": 0.8}}]) == ""
    assert _perhaps([{**change, "became": [], "time": {"value": 0.9, "low": 0.7, "high": 1.1}}]) == ""


def test_draws_are_the_same_whatever_the_checks_say_of_them(record):
    stricter = copy.deepcopy(record)
    stricter["digest"] = "0" * 64
    assert compare(record, stricter)["same_draws"]
    moments = stricter["scenes"][0]["estimators"][0]["moments"]
    moments["mean"] = float(np.nextafter(moments["mean"], np.inf))
    assert not compare(record, stricter)["same_draws"]


def test_other_random_numbers_change_nothing_beyond_noise(record, tmp_path):
    seed = int(np.random.default_rng().integers(2**40))
    print("seed", seed)
    found = compare(record, drawn(study_from({**SMALL, "seed": seed}), tmp_path))
    became = [word for change in found["changes"] for word in change["became"]]
    assert not found["same_draws"]
    assert not {"biased", "different", "noisier", "less noisy"} & set(became)


def on_a_slower_machine(e):
    for timing in e["speed"]["counts"]:
        timing |= {key: 1e6 * timing[key] for key in ("seconds", "low", "high")}


def slower(e):
    on_a_slower_machine(e)
    for timing in e["speed"]["counts"]:
        timing["fixed_work"] |= {key: 1e6 * timing["fixed_work"][key] for key in fixed_work.COLUMNS}


def noisier(e):
    e["variance"] = {k: (v * 2 if k in ("measured", "low", "high") else v) for k, v in e["variance"].items()}
    e["moments"]["m2"] *= 2


def biased(e):
    e["status"] = e["outcome"] = "rejected"


def different(e):
    e["moments"]["mean"] *= 1.5


@pytest.mark.parametrize("change", [slower, noisier, biased, different], ids=lambda f: f.__name__)
def test_changes_are_noticed(record, change):
    after = copy.deepcopy(record)
    change(estimator(after, "airlight"))
    found = compare(record, after)
    assert {c["estimator"]: c["became"] for c in found["changes"] if c["became"]} == {"airlight": [change.__name__]}
    assert found["worse"] == (change is not different)
    assert change.__name__ in found["text"]


def test_a_slower_machine_is_no_slower_estimator(record):
    after = copy.deepcopy(record)
    for scene in after["scenes"]:
        for e in scene["estimators"]:
            on_a_slower_machine(e)
    found = compare(record, after)
    assert found["mood"] == pytest.approx(1e6)
    assert not found["worse"]


@pytest.mark.parametrize("intensity", [1e-300, 1e-100, 1e-60, 1e-20, 1e20, 1e60, 1e150, 1e305])
def test_no_lamp_is_too_dim_or_too_bright(intensity, tmp_path):
    """What leaves the range of binary64 is told by name; what does not is judged as ever, in any unit."""
    scene = {
        **LIT,
        "light": {**LIT["light"], "intensity": intensity},
        "estimators": kinds("airlight", "mis", "marched-airlight"),
    }
    record = drawn(study_from({**SMALL, "samples": [16, 512], "scenes": [scene]}), tmp_path)
    json.dumps(record["scenes"][0]["estimators"][0]["moments"], allow_nan=False)
    assert ("leave binary64" in record["advice"]) == (not 1e-40 < intensity < 1e40)
    for each in record["scenes"][0]["estimators"]:
        far = any(finding["check"] == "range" for finding in each["findings"])
        assert far == (not 1e-40 < intensity < 1e40 and each["kind"] != "marched-airlight")
        assert not far or f"lit / {each['name'].removesuffix(' + sobol')}" in record["advice"]
        assert all("choose other units" in f["message"] for f in each["findings"] if f["check"] == "range")
        assert (each["outcome"] == "rejected") == (each["kind"] == "marched-airlight"), each["findings"]
