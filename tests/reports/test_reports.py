"""What a run found is kept whole, read back exactly, and told the same by every file of the report."""

from __future__ import annotations

import csv
import json
import math
import os
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from report_records import HOSTILE, case, record, typical

import fogproof
from fogproof.errors import FogproofError, InvalidInputError
from fogproof.reports import read_record, write_report
from fogproof.reports.files import write_output
from fogproof.reports.pages.junit import write_junit
from fogproof.reports.pages.templates import keys
from fogproof.reports.records.runs import parse_record, write_csv, write_record
from fogproof.reports.text import anchor, file_stem
from fogproof.text import visible
from fogproof.verify import status_of
from fogproof.whole_files import write_file


def test_round_trip_keeps_every_value(tmp_path):
    wanted = typical(3)
    wanted["cases"][0]["verdict"]["findings"][0]["statistic"] = math.inf
    wanted["cases"][1]["verdict"]["findings"][0]["effect"] = math.nan
    wanted["cases"][2]["title"] = HOSTILE["surrogate"] + HOSTILE["control"]
    write_record(wanted, tmp_path)
    got = read_record(tmp_path)
    wanted["cases"][0]["verdict"]["findings"][0]["statistic"] = "inf"
    wanted["cases"][1]["verdict"]["findings"][0]["effect"] = "nan"
    assert got == wanted
    run = parse_record(got)
    assert run.cases[0].verdict.findings[0].statistic == math.inf
    assert math.isnan(run.cases[1].verdict.findings[0].effect)


def test_a_lone_surrogate_ends_no_page_and_no_file(tmp_path):
    half = HOSTILE["surrogate"]
    told = str(keys(half))
    assert told == "half \N{REPLACEMENT CHARACTER}"
    assert write_file(tmp_path / "page", half).read_text() == "half ?"
    assert write_output(tmp_path / "output", half).read_text() == "half ?"


def test_report_has_all_its_files(tmp_path):
    page = write_report(typical(1), tmp_path / "new" / "folder")
    folder = page.parent
    assert {path.name for path in folder.iterdir()} == {
        "index.html",
        "results.json",
        "results.csv",
        "junit.xml",
        "figures",
    }
    assert {path.suffix for path in (folder / "figures").iterdir()} == {".png", ".svg"}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "the folder has no results.json; 'fogproof verify --report "),
        (b"", "ends in the middle"),
        (b'{"schema": "fogproof/results/1", "cases": [{"na', "not JSON"),
        (b'{"schema": "fogproof/results/1", "cases": [', "ends in the middle"),
        (b"<html>", "not JSON"),
        (b"\xff\xfe", "not UTF-8"),
        (b"[" * 100_000, "not JSON"),
        (b"[]", "no text key 'schema'"),
        (b'{"schema": 1}', "no text key 'schema'"),
        (b'{"schema": "other/1"}', "was not written by fogproof"),
        (b'{"schema": "fogproof/results/2"}', "read it with the fogproof that wrote it"),
        (b'{"schema": "fogproof/results/1"}', "kind is missing"),
    ],
)
def test_unreadable_record_is_explained(tmp_path, content, words):
    if content is not None:
        (tmp_path / "results.json").write_bytes(content)
    with pytest.raises(InvalidInputError) as error:
        read_record(tmp_path)
    assert words in str(error.value)
    assert str(tmp_path) in str(error.value)


@pytest.mark.parametrize("value", ["NaN", "1e999", "-1e-6", '"nan"', "true", "[]"])
@pytest.mark.parametrize("name", ["alpha", "seconds"])
def test_a_figure_that_no_run_has_is_refused(tmp_path, name, value):
    write_record(record([case("a")]), tmp_path)
    file = tmp_path / "results.json"
    read_record(tmp_path)
    told = json.loads(file.read_text())
    for table, place in ((told, name), (told["cases"][0]["verdict"], f"cases.0.verdict.{name}")):
        kept, table[name] = table[name], "planted"
        file.write_text(json.dumps(told).replace('"planted"', value))
        rule = "must be a finite number >= 0" if name == "seconds" else "must be a number from 0 to 1"
        with pytest.raises(InvalidInputError, match=rf"results.json: {place} {rule}, got "):
            read_record(tmp_path)
        table[name] = kept
    told["cases"][0]["verdict"]["options"] = {"alpha": "theirs"}
    file.write_text(json.dumps(told))
    read_record(tmp_path)


@pytest.mark.parametrize("place", [("alpha",), ("cases", 0, "verdict", "alpha"), ("cases", 0, "verdict", "samples")])
def test_a_share_above_1_and_a_count_below_0_are_refused(tmp_path, place):
    write_record(record([case("a")]), tmp_path)
    told = table = read_record(tmp_path)
    for key in place[:-1]:
        table = table[key]
    table[place[-1]] = -1 if place[-1] == "samples" else 5
    write_record(told, tmp_path)
    with pytest.raises(InvalidInputError, match=rf"results.json: {'.'.join(map(str, place))} must be a .*, got "):
        read_record(tmp_path)


def test_alphas_beside_those_of_a_run_may_come_to_more_than_1(tmp_path):
    run = fogproof.Run(alpha=0.5, seed=1)
    for name in ("first", "second"):
        run.add(name, fogproof.check_estimator(lambda rng, n: rng.random(n), 0.5, samples=100, alpha=0.5, seed=1))
    write_record(run.record(), tmp_path)
    assert read_record(tmp_path)["alpha"] == 1.5


def test_what_is_no_folder_of_a_run_is_said_to_be_none(tmp_path):
    (tmp_path / "results.json").write_text('{"format": "fogproof-image-1"}')
    with pytest.raises(InvalidInputError, match="is a record of another kind"):
        read_record(tmp_path)
    with pytest.raises(InvalidInputError, match=r"results.json is a file: give the folder that it lies in"):
        read_record(tmp_path / "results.json")


def test_missing_folder_is_explained(tmp_path):
    with pytest.raises(InvalidInputError, match="there is no folder"):
        read_record(tmp_path / "nowhere")


def faults():
    def at(*path, value):
        def plant(target):
            for step in path[:-1]:
                target = target[step]
            target[path[-1]] = value

        return pytest.param(plant, path, id=".".join(map(str, path)))

    figure = ("cases", 0, "verdict", "findings", 0, "figure")
    return [
        at("seed", value="many"),
        at("cases", value={}),
        at("cases", 1, "status", value="accepted"),
        at("cases", 1, "name", value=None),
        at("cases", 0, "verdict", "findings", 0, "p_value", value="small"),
        at("cases", 0, "verdict", "findings", 0, "resolution", value=3),
        at(*figure, "kind", value="pie"),
        at(*figure, "edges", value=[0, 1]),
        at(*figure, "expected", value=[]),
        at("cases", 0, "verdict", "findings", 2, "figure", "z", value=[[1.0]]),
        at("cases", 2, "verdict", "findings", 0, "figure", "n", value=[]),
    ]


@pytest.mark.parametrize(("plant", "path"), faults())
def test_faulty_record_names_the_place(plant, path):
    target = record([case("a"), case("b"), case("c", kind="estimator")])
    plant(target)
    with pytest.raises(InvalidInputError) as error:
        parse_record(target)
    assert ".".join(map(str, path[:6])) in str(error.value)


def test_two_cases_of_one_name_are_refused():
    with pytest.raises(InvalidInputError, match="two cases have the name"):
        parse_record(record([case("a"), case("a")]))


def test_faulty_record_is_kept_all_the_same(tmp_path):
    broken = record([case("a", status="accepted")])
    with pytest.raises(InvalidInputError):
        write_report(broken, tmp_path)
    assert json.loads((tmp_path / "results.json").read_text())["cases"][0]["status"] == "accepted"


@pytest.mark.parametrize("place", ["file", "file/below", "null\0"])
def test_unwritable_folder_is_explained(tmp_path, place):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(FogproofError, match="cannot write"):
        write_report(record([]), tmp_path / place)
    assert (tmp_path / "file").read_text() == "in the way"


@pytest.mark.skipif(sys.platform == "win32" or os.geteuid() == 0, reason="root may write anywhere")
def test_read_only_folder_is_explained(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(FogproofError, match="Permission denied"):
        write_report(record([]), tmp_path)


def test_crash_while_writing_leaves_the_old_record(tmp_path, monkeypatch):
    write_record(record([case("a")]), tmp_path)

    def full(path, data):
        with open(path, "wb") as file:
            file.write(data[: len(data) // 2])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InvalidInputError, match="No space left"):
        write_record(record([case("b")]), tmp_path)
    assert read_record(tmp_path)["cases"][0]["name"] == "a"
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


def test_csv_has_one_row_a_case(tmp_path):
    wanted = typical(2)
    path = write_csv(parse_record(wanted), tmp_path)
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == [one["name"] for one in wanted["cases"]]
    for row, one in zip(rows, wanted["cases"], strict=True):
        assert row["status"] == one["status"]
        if one["verdict"]:
            assert float(row["p_value"]) == one["verdict"]["p_value"]
            assert float(row["resolution"]) == one["verdict"]["resolution"]["value"]
            assert row["samples"] == "1000000"
            assert row["twin_outcome"] == "rejected"
            assert row["twin_rejected_by"] == "mean cosine; chi-square in mu"
            assert row["terms"] == ("attenuation" if one["plan"] else "")
        else:
            assert row["p_value"] == row["outcome"] == ""


def test_csv_is_no_formula(tmp_path):
    path = write_csv(parse_record(record([case(name) for name in HOSTILE.values()])), tmp_path)
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert len(rows) == len(HOSTILE) + 1
    assert not any(cell.startswith(("=", "+", "-", "@")) for row in rows for cell in row)


def test_junit_tells_every_status(tmp_path):
    suite = ElementTree.parse(write_junit(parse_record(typical(2)), tmp_path)).getroot()[0]
    tests = {test.get("name"): test for test in suite.iter("testcase")}
    assert tests["mitsuba/hg/g=0.95"].find("failure").get("message").startswith("rejected")
    assert "p = 1e-40" in tests["mitsuba/hg/g=0.95"].find("failure").text
    assert "expected rejected" in tests["lecture/surprise"].find("failure").get("message")
    assert "3 points for 5 uniforms" in tests["lecture/error"].find("error").get("message")
    assert "pip install" in tests["lecture/skipped"].find("skipped").get("message")
    assert tests["airlight/equiangular"].find("skipped").get("type") == "inconclusive"
    assert "known finding" in tests["lecture/known"].find("system-out").text
    assert len(tests["hg/g=0.95"]) == 0
    counts = {name: int(suite.get(name)) for name in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": 9, "failures": 3, "errors": 1, "skipped": 2}


def test_junit_is_xml_for_hostile_names(tmp_path):
    cases = [case(name, "rejected", title=name, reason=name, figures=False) for name in HOSTILE.values()]
    suite = ElementTree.parse(write_junit(parse_record(record(cases, started="\x00")), tmp_path)).getroot()[0]
    names = [test.get("name") for test in suite.iter("testcase")]
    assert names == [visible(name) for name in HOSTILE.values()]
    assert "<script>document.title = 'owned'</script>" in names
    assert "bell␇ escape␛[31m null␀ return␍" in names


def test_names_of_files_are_safe_and_apart():
    stems = [file_stem(name, "check") for name in HOSTILE.values()] + [
        file_stem("a", "b"),
        file_stem("ab"),
        file_stem("a.b"),
    ]
    assert len({stem.lower() for stem in stems}) == len(stems)
    for stem in stems:
        assert stem.isascii()
        assert 0 < len(stem) <= 80
        assert not set(stem) & set('/\\:*?"<>| \0')
        assert stem[0] not in ".-"


def test_anchors_are_apart_and_plain_names_are_kept():
    assert anchor("hg/g=0.85") == "case/hg/g=0.85"
    anchors = [anchor(name) for name in HOSTILE.values()]
    assert len(set(anchors)) == len(anchors)
    assert all(len(it) <= 90 and not any(c.isspace() for c in it) for it in anchors)


@pytest.mark.parametrize(
    ("outcome", "expected", "status"),
    [
        ("not rejected", "not rejected", "passed"),
        ("not rejected", "rejected", "surprise"),
        ("rejected", "not rejected", "rejected"),
        ("rejected", "rejected", "known"),
        ("inconclusive", "not rejected", "inconclusive"),
        ("inconclusive", "rejected", "surprise"),
    ],
)
def test_a_status_follows_from_the_verdict(outcome, expected, status):
    assert status_of(outcome, expected) == status


def test_a_status_beside_another_verdict_is_refused():
    table = typical(1)
    number = next(k for k, case in enumerate(table["cases"]) if case["status"] == "rejected")
    table["cases"][number]["status"] = "passed"
    with pytest.raises(InvalidInputError, match=rf"cases\.{number}\.status must be 'rejected', as its verdict is"):
        parse_record(table)


def test_junit_fails_a_case_whose_twin_was_not_rejected(tmp_path):
    seen = {"outcome": "not rejected", "checks": [], "p_value": 0.3, "samples": 20_000}
    cases = [case("blind", twin_result=seen, figures=False), case("sharp", figures=False)]
    suite = ElementTree.parse(write_junit(parse_record(record(cases)), tmp_path)).getroot()[0]
    blind, sharp = suite.iter("testcase")
    assert "broken twin (g with the wrong sign): not rejected" in blind.find("failure").text
    assert len(sharp) == 0
    assert suite.get("failures") == "1"


def test_junit_lists_what_a_stopped_run_did_not_come_to(tmp_path):
    stopped = record([case("done", figures=False)], asked=["done", "later"], state="interrupted")
    suite = ElementTree.parse(write_junit(parse_record(stopped), tmp_path)).getroot()[0]
    assert [test.get("name") for test in suite.iter("testcase")] == ["done", "later"]
    assert suite.find("testcase[@name='later']/skipped").get("type") == "gone"
    assert (suite.get("tests"), suite.get("skipped")) == ("2", "1")
