"""The page shows every case of a record, safely and completely, and stands alone: no network, no script needed."""

from __future__ import annotations

import re
import struct
from dataclasses import replace
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
import pytest
from report_records import HOSTILE, Page, bins_figure, case, mean_figure, record, typical, verdict, z_figure

from fogproof.checks.json_values import jsonable
from fogproof.checks.verdict import EffectInterval, Finding, Resolution, Verdict
from fogproof.reports import write_report
from fogproof.reports.charts.findings import parse_figure
from fogproof.reports.charts.p_values import PValueHistogram, PValues
from fogproof.reports.charts.pictures import render
from fogproof.reports.charts.resolutions import Resolutions
from fogproof.reports.pages import page as page_module
from fogproof.reports.pages.page import headline, write_page
from fogproof.reports.records.runs import parse_record
from fogproof.text import visible


@pytest.fixture(scope="module")
def typical_page(tmp_path_factory):
    return write_report(typical(4), tmp_path_factory.mktemp("typical"))


@pytest.fixture(scope="module")
def hostile_page(tmp_path_factory):
    statuses = ["rejected", "passed", "skipped", "error"] * 5
    cases = []
    for text, status in zip(HOSTILE.values(), statuses, strict=False):
        one = case(text, status, figures=status == "rejected")
        for key in ("title", "reason", "source", "reference", "twin", "reproduce"):
            one[key] = text
        for finding in one["verdict"]["findings"] if one["verdict"] else ():
            finding["check"] = finding["message"] = text
            finding["resolution"] = finding["resolution"] and finding["resolution"] | {"kind": text}
            if finding["figure"] and finding["figure"]["kind"] == "bins":
                finding["figure"]["label"] = text
        cases.append(one)
    hostile = "<script>alert(1)</script>"
    return write_report(
        record(cases, command=hostile, environment={hostile: hostile}, started=hostile, kind=hostile),
        tmp_path_factory.mktemp("hostile"),
    )


def test_page_stands_alone(typical_page):
    page = Page(typical_page)
    used = [
        value for _, attributes in page.elements for name, value in attributes.items() if name in ("src", "xlink:href")
    ]
    assert all(value.startswith(("data:", "#")) for value in used)
    assert [link["href"] for link in page.all("link")] == ["data:,"]
    assert "@import" not in page.html
    assert not re.search(r"url\((?!#)", page.html)
    policy = next(meta["content"] for meta in page.all("meta") if "http-equiv" in meta)
    assert policy.startswith("default-src 'none'")


def test_every_link_leads_somewhere(typical_page):
    page = Page(typical_page)
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(set(ids)) == len(ids)
    for link in page.all("a"):
        target = unquote(link["href"])
        assert target[1:] in ids if target.startswith("#") else (typical_page.parent / target).is_file()
    for reference in re.findall(r'url\(#([^)]+)\)|xlink:href="#([^"]+)"', page.html):
        assert "".join(reference) in ids


def test_page_tells_the_verdict_first_and_every_case(typical_page):
    page = Page(typical_page)
    run = parse_record(typical(4))
    assert page.words.index("3 of 11 cases came out wrong") < page.words.index("What to do") < page.words.index("hg/g")
    for one in run.cases:
        assert page.words.count(one.name) >= 3
        assert one.reproduce in page.words
    for text in (
        "pip install 'fogproof[mitsuba]'",
        "factor of two",
        "3 points for 5 uniforms",
        "not installed",
        "2.4.0",
    ):
        assert text in page.words


def test_figures_of_failures_are_drawn_and_a_pass_has_one(typical_page):
    page = Page(typical_page)
    figures = {path.name for path in (typical_page.parent / "figures").iterdir()}
    drawn = [name for name in figures if name.startswith("mitsuba-hg-g=0.95")]
    assert len(drawn) == 4
    assert len([name for name in figures if name.startswith("hg-g=0.95")]) == 2
    assert len(page.all("figure")) == 2 + 4 + 2 + 1 + 1 + 2 + 2
    labels = [it["aria-label"] for it in page.all("div") if it.get("role") == "img"]
    assert len(labels) == len(page.all("figure"))
    assert all(len(label) > 40 for label in labels)


def test_figures_beyond_the_budget_are_linked(tmp_path, monkeypatch):
    monkeypatch.setattr(page_module, "INLINE_BYTES", 0)
    page = Page(write_page(parse_record(record([case("a", "rejected")])), tmp_path))
    assert len(page.all("figure")) == 1
    assert page.words.count("Figure beside this page") == 2


def test_hostile_text_is_shown_and_never_obeyed(hostile_page):
    page = Page(hostile_page)
    assert len(page.all("script")) == 1
    assert not page.all("img")
    assert not [name for _, attributes in page.elements for name in attributes if name.startswith("on")]
    for text in HOSTILE.values():
        assert " ".join(visible(text).split()) in " ".join(page.words.split())
    assert "{{ 7 * 7 }}" in page.words
    assert "\u202e" not in page.html
    inside = {path.resolve() for path in hostile_page.parent.rglob("*")}
    assert all(hostile_page.parent.resolve() in path.parents for path in inside)


def test_hostile_files_are_well_formed(hostile_page):
    for path in (hostile_page.parent / "figures").glob("*.svg"):
        ElementTree.parse(path)
    for path in (hostile_page.parent / "figures").glob("*.png"):
        assert path.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("statuses", "words"),
    [
        ([], "No case was run"),
        (["passed"], "The one case came out as expected"),
        (["passed", "known", "skipped"], "All 2 cases judged came out as expected"),
        (["skipped", "skipped"], "Nothing was judged: all 2 cases skipped"),
        (["inconclusive", "passed"], "Nothing was rejected, but 1 of 2 cases is inconclusive"),
        (["error", "inconclusive"], "1 of 2 cases could not be judged"),
        (["rejected", "surprise", "error"], "2 of 3 cases came out wrong"),
    ],
)
def test_headline(statuses, words, tmp_path):
    run = parse_record(record([case(f"case {i}", status, figures=False) for i, status in enumerate(statuses)]))
    assert headline(run)[0] == words
    assert words in Page(write_page(run, tmp_path)).words


@pytest.mark.parametrize(
    ("finding", "words"),
    [
        (Finding("c", "not rejected", "m", 0.5, 0.1, exact=True), "p = 0.5 "),
        (Finding("c", "not rejected", "m", 0.5, 0.1, exact=False), "p = 0.5 (upper bound)"),
        (Finding("c", "rejected", "why", 0.0, float("nan"), True, float("inf"), -float("inf")), "statistic inf"),
        (Finding("c", "not rejected", "m", resolution=Resolution("bias", 0.25, 0.01)), "A bias above 0.25 would"),
        (Finding("c", "not rejected", "m", resolution=Resolution("bias", 0.0, 0.0)), "A bias above 0 would"),
    ],
)
def test_finding_is_told_whole(finding, words, tmp_path):
    status = "passed" if finding.outcome == "not rejected" else "rejected"
    one = case("a") | {"status": status, "verdict": Verdict((finding,), 1e-6, 10, 1).to_dict()}
    assert words in Page(write_report(record([one]), tmp_path)).words.replace("\n", " ").replace("\xa0", " ")


BLIND = {"outcome": "not rejected", "checks": [], "samples": 1_000_000}
LUCKLESS = {"outcome": "error", "checks": [], "samples": 0, "reason": "ZeroDivisionError: division by zero"}


@pytest.mark.parametrize(
    ("changes", "oracle", "first", "words"),
    [
        ({}, {}, "The one case came out as expected", "rejected by mean cosine, chi-square in mu, p = 1e-80"),
        ({"twin_result": None}, {}, "The one case came out as expected", "They were not run here"),
        ({"twin_result": BLIND}, {}, "1 of 1 broken twins was not rejected", "a pass of this case proves nothing"),
        ({"twin_result": LUCKLESS}, {}, "1 of 1 broken twins was not rejected", "ZeroDivisionError"),
        (
            {},
            {"broken": 2},
            "The oracle broke its promise on 2 of 22 proven values",
            "further from the truth than it says",
        ),
        (
            {},
            {"share": "inf", "broken": 22},
            "The oracle broke its promise on 22 of 22 proven values",
            "broken 22 times",
        ),
    ],
)
def test_what_makes_verdicts_worth_trusting_is_told(changes, oracle, first, words, tmp_path):
    one = record([case("a", kind="estimator", figures=False, **changes)])
    one["oracle"] = [one["oracle"][0] | oracle]
    told = " ".join(Page(write_report(one, tmp_path)).words.split())
    assert headline(parse_record(one))[0] == first
    assert words in told
    assert "What each scene needs" in told
    assert "nothing is gained along the ray" in told
    assert ("Nothing. How small" in told) == (first == "The one case came out as expected")
    assert ("<failure" in (tmp_path / "junit.xml").read_text()) == ("twin" in first)


def test_older_records_without_twins_and_oracle_are_read(tmp_path):
    old = record([case("a")])
    del old["oracle"], old["cases"][0]["twin_result"], old["cases"][0]["plan"]
    words = Page(write_report(old, tmp_path)).words
    assert "The oracle's own error" not in words
    assert "They were not run here" in words


def test_every_figure_says_how_to_make_it_again(typical_page):
    page = Page(typical_page)
    captions = re.findall(r"<figcaption>(.*?)</figcaption>", page.html, re.S)
    assert len(captions) == len(page.all("figure"))
    assert all("Again: <code>fogproof verify" in caption for caption in captions)


def test_cause_place_and_size_of_a_misfit_are_told(tmp_path):
    finding = (
        Finding("c", "rejected", "m", 1e-9, 0.1, effect=0.5).located("mu below 0: too many").because("wrong measure")
    )
    finding = replace(finding, interval=EffectInterval(0.4, 0.6, 0.99))
    one = case("a", "rejected") | {
        "verdict": Verdict((finding,), 1e-6, 10, 1, cause="wrong measure", reproduce="f(1)").to_dict()
    }
    words = " ".join(Page(write_report(record([one]), tmp_path)).words.split())
    for text in ("Likely cause: wrong measure", "Where: mu below 0: too many.", "in [0.4, 0.6] at 99%", "f(1)"):
        assert text in words


def test_page_tells_the_diagnosis_what_is_unchecked_and_how_sure_it_is(tmp_path):
    found = [Finding(name, "rejected", "it is wrong") for name in ("normalisation", "domain", "scan", "ends")]
    told = Verdict(tuple(found), 1e-6, 10, 1, cause="normalisation", diagnosis="a factor .98", unchecked=("weights",))
    one = case("a", "rejected", title="") | {"verdict": told.to_dict()}
    words = " ".join(Page(write_report(record([one]), tmp_path)).words.split())
    for text in (
        "Likely cause: normalisation; a factor .98",
        "Unchecked: weights",
        "certain normalisation, domain and 2 more",
    ):
        assert text in words
    assert "(blank)" not in words


def test_page_of_known_finding_leaves_its_p_values_out(tmp_path):
    write_report(record([case("a", "known")]), tmp_path)
    assert not (tmp_path / "figures" / "p-values.svg").exists()
    write_report(record([case("a", "rejected")]), tmp_path)
    assert (tmp_path / "figures" / "p-values.svg").exists()


def figures(rng):
    yield from ((name, make(rng)) for name, make in (("bins", bins_figure), ("z", z_figure), ("mean", mean_figure)))
    yield "one bin", {"kind": "bins", "edges": [0, "inf"], "label": "t", "expected": [1], "observed": [1]}
    yield (
        "whole line",
        {
            "kind": "bins",
            "edges": ["-inf", 0, "inf"],
            "label": "x",
            "expected": [0.5, 0.5],
            "observed": [0.25, 0.75],
        },
    )
    yield "atom", {"kind": "bins", "edges": [0, 1, 1], "label": "t", "expected": [0.5, 0.5], "observed": [0.4, 0.6]}
    yield "empty", {"kind": "bins", "edges": [0, 1, 2], "label": "t", "expected": [0, 1], "observed": [0, 1]}
    yield "impossible", {"kind": "bins", "edges": [0, 1, 2], "label": "t", "expected": [0, 1], "observed": ["nan", 1]}
    yield "blind", {"kind": "z-map", "edges": [[0, 1], [0, "inf"]], "labels": ["a", "b"], "z": [["nan"]]}
    yield "huge", {"kind": "z-map", "edges": [[0, 1, 2], [0, 1]], "labels": ["a", "b"], "z": [["inf"], [1e9]]}
    yield "one mean", {"kind": "mean", "reference": 1, "error": 0, "n": [10], "mean": [1], "stderr": [0]}
    yield (
        "lost mean",
        {
            "kind": "mean",
            "reference": "inf",
            "error": 0,
            "n": [1, 10],
            "mean": [1, "nan"],
            "stderr": ["inf", "nan"],
        },
    )


def drawings():
    for name, figure in figures(np.random.default_rng(3)):
        yield pytest.param(parse_figure(jsonable(figure)), id=name)
    yield pytest.param(PValues((0.5,)), id="one p-value")
    yield pytest.param(PValueHistogram((0.5,)), id="histogram of one p-value")
    yield pytest.param(PValueHistogram((0.0, 1.0, *np.linspace(0.01, 0.99, 500))), id="histogram")
    yield pytest.param(PValues((0.0, 1e-300, 1.0, *np.linspace(0.01, 0.99, 50))), id="tiny p-values")
    yield pytest.param(Resolutions((("a", "bias", 1e-3),)), id="one resolution")
    yield pytest.param(Resolutions(tuple((f"$x_{i}", "_kind", 10.0**-i) for i in range(60))), id="many resolutions")


@pytest.mark.parametrize("drawing", list(drawings()))
def test_every_figure_is_png_and_svg_and_says_what_it_shows(drawing):
    picture = render(drawing, "stem")
    assert struct.unpack(">II", picture.png[16:24])[0] >= 800
    ElementTree.fromstring(picture.svg)
    ElementTree.fromstring(picture.on_page)
    assert picture.words.endswith(".")
    assert render(drawing, "stem") == picture


def test_figure_colours_follow_the_page_and_not_the_text():
    svg = render(Resolutions((('#0072b2 id="x"', "bias", 1e-3),)), "a").on_page
    assert "var(--cool)" in svg
    assert "#0072b2 id=" in svg.replace("&quot;", '"')


def test_large_report_stays_small(tmp_path, monkeypatch):
    drawn = render(parse_figure(jsonable(z_figure(np.random.default_rng(1)))), "shared")
    monkeypatch.setattr(page_module, "render", lambda drawing, stem, *size: drawn)
    monkeypatch.setattr(type(drawn), "save", lambda picture, folder: None)
    rng = np.random.default_rng(1)
    shared = verdict(rng, "sampler", "rejected").to_dict()
    cases = [case(f"case/{i}", "skipped") | {"status": "rejected", "verdict": shared} for i in range(500)]
    page = write_page(parse_record(record(cases)), tmp_path)
    assert page.stat().st_size < 15e6
