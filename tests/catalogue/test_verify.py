"""A run costs nobody else's results: errors stay in their case, verdicts depend on seed and name alone, nothing is silent."""

import dataclasses
import json

import pytest

from fogproof import catalogue, verify
from fogproof.analytic.proven.golden import golden_values
from fogproof.errors import InvalidInputError
from fogproof.reports import write_report

FAST = ["free-path/surface/near", "transmittance/analog/thin", "fog/analog/haze"]


def run(names, **options):
    results = list(verify.run(verify.select(names), **{"seed": 11, "alpha": 1e-6, "workers": 2, **options}))
    return {result.case.name: result for result in results}


def findings(result):
    return [(f.check, f.p_value, f.effect) for f in result.verdict.findings]


def test_workers_and_company_do_not_change_a_verdict():
    two, one, alone = run(FAST), run(FAST, workers=1), run(FAST[:1])
    assert [findings(two[name]) for name in FAST] == [findings(one[name]) for name in FAST]
    assert findings(alone[FAST[0]]) == findings(two[FAST[0]])
    assert alone[FAST[0]].verdict.alpha == two[FAST[0]].verdict.alpha


def test_cases_and_seeds_have_streams_of_their_own():
    seeds = {verify.case_seed(seed, case.name) for seed in (1, 2, 3) for case in catalogue.all_cases()}
    assert len(seeds) == 3 * len(catalogue.all_cases())


def _with(monkeypatch, case):
    cases = (*catalogue.all_cases(), case)
    monkeypatch.setattr(verify.selection, "all_cases", lambda: cases)


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda: 1 / 0, "ZeroDivisionError"),
        (lambda: type("S", (), {"draw": staticmethod(lambda rng, n: "no")})(), "draw must return"),
    ],
)
def test_a_case_that_fails_is_its_own_result_and_the_others_go_on(monkeypatch, make, reason):
    broken = dataclasses.replace(verify.select(["fog/analog/haze"])[0], name="broken", make=make)
    _with(monkeypatch, broken)
    results = run(["broken", *FAST])
    assert results["broken"].status == "error"
    assert reason in results["broken"].reason
    assert all(results[name].status == "passed" for name in FAST)
    assert verify.exit_code(results.values()) == 1


def test_a_renderer_that_is_missing_is_a_visible_row(monkeypatch):
    monkeypatch.setattr(verify.running.importlib.util, "find_spec", lambda name: None)
    results = run(["mitsuba/hg/g=0.6", FAST[0]])
    assert results["mitsuba/hg/g=0.6"].status == "skipped"
    assert "python -m pip install 'fogproof[mitsuba]'" in results["mitsuba/hg/g=0.6"].reason
    assert verify.exit_code(results.values()) == 0


def test_an_expected_finding_is_known_and_a_surprise_in_either_direction_fails(monkeypatch):
    good = verify.select(["fog/analog/haze"])[0]
    bad = dataclasses.replace(good, name="known", make=good.twin.make, expected="rejected", reason="planted")
    surprise = dataclasses.replace(good, name="mended", expected="rejected", reason="mended upstream")
    cases = (*catalogue.all_cases(), bad, surprise)
    monkeypatch.setattr(verify.selection, "all_cases", lambda: cases)
    results = run(["known", "mended"])
    assert results["known"].status == "known"
    assert results["mended"].status == "surprise"
    assert verify.exit_code([results["known"]]) == 0
    assert verify.exit_code([results["mended"]]) == 1


@pytest.mark.parametrize(
    ("outcome", "status"), [("inconclusive", "known"), ("not rejected", "passed"), ("rejected", "rejected")]
)
def test_what_nobody_can_tell_is_declared(outcome, status):
    assert verify.status_of(outcome, "inconclusive") == status


def test_every_case_of_the_catalogue_can_stand_in_a_record(tmp_path):
    """What a case declares is what records and pages know: a run of hours is not lost at its end."""
    declared = {case.expected: case for case in catalogue.all_cases()}
    assert set(declared) == {"not rejected", "rejected", "inconclusive"}
    results = [
        verify.Result(case, verify.status_of(case.expected, case.expected), None, "nobody ran it", 0.1)
        for case in declared.values()
    ]
    record = verify.record(results, alpha=1e-6, seed=1, seconds=1.0, command="", started="2026-01-01T00:00:00Z")
    write_report(record, tmp_path)


def test_twins_are_run_on_demand_and_change_nothing_else():
    plain, both = run(FAST), run(FAST, twins=True)
    assert all(result.twin is None for result in plain.values())
    for name in FAST:
        twin = both[name].twin
        assert findings(both[name]) == findings(plain[name])
        assert twin.outcome == "rejected"
        assert twin.checks
        assert both[name].good


def test_a_twin_that_is_not_rejected_fails_the_run_and_so_does_one_that_cannot_run(monkeypatch):
    good = verify.select(["fog/analog/haze"])[0]
    same = dataclasses.replace(good, name="blind", twin=dataclasses.replace(good.twin, make=good.make))
    broken = dataclasses.replace(good, name="broken", twin=dataclasses.replace(good.twin, make=lambda: 1 / 0))
    monkeypatch.setattr(verify.selection, "all_cases", lambda: (*catalogue.all_cases(), same, broken))
    results = run(["blind", "broken"], twins=True)
    assert results["blind"].twin.outcome == "not rejected"
    assert results["blind"].twin.samples == good.samples
    assert results["broken"].twin.outcome == "error"
    assert "ZeroDivisionError" in results["broken"].twin.reason
    for result in results.values():
        assert result.status == "passed"
        assert not result.good
        assert verify.exit_code([result]) == 1


def test_inconclusive_alone_has_an_exit_code_of_its_own():
    result = run(FAST[:1])[FAST[0]]
    assert verify.exit_code([dataclasses.replace(result, status="inconclusive"), result]) == 3


def test_the_record_is_json_and_reproduces():
    results = run(FAST)
    record = verify.record(results.values(), seed=11, alpha=1e-6, command="fogproof verify", started="now", seconds=1.0)
    again = json.loads(json.dumps(record, allow_nan=False))
    assert [case["name"] for case in again["cases"]] == [c.name for c in catalogue.all_cases() if c.name in FAST]
    assert "--seed 11" in again["cases"][0]["reproduce"]
    assert "--alpha" not in again["cases"][0]["reproduce"]
    plans = {case["name"]: case["plan"] for case in again["cases"]}
    assert plans["fog/analog/haze"]["solver"] == "ambient_fog"
    assert plans["free-path/surface/near"] is None
    assert sum(row["values"] for row in again["oracle"]) == len(golden_values())
    other = verify.record(results.values(), seed=11, alpha=0.01, command="", started="now", seconds=1.0)
    assert other["cases"][0]["reproduce"].endswith("--alpha 0.01")


def test_an_unknown_case_is_explained():
    with pytest.raises(InvalidInputError, match=r"no case is called 'free-path/thn'; did you mean free-path/thin"):
        verify.select(["free-path/thn"])
