"""The page: a run as one self-contained `index.html`, the verdict first, then what to do, then every case."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any, get_args

from fogproof.checks.verdict import Finding
from fogproof.reports.charts.findings import parse_figure
from fogproof.reports.charts.p_values import FEWEST, PValueHistogram, PValues
from fogproof.reports.charts.pictures import Picture, render
from fogproof.reports.charts.resolutions import Resolutions
from fogproof.reports.pages.summaries import blind, by_cause, catches, needs, plain, systems
from fogproof.reports.pages.templates import cases as some_cases
from fogproof.reports.pages.templates import fill
from fogproof.reports.records.runs import Case, RunRecord, Status
from fogproof.reports.records.stability import stability_beside
from fogproof.reports.text import file_stem
from fogproof.whole_files import write_file

INLINE_BYTES = 5_000_000
"""Figures stand inside the page, the worst cases' first, up to this many bytes; further ones are linked."""

STATUSES: tuple[Status, ...] = get_args(Status)
"""From what needs attention to what does not: the order of the page."""


OUTCOMES = ("rejected", "inconclusive", "not rejected")
"""The order in which the findings of a case are told."""


@dataclass(frozen=True)
class Shown:
    """A figure as the page has it: `svg` is empty if it is only linked."""

    picture: Picture
    svg: str


def write_page(run: RunRecord, folder: str | Path) -> Path:
    """Write `folder/index.html` and its figures as `folder/figures/*.png` and `*.svg`; return the page's path.

    A pass has its first figure alone: the others are figures of noise. Findings about the same data share one figure.
    """
    folder = Path(folder)
    cases = sorted(run.cases, key=lambda case: STATUSES.index(case.status))
    overview = {name: render(drawing, name, size) for name, drawing, size in _overview(run)}
    for picture in overview.values():
        picture.save(folder / "figures")
    shown: dict[tuple[str, int], Shown] = {}
    room = INLINE_BYTES
    for case in cases:
        drawn = _figures(case)
        for index, finding, figure in drawn[:1] if case.status == "passed" else drawn:
            stem = file_stem(case.name, finding.check, str(index))
            picture = render(parse_figure(figure), stem)
            picture.save(folder / "figures")
            svg = picture.on_page
            room -= len(svg)
            shown[case.name, index] = Shown(picture, svg if room >= 0 else "")
    stability, unreadable = stability_beside(folder)
    page = fill(
        "page.html",
        kind=run.kind,
        run=run,
        cases=cases,
        overview=overview,
        shown=shown,
        counts={status: sum(case.status == status for case in cases) for status in STATUSES},
        systems=systems(run),
        by_cause=by_cause(cases),
        twins=[case for case in cases if case.twin_result],
        blind=[case for case in cases if blind(case)],
        catches=catches(run),
        needs=needs(run.cases),
        known=[case for case in cases if case.expected == "rejected"],
        stability=stability,
        unreadable=unreadable,
        headline=headline(run),
        tone=_tone(run),
    )
    return write_file(folder / "index.html", page)


def headline(run: RunRecord) -> tuple[str, str]:
    """Return the verdict of a run in words: a sentence that stands alone, and the counts behind it."""
    count = {status: sum(case.status == status for case in run.cases) for status in STATUSES}
    wrong, of = count["rejected"] + count["surprise"], f"of {some_cases(len(run.cases))}"
    judged, unsure = count["passed"] + count["known"], count["inconclusive"]
    twins = [case for case in run.cases if case.twin_result]
    missed = sum(blind(case) for case in twins)
    broken = sum(row.broken for row in run.oracle)
    if not run.cases:
        first = "No case was run"
    elif wrong:
        first = f"{wrong} {of} came out wrong"
    elif count["error"]:
        first = f"{count['error']} {of} could not be judged"
    elif broken:
        first = f"The oracle broke its promise on {broken} of {sum(row.values for row in run.oracle)} proven values"
    elif missed:
        first = f"{missed} of {len(twins)} broken twins {'was' if missed == 1 else 'were'} not rejected"
    elif unsure:
        first = f"Nothing was rejected, but {unsure} {of} {'is' if unsure == 1 else 'are'} inconclusive"
    elif not judged:
        first = (
            f"Nothing was judged: {'the one case' if len(run.cases) == 1 else f'all {len(run.cases)} cases'} skipped"
        )
    else:
        who = "The one case" if judged == 1 else f"All {judged} cases"
        first = f"{who}{' judged' if judged < len(run.cases) else ''} came out as expected"
    words = {"surprise": "not as declared", "error": "failed to run", "known": "as declared"}
    words["passed"] = "not rejected"
    counts = [f"{count[status]} {words.get(status, status)}" for status in STATUSES if count[status]]
    counts += [f"{len(twins) - missed} of {len(twins)} broken twins rejected"] if twins else []
    if run.unfinished:
        first = f"{run.unfinished} cases were run" + (f"; {first[0].lower()}{first[1:]}" if run.cases else "")
    return first, ", ".join(counts) or "The record is empty"


def _tone(run: RunRecord) -> str:
    found = {case.status for case in run.cases}
    if found & {"rejected", "surprise", "error"} or any(row.broken for row in run.oracle) or any(map(blind, run.cases)):
        return "bad"
    return "care" if run.unfinished or "inconclusive" in found or not found & {"passed", "known"} else "good"


def _figures(case: Case) -> list[tuple[int, Finding, dict[str, Any]]]:
    """Return (index, finding, figure) of the different figures of a case, in the order in which the page tells the findings."""
    findings = list(enumerate(case.verdict.findings if case.verdict is not None else ()))
    findings.sort(key=lambda pair: OUTCOMES.index(pair[1].outcome))
    found: list[tuple[int, Finding, dict[str, Any]]] = []
    for index, finding in findings:
        if finding.figure is not None and all(finding.figure != figure for _, _, figure in found):
            found.append((index, finding, finding.figure))
    return found


def _overview(run: RunRecord) -> Iterable[tuple[str, Any, tuple[float, float]]]:
    """Yield the figures of the whole run: only subjects that ought to be right have uniform p-values."""
    right = [case.verdict for case in run.cases if case.verdict is not None and case.expected == "not rejected"]
    exact = tuple(
        f.p_value for v in right for f in v.findings if f.exact and f.p_value is not None and 0 <= f.p_value <= 1
    )
    if len(exact) >= FEWEST:
        yield "p-value-histogram", PValueHistogram(exact), (560, 340)
    if exact:
        yield "p-values", PValues(exact), (560, 420)
    passes = tuple(
        (case.name, plain(case.verdict.resolution.kind), size)
        for case in run.cases
        if case.status == "passed" and case.verdict is not None and case.verdict.resolution
        for size in [case.verdict.resolution.relative]
        if size is not None and 0 < size < inf
    )
    if passes:
        drawing = Resolutions(passes)
        yield "resolutions", drawing, drawing.size
