"""The page of a study says which estimator to take, lets no biased one win, and shows every number of its record."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree

import pytest
from report_records import HOSTILE, Page, case, entry, record, study

from fogproof.errors import InvalidInputError
from fogproof.reports import compare_exit_code, write_comparison, write_report
from fogproof.reports.charts.convergence import Convergence, ErrorCurve
from fogproof.reports.charts.pictures import render
from fogproof.reports.pages.study import headline
from fogproof.reports.records.studies import as_run, parse_study


def with_entries(*entries, **changes):
    wanted = study(**changes)
    wanted["scenes"][0]["estimators"] = list(entries)
    return wanted


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return write_report(study(), tmp_path_factory.mktemp("study"))


def test_answers_come_first_and_everything_is_told(page):
    words = " ".join(Page(page).words.split())
    words = words[: words.index("Answers")] + words[words.index("How it was run") :]  # without the contents
    order = [
        "1 of 6 estimators is biased",
        "Which is best in haze?",
        "What to do",
        "Since the earlier run",
        "Error against samples",
    ]
    assert [words.index(text) for text in order] == sorted(words.index(text) for text in order)
    for text in (
        "Exact is best.",
        "heavy tail: one realisation",
        "ZeroDivisionError",
        "19 of 20 batches",
        "mixed",
        "slower",
        "Gone: haze / old",
        "0.135335283237 ± 1e-17 W/(m^2 sr)",
        "100–10",
        "never",
        "no, as declared",
        "exactly 0.09",
        "What each scene needs",
        "d" * 64,
        "fogproof study lecture.toml",
    ):  # fmt: skip
        assert text in words or text.capitalize() in words, text


def test_figures_are_three_and_the_exact_estimator_is_in_none(page):
    read = Page(page)
    figures = sorted(path.name for path in (page.parent / "figures").iterdir())
    assert len(figures) == 6
    assert {Path(name).suffix for name in figures} == {".png", ".svg"}
    for name in figures:
        if name.endswith(".svg"):
            svg = (page.parent / "figures" / name).read_text()
            assert ">exact<" not in svg
            assert ("march" in svg) == (".samples" not in name)
            assert (">ratio<" in svg) == (".other" not in name)
            ElementTree.fromstring(svg)
    assert (
        read.html.count("Again: <code>fogproof study lecture.toml") == 2
    )  # the picture of an answer stands above them


def test_every_link_leads_somewhere(page):
    read = Page(page)
    ids = [attributes["id"] for _, attributes in read.elements if "id" in attributes]
    assert len(set(ids)) == len(ids)
    for link in read.all("a"):
        target = unquote(link["href"])
        assert target[1:] in ids if target.startswith("#") else (page.parent / target).is_file(), target


def test_rows_stand_in_the_order_of_the_ranking_and_say_who_is_biased(page):
    html = Page(page).html
    table = html[html.index("Processor time of one estimate with") :]
    rows = re.findall(
        r'<th scope="row"><a[^>]*><bdi>(.*?)</bdi></a></th>\n<td data-label="unbiased">.*?</span> ([^<]*)<', table
    )
    assert rows == [
        ("exact", "exact"),
        ("delta", "yes"),
        ("ratio", "not sure yet"),
        ("delta + sobol", "yes"),
        ("march", "no, as declared"),
        ("broken", "no: rejected"),
    ]


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        (
            with_entries(entry("a", status="rejected")),
            "Unfinished: 19 of 20 batches are drawn; 1 of 1 estimators is biased",
        ),
        (with_entries(entry("a")), "Unfinished: 19 of 20 batches are drawn"),
        (
            with_entries(entry("a"), batches={"planned": 3, "done": 3}, failures=[]),
            "Something came out worse than before",
        ),
        (
            with_entries(entry("a", status="inconclusive"), batches={}, failures=[], history=None),
            "No bias was found, but 1 of 1 estimators is not judged unbiased yet",
        ),
        (with_entries(entry("a"), batches={}, failures=[], history=None), "Every estimator came out as expected"),
        (with_entries(batches={}, failures=[], history=None), "No estimator was studied"),
    ],
)
def test_headline(wanted, words):
    parsed = parse_study(wanted)
    counts = dict.fromkeys(("surprise", "rejected", "error", "inconclusive", "known", "skipped", "passed"), 0)
    for one in as_run(parsed).cases:
        counts[one.status] += 1
    assert headline(parsed, counts)[0] == words


def test_hostile_names_are_shown_and_never_obeyed(tmp_path):
    entries = [entry(text) | {"warning": text, "reason": text} for text in HOSTILE.values()]
    read = Page(
        write_report(with_entries(*entries, name=HOSTILE["script"], question=HOSTILE["path"]), tmp_path / "study")
    )
    assert len(read.all("script")) == 1
    assert not read.all("img")
    assert "{{ 7 * 7 }}" in read.words
    assert {path.name for path in tmp_path.iterdir()} == {"study"}


def plant(*path, value):
    def change(target):
        for step in path[:-1]:
            target = target[step]
        target[path[-1]] = value

    return change


FAULTS = [
    (plant("scenes", 0, "estimators", 0, "status", value="best"), "scenes.0.estimators.0.status"),
    (plant("scenes", 0, "estimators", 0, "outcome", value="splendid"), "scenes.0.estimators.0.outcome"),
    (plant("scenes", 0, "estimators", 1, "counts", 0, "rmse", value="small"), "scenes.0.estimators.1.counts.0.rmse"),
    (plant("scenes", 0, "estimators", 1, "speed", "counts", value=[]), "must be as many as counts"),
    (plant("scenes", 0, "estimators", 1, "name", value="exact"), "twice"),
    (plant("history", value=[]), "history"),
    (plant("schema", value="fogproof/results/9"), "read it with the fogproof that wrote it"),
]


@pytest.mark.parametrize(("change", "words"), FAULTS)
def test_a_faulty_record_names_the_place_and_is_kept(change, words, tmp_path):
    wanted = study()
    change(wanted)
    with pytest.raises(InvalidInputError, match=re.escape(words)):
        write_report(wanted, tmp_path)
    assert (tmp_path / "results.json").exists()
    assert not (tmp_path / "index.html").exists()


def test_two_studies_are_compared(tmp_path):
    before = with_entries(entry("delta"), entry("ratio", status="rejected"))
    after = with_entries(entry("delta", status="rejected"), entry("ratio"))
    words = Page(write_comparison(before, after, tmp_path)).words
    assert "1 case came out worse" in words
    assert "1 mended" in words
    assert compare_exit_code(before, after) == 1
    assert compare_exit_code(after, after) == 0


@pytest.mark.parametrize(
    ("became", "first"), [(["slower"], "slower"), (["faster", "noisier"], "noisier"), (["less noisy"], "less noisy")]
)
def test_what_became_of_an_estimator_stands_in_counts_rows_and_a_table(became, first, tmp_path):
    after = study()
    after["history"]["changes"][0] |= {"became": became, "worse": became == ["slower"]}
    after["history"]["worse"] = became == ["slower"]
    page = Page(write_comparison(study(started="2026-01-30"), after, tmp_path))
    for word in became:  # each counts by itself
        assert re.search(rf"1 {word}, .*\d as before|, 1 {word}, \d as before", page.words)
    assert ("1 case came out worse" in page.words) == (became == ["slower"])
    (row,) = re.findall(r'<tr data-status="([^"]+)">\s*<th scope="row"><bdi>haze / delta</bdi>', page.html)
    assert row == first
    assert all(f'<span class="badge {word.replace(" ", "-")}">' in page.html for word in became)
    assert '<a href="#history">table</a>' in page.html
    table = page.html.split('<h2 id="history">')[1].split("</section>")[0]
    assert "haze / delta" in table
    assert ", ".join(became) in table


def test_a_study_and_a_verification_can_be_told_apart(tmp_path):
    words = Page(write_comparison(record([case("a", figures=False)]), study(), tmp_path)).words
    assert "1 gone" in words


def test_errors_of_many_magnitudes_stay_inside_the_figure():
    curve = ErrorCurve(
        "a", 0, (1.0, 10.0, 100.0), (1.0, 1e-9, 1e-18), (0.5, 0.0, 0.0), (2.0, float("inf"), 1e-17), (float("nan"),) * 3
    )
    picture = render(Convergence("samples", "error", (curve,), 0.99), "c", (560, 400))
    assert "predicted" not in picture.svg
    assert "nan" not in picture.svg
    assert "inf" not in picture.svg
    assert "1e-18" in picture.words
    assert "Below the picture, where an arrow points: a, down to 1e-18." in picture.words
    assert "a ↓" in picture.svg
    higher = replace(curve, error=(1.0, 0.1, 0.01), low=(0.5,) * 3, high=(2.0,) * 3)
    assert "Below" not in render(Convergence("samples", "error", (higher,), 0.99), "c", (560, 400)).words


def test_a_bound_of_a_speed_stays_on_its_line(tmp_path):
    """Narrow columns, as on paper, break words anywhere."""
    told = study()
    bounds = [{"value": 0.5, "low": 0.0, "high": 0.00827}, {"value": 0.5, "low": 0.0762, "high": 1e301}]
    for entry_of, bound in zip(told["scenes"][0]["estimators"][1:], bounds, strict=False):
        entry_of["speed"]["relative"] = bound
    html = Page(write_report(told, tmp_path)).html
    for text in ("&lt; 0.00827", "&gt; 0.0762"):
        assert f'<span class="yes">{text}</span>' in html


def test_in_a_crowd_the_best_keep_their_names_and_colours_and_the_rest_are_grey():
    """Curves of twenty estimators, the third the best for its time though others end lower."""
    effort, unknown = (1.0, 10.0, 100.0), (float("nan"),) * 3

    def curve(k, size, slow=1.0):
        error = tuple(size / math.sqrt(e) for e in effort)
        band = [tuple(f * e for e in error) for f in (0.8, 1.2)]
        return ErrorCurve(f"estimator {k}", k, tuple(slow * e for e in effort), error, *band, unknown)

    curves = tuple(curve(k, 0.9, 1e4) if k == 19 else curve(k, 1.0 + abs(k - 3)) for k in range(20))
    picture = render(Convergence("time [s]", "error", curves, 0.99), "c", (700, 400))
    named = {k for k in range(20) if f">estimator {k}<" in picture.svg}
    assert named in ({0, 1, 2, 3, 4, 5}, {1, 2, 3, 4, 5, 6})
    assert "The 14 others are grey." in picture.words
    assert picture.svg.count('opacity="0.06"') == 6  # where bands lie on each other they add up
    few = render(Convergence("time [s]", "error", curves[:12], 0.99), "c", (700, 400))
    assert all(f">estimator {k}<" in few.svg for k in range(12))
    assert "grey" not in few.words


def test_a_picture_of_small_errors_alone_shows_how_they_fall():
    curve = ErrorCurve(
        "march", 0, (1.0, 10.0, 100.0), (1e-5, 1e-6, 1e-7), (1e-5, 1e-6, 1e-7), (1e-5, 1e-6, 1e-7), (float("nan"),) * 3
    )
    assert "Below" not in render(Convergence("steps", "error", (curve,), 0.99), "c", (700, 400)).words


def test_the_answer_is_told_at_once(tmp_path):
    """To each error who is soonest, of all and of the unbiased, by their labels; what is open is called that."""
    told = study()
    first = {"name": "march", "how": "measured", "seconds": 8.2e-5, "beside": ["delta"], "waiting": []}
    other = {"name": "delta", "how": "less-than", "seconds": 7e-4, "beside": [], "waiting": []}
    late = {"name": "delta", "how": "extrapolated", "seconds": 2.5, "beside": [], "waiting": ["ratio", "delta + sobol"]}
    told["scenes"][0]["answer"] |= {
        "soonest": [
            {"error": 0.01, "all": first, "unbiased": other},
            {"error": 0.001, "all": first, "unbiased": None},
            {"error": 0.0001, "all": first, "unbiased": late},
        ],
        "notes": ["This is to be noted."],
    }
    labels = {entry["name"]: entry["label"] for entry in told["scenes"][0]["estimators"]}
    words = "".join(Page(write_report(told, tmp_path)).words.split())
    answers = words[words.index("Soonesttoanerror") : words.index("Whetheritisbiased")]
    for text in (
        f"1 % {labels['march']} in 82 µs not to be told from {labels['delta']}",
        f"{labels['march']}: ⚑ biased, as declared",
        f"Of the unbiased 1 % {labels['delta']} in less than 700 µs",
        "0.1 % nobody within these counts",
        f"0.01 % open: {labels['delta']} in about 2.5 s",
        f"{labels['ratio']}, {labels['delta + sobol']} are not there yet",
        "This is to be noted.",
    ):
        assert "".join(text.split()) in answers, text
    assert "Exactisbest." not in answers
    html = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert html.index("<h4>") < html.index(
        '<div class="beside">'
    )  # on narrow screens the picture follows the name of its scene


def test_what_to_raise_names_each_estimator_once_and_leads_to_it(tmp_path):
    """Names in the advice are links; the list of them is not told again."""
    page = Page(write_report(study(advice="Too few samples: haze / ratio. Raise `replicates` to 32."), tmp_path))
    (told,) = re.findall(r"<li>[^\n]*Whether it is biased cannot be said yet\.[^\n]*", page.html)
    (target,) = re.findall(r'<a href="#([^"]+)"><bdi>haze /<wbr> ratio</bdi></a>', told)
    assert any(unquote(target) == it.get("id") for it in page.all("div"))
    assert "Raise <code>replicates</code> to 32." in told
