"""What a study says is true of what was drawn: merged moments are those of the whole, intervals hold what they claim to, and an
estimator that is wrong, in whatever way, wins no ranking."""

import copy
import json
import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from study_fixtures import LIT, SMALL, drawn, estimator, kinds, study_from

from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import binomial_at_most
from fogproof.contracts import Reference
from fogproof.study.aggregate import Level, merged, pooled
from fogproof.study.batches import TAIL, TAIL_SHARE, _largest, moments_of
from fogproof.study.cells import cells_of
from fogproof.study.convergence import Z, falling, rmse, slope
from fogproof.study.history import compare
from fogproof.study.methods import table as methods
from fogproof.study.speed import time_of

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


def test_the_slope_and_its_interval():
    rng, counts = np.random.default_rng(), np.array([100, 1000, 10_000, 100_000])
    freedom = np.full(4, 16.0)
    exact = slope(counts, 3 / np.sqrt(counts), freedom)
    assert exact.value == pytest.approx(-0.5, abs=1e-12)
    noise = np.sqrt(rng.chisquare(16, size=(3000, 4)) / 16)
    found = [slope(counts, noise_ / counts**0.5, freedom) for noise_ in noise]
    covered(3000, sum(s.low <= -0.5 <= s.high for s in found), 0.98)
    assert slope(counts[:1], np.ones(1), freedom[:1]) is None


@pytest.mark.parametrize("order", [1, 2, 4])
def test_the_order_of_a_march_and_its_floor(order):
    counts = 10 * 2 ** np.arange(6)
    clean = 0.5 * counts.astype(float) ** -order
    found = falling(counts, clean, np.zeros(6))
    assert found.order.value == pytest.approx(order)
    assert not found.reached
    rounding = np.full(6, clean[3] * 1.01)
    found = falling(counts, np.maximum(clean, clean[3] / 3) * np.array([1, -1, 1, -1, 1, 1]), rounding)
    assert found.order.value == pytest.approx(order)
    assert found.reached
    assert falling(counts, np.full(6, 0.2), np.zeros(6)).reached


# ---- Planted estimators: a study of one scene whose estimators are the test's own.


@dataclass(frozen=True)
class Planted:
    """An estimator of MEAN with the law `what`."""

    what: str
    quantity: ClassVar[str] = "transmittance"
    axis: ClassVar[str] = "samples"
    expected: ClassVar[str] = "not rejected"
    bias: ClassVar[str] = ""
    dimensions: ClassVar[None] = None

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
    assert right["slope"]["expected"] == -0.5
    assert record["answers"][0]["best"] == "planted (what = sharp)"
    # Twenty-five times less variance in about the same time; the machine may be busy, but not by such a factor.
    assert right["speed"]["relative"]["value"] < 0.9
    target = right["speed"]["targets"][0]
    assert target["samples"] == pytest.approx((SIGMA / (0.01 * MEAN)) ** 2)
    assert target["seconds"] == pytest.approx(target["samples"] * right["speed"]["cpu"]["value"])
    assert record["exit_code"] == 0


WRONG = {
    "biased": ("mean", "rejected"),
    "wrongly sure": ("variance", "rejected"),
    "dependent": ("scatter of replicates", "rejected"),
    "broken": ("finite values", "rejected"),
    "heavy": ("mean", "inconclusive"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_estimator_wins_nothing(monkeypatch, tmp_path, what):
    record = planted(monkeypatch, tmp_path, what, "right")
    check, outcome = WRONG[what]
    wrong = named(record, what)
    assert next(f for f in wrong["findings"] if f["check"] == check)["outcome"] == outcome
    assert wrong["outcome"] == outcome
    answer = record["scenes"][0]["answer"]
    assert answer["best"] == "planted (what = right)"
    if outcome == "rejected":
        assert wrong["speed"]["efficiency"] is None
        assert wrong["speed"]["rank"] is None
        assert wrong["name"] in answer["out"]
        assert record["exit_code"] == 1
    else:
        assert answer["ranking"][-1] == wrong["name"]
        assert "infinite variance suspected" in wrong["warning"]
        assert record["exit_code"] == 3
    assert planted(monkeypatch, tmp_path / "alone", what)["scenes"][0]["answer"]["best"] is None


def test_a_bias_that_stays_makes_small_errors_unreachable(monkeypatch, tmp_path):
    targets = named(planted(monkeypatch, tmp_path, "biased"), "biased")["speed"]["targets"]
    assert [t["seconds"] is None for t in targets] == [False, True, True]
    assert "stays" in targets[-1]["how"]


def test_the_time_of_a_realisation_is_a_median():
    level = Level(10, np.zeros((1, 10)), 1, np.zeros(10), np.empty(0), 1.0, np.array([3.0, 1, 2, 100]), np.ones(4), 0.0)
    assert time_of(level).value == 2.5
    assert time_of(level).low == 1
    assert time_of(level).high == 100


# ---- History


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    return drawn(study_from(SMALL), tmp_path_factory.mktemp("before"))


def test_nothing_changed_between_a_run_and_itself(record):
    found = compare(record, record)
    assert found["same_draws"]
    assert not found["worse"]
    assert found["text"] == "nothing changed beyond noise"


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


def slower(e):
    e["speed"]["cpu"] = {k: (v * 1e6 if isinstance(v, float) else v) for k, v in e["speed"]["cpu"].items()}


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
            slower(e)
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
    for each in record["scenes"][0]["estimators"]:
        far = any(finding["check"] == "range" for finding in each["findings"])
        assert far == (not 1e-40 < intensity < 1e40 and each["kind"] != "marched-airlight")
        assert (each["outcome"] == "rejected") == (each["kind"] == "marched-airlight"), each["findings"]
