"""What changed between two runs is told rightly: nothing that came out worse hides among what did not."""

from __future__ import annotations

import pytest
from report_records import HOSTILE, Page, case, record, typical

from fogproof.errors import InvalidInputError
from fogproof.reports import write_comparison
from fogproof.reports.pages.comparison import exit_code, pair_cases
from fogproof.reports.records.runs import parse_record
from fogproof.text import visible


def run(**statuses):
    return record([case(name, status, figures=False) for name, status in statuses.items() if status])


@pytest.mark.parametrize(
    ("before", "after", "change"),
    [
        ("passed", "passed", "same"),
        ("rejected", "rejected", "same"),
        ("passed", "rejected", "worse"),
        ("known", "surprise", "worse"),
        ("inconclusive", "error", "worse"),
        ("skipped", "rejected", "worse"),
        (None, "rejected", "worse"),
        (None, "passed", "new"),
        ("rejected", "passed", "mended"),
        ("surprise", "known", "mended"),
        ("passed", "skipped", "changed"),
        ("rejected", "error", "changed"),
        ("passed", None, "gone"),
        ("rejected", None, "gone"),
    ],
)
def test_change(before, after, change):
    pairs = pair_cases(parse_record(run(a=before, b="passed")), parse_record(run(b="passed", a=after)))
    assert {pair.name: pair.change for pair in pairs} == {"a": change, "b": "same"}


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ({"a": "passed"}, {"a": "rejected"}, "1 case came out worse"),
        ({"a": "passed", "b": "rejected"}, {"a": "passed", "b": "rejected"}, "but 1 case is wrong"),
        ({"a": "rejected"}, {"a": "error"}, "but 1 case is wrong"),
        ({"a": "passed"}, {"a": "passed"}, "Every case came out as before"),
        ({"a": "rejected"}, {"a": "passed"}, "Nothing came out worse"),
        ({}, {}, "Both records are empty"),
    ],
)
def test_headline(before, after, words, tmp_path):
    assert words in Page(write_comparison(run(**before), run(**after), tmp_path)).words


def test_page_puts_the_worst_first_and_tells_what_differs(tmp_path):
    before, after = typical(2), typical(3) | {"seed": 7, "environment": {"numpy": "3.0", "cores": 2}}
    after["cases"][-1]["seconds"] = 3.4
    page = Page(write_comparison(before, after, tmp_path))
    rows = [row["data-status"] for row in page.all("tr") if "data-status" in row]
    assert rows == sorted(rows, key=["worse", "changed", "gone", "mended", "new", "same"].index)
    assert rows.count("new") == 1
    places = {row["href"] for row in page.all("a")}
    assert {"#todo", "#cases", "#whole", "#run"} <= places
    for text in ("1.2 → 3.4", "2.4.0", "3.0", "The seeds differ"):
        assert text in page.words
    assert {path.name for path in tmp_path.iterdir()} == {"comparison.html", "before.json", "after.json", "figures"}
    assert len(list((tmp_path / "figures").iterdir())) == 4


def test_hostile_names_are_shown(tmp_path):
    one = record([case(name, figures=False) for name in HOSTILE.values()])
    page = Page(write_comparison(one, one | {"command": HOSTILE["script"]}, tmp_path))
    assert len(page.all("script")) == 1
    for text in HOSTILE.values():
        assert " ".join(visible(text).split())[:40] in " ".join(page.words.split())


def test_faulty_record_is_named_and_nothing_written(tmp_path):
    with pytest.raises(InvalidInputError, match="after: cases is missing"):
        write_comparison(record([]), {key: value for key, value in record([]).items() if key != "cases"}, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_what_was_certain_is_not_given_a_p_value_or_a_resolution(tmp_path):
    before, after = run(a="passed"), run(a="rejected")
    for finding in after["cases"][0]["verdict"]["findings"]:
        finding["p_value"] = None if finding["outcome"] == "rejected" else finding["p_value"]
    assert "→ certain" in Page(write_comparison(before, after, tmp_path)).words
    assert not list((tmp_path / "figures").glob("comparison-resolution*"))


@pytest.mark.parametrize(
    ("before", "after", "code"),
    [
        ({"a": "passed"}, {"a": "passed"}, 0),
        ({"a": "rejected"}, {"a": "rejected"}, 0),
        ({"a": "rejected"}, {"a": "passed", "b": "passed"}, 0),
        ({"a": "passed"}, {"a": "rejected"}, 1),
        ({"a": "passed"}, {"b": "passed"}, 3),
        ({"a": "passed", "b": "passed"}, {"b": "error"}, 1),
    ],
)
def test_exit_code(before, after, code):
    assert exit_code(parse_record(run(**before)), parse_record(run(**after))) == code


def test_a_stopped_run_is_not_compared_with_0():
    stopped = run(a="passed") | {"state": "interrupted", "asked": ["a", "b"]}
    assert exit_code(parse_record(run(a="passed")), parse_record(stopped)) == 3


@pytest.mark.parametrize(("kind", "shown"), [("sampler", True), ("estimator", False)])
def test_resolutions_are_compared_where_they_mean_the_same(tmp_path, kind, shown):
    before, after = (record([case("a", kind=kind, figures=False)]) for kind in ("sampler", kind))
    write_comparison(before, after, tmp_path)
    assert (tmp_path / "figures" / "comparison-resolution.svg").exists() == shown
