"""The zoo tells killed from survived, a right cause from a wrong one, and a right subject from a bug; a stopped run goes on."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from fogproof.cli.commands import cli
from fogproof.domains import Interval
from fogproof.errors import InvalidInputError
from fogproof.zoo import FOLDERS, bugs_of, select
from fogproof.zoo.bug import sampler_bug
from fogproof.zoo.laws import ones
from fogproof.zoo.matrix import counts, summary
from fogproof.zoo.running import ZooLog, run_bug, run_zoo

UNIT = Interval(0, 1)
ONE = {"dimensions": 1}


def bug(sample, causes=("wrong power",), folder="field", title="planted"):
    return sampler_bug(title, "nowhere", sample, ones, causes, UNIT, ONE, folder)


def of(rows):
    return counts(rows)[0]


def test_every_bug_has_a_name_of_its_own_a_source_and_a_cause():
    bugs = [b for folder in FOLDERS if folder != "mutants" for b in bugs_of(folder)]
    assert len({b.name for b in bugs}) == len(bugs) > 600
    for b in bugs:
        assert b.source
        assert " " not in b.name
        assert b.causes or b.equal or b.name.startswith("right/"), b.name


def test_bent_uniforms_are_killed_and_right_ones_are_not():
    bent = run_bug(bug(lambda u: u[:, 0] ** 1.5), 20_000, 1e-6, 1)
    assert (bent.status, bent.outcome, bent.needed) == ("killed", "rejected", 0.0)
    assert bent.checks
    assert of([bent]).killed == of([bent]).feasible == 1
    missed = run_bug(bug(lambda u: u[:, 0]), 20_000, 1e-6, 1)
    assert missed.status == "survived"
    assert not of([missed]).good


def test_a_wrong_cause_is_no_right_one():
    row = run_bug(bug(lambda u: u[:, 0] ** 1.5, causes=("hidden state",)), 20_000, 1e-6, 1)
    assert row.status == "killed"
    assert not row.named
    assert not of([row]).good


def test_a_right_subject_that_is_rejected_spoils_its_folder():
    right = run_bug(bug(lambda u: u[:, 0], causes=(), folder="right"), 20_000, 1e-6, 1)
    wrong = run_bug(bug(lambda u: u[:, 0] ** 1.5, causes=(), folder="right"), 20_000, 1e-6, 1)
    assert (right.status, wrong.status) == ("passed", "false-alarm")
    assert of([right]).good
    assert not of([right, wrong]).good


def test_what_raises_is_its_own_row():
    def sample(u):
        raise RuntimeError("no")

    rows = list(
        run_zoo(
            [bug(sample), bug(lambda u: u[:, 0] ** 1.5, title="other")], samples=20_000, alpha=1e-6, seed=1, workers=2
        )
    )
    assert sorted(row.status for row in rows) == ["error", "killed"]
    assert not of(rows).good


THREADS = json.loads((Path(__file__).parents[1] / "data" / "field-bug-threads.json").read_text())


@pytest.mark.parametrize("known", THREADS, ids=lambda known: known["id"])
def test_every_bug_of_the_field_that_is_known_is_planted(known):
    thread = known["thread"].partition("/")[2].lower()
    assert any(b.source.lower() == thread for b in bugs_of("field")), f"no bug cites {known['thread']}"


def test_every_misprint_is_planted():
    assert {b.title.split()[0] for b in bugs_of("errata")} == {f"E{i}" for i in range(1, 13)}


def test_what_no_test_can_see_is_infeasible_and_what_changes_nothing_is_equal():
    right = bug(lambda u: u[:, 0])
    assert run_bug(replace(right, needed=lambda: 1e9), 20_000, 1e-6, 1).status == "infeasible"
    assert run_bug(replace(right, needed=lambda: 1e3), 20_000, 1e-6, 1).status == "survived"
    assert run_bug(replace(right, needed=lambda: np.inf), 20_000, 1e-6, 1).status == "equal"
    equal = replace(bug(lambda u: u[:, 0] ** 1.5), equal=True)
    assert run_bug(equal, 20_000, 1e-6, 1).status == "false-alarm"  # what is called equal must be


def test_a_stopped_run_goes_on_and_other_settings_are_refused(tmp_path):
    log = ZooLog(tmp_path / "deep" / "zoo.jsonl", {"samples": 20_000})
    assert log.read() == ([], 0)
    row = run_bug(bug(lambda u: u[:, 0] ** 1.5), 20_000, 1e-6, 1)
    log.add(row)
    assert log.read() == ([row], 0)
    assert list(run_zoo([bug(np.exp)], samples=1000, alpha=1e-6, seed=1, workers=1, known=[row])) == []
    with pytest.raises(InvalidInputError, match="other settings"):
        ZooLog(log.path, {"samples": 1}).read()
    for foreign in ("{}\n{broken\n", "[1]\n", "my notes\n"):
        log.path.write_text(foreign)
        with pytest.raises(InvalidInputError, match="holds no rows"):
            log.read()


def test_damaged_rows_are_run_again_and_the_others_kept(tmp_path):
    """A machine that lost its power leaves zeros; one bad line is not worth hours of rows."""
    log = ZooLog(tmp_path / "zoo.jsonl", {"samples": 20_000})
    log.read()
    row = run_bug(bug(lambda u: u[:, 0] ** 1.5), 20_000, 1e-6, 1)
    log.add(row)
    good = log.path.read_text()
    line = good.splitlines()[1]
    assert row.status in line
    for damage in (
        "nonsense",
        "[" * 100_000,
        "{}",
        "3",
        line.replace(row.status, "splendid"),
        line.replace('"killed"', '"survived"'),
        line.replace('"needed": 0.0', '"needed": 1.0'),
        line[: len(line) // 2],
        "a\0b",
    ):
        for text in (f"{good}{damage}\n", f"{good.splitlines()[0]}\n{damage}\n{line}\n"):
            assert text != good + line + "\n"
            log.path.write_text(text)
            assert log.read() == ([row], 1), damage
    log.path.write_text(good + "\0" * 512)
    assert log.read() == ([row], 0)
    log.add(replace(row, name="another"))
    assert [kept.name for kept in log.read()[0]] == [row.name, "another"]


def test_a_line_before_the_rows_costs_none_and_rows_of_an_unknown_run_are_not_to_be_deleted(tmp_path):
    log = ZooLog(tmp_path / "zoo.jsonl", {"samples": 20_000, "seed": 3})
    log.read()
    row = run_bug(bug(lambda u: u[:, 0] ** 1.5), 20_000, 1e-6, 1)
    log.add(row)
    head, line = log.path.read_text().splitlines()
    for before in ("my notes", "{}", "[1]"):
        log.path.write_text(f"{before}\n{head}\n{line}\n")
        assert log.read() == ([row], 1)
        assert log.seed() == 3
        log.path.write_text(f"{before}\n{line}\n")
        with pytest.raises(InvalidInputError, match="has rows, but not the line before them") as told:
            log.read()
        assert "delete" not in str(told.value)
    log.path.write_text(f"{head.replace('3', '4')}\n{line}\n")  # a head changed by hand is that of other rows
    assert ZooLog(log.path, {"samples": 20_000, "seed": 4}).read() == ([], 1)


def test_the_goal_of_a_part_is_not_met_but_unfinished():
    row = run_bug(bug(lambda u: u[:, 0] ** 1.5), 20_000, 1e-6, 1)
    assert summary([row], {"field": 1, "errata": 3}).splitlines()[1].endswith("named: met")
    part = summary([row], {"field": 2, "errata": 3})
    assert "unfinished: 1 of 2" in part
    assert "unfinished: 0 of 3" in part
    assert " met" not in part
    assert "NOT met" in summary([replace(row, status="error")], {"field": 2})  # whatever the rest would say


def test_the_command_prints_rows_and_ends_with_what_it_found(tmp_path):
    arguments = ["zoo", "field/log-of-0", "--samples", "20000", "-o", str(tmp_path), "--json"]
    first = CliRunner().invoke(cli, arguments, standalone_mode=False)
    assert first.return_value == 0, first.output
    assert json.loads(first.stdout.splitlines()[0])["status"] == "killed"
    again = CliRunner().invoke(cli, arguments, standalone_mode=False)
    assert again.stdout == ""  # nothing is left to do
    with pytest.raises(InvalidInputError, match="no bug is called"):
        select(["feild"])


def test_a_run_that_goes_on_has_the_seed_of_its_rows(tmp_path):
    words = ["zoo", "errata/e2-murky-is-not-normalised", "--samples", "1000", "-o", str(tmp_path)]
    runs = [CliRunner().invoke(cli, [*words, *more]) for more in ([], [], ["--seed", "7"])]
    seeds = [run.stderr.rpartition("seed ")[2].strip() for run in runs[:2]]
    assert seeds[0] == seeds[1] != ""
    assert isinstance(runs[2].exception, InvalidInputError)
    assert "of other settings" in str(runs[2].exception)
