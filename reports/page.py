"""The page: a run as one self-contained `index.html`, the verdict first, then what to do, then every case."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from fogproof.reports.files import write_file
from fogproof.reports.findings import parse_figure
from fogproof.reports.p_values import PValues
from fogproof.reports.pictures import Picture, render
from fogproof.reports.records import Run, Status
from fogproof.reports.resolutions import Resolutions
from fogproof.reports.text import anchor, file_stem, label, visible

if TYPE_CHECKING:
    import jinja2

INLINE_BYTES = 5_000_000
"""Figures stand inside the page, the worst cases' first, up to this many bytes; further ones are linked."""

STATUSES: tuple[Status, ...] = get_args(Status)
"""From what needs attention to what does not: the order of the page."""

_MARKS = {
    "surprise": "!",
    "rejected": "✗",
    "error": "⚠",
    "inconclusive": "?",
    "known": "⚑",
    "skipped": "–",
    "passed": "✓",
}


@dataclass(frozen=True)
class Shown:
    """A figure as the page has it: `svg` is empty if it is only linked."""

    picture: Picture
    svg: str


def write_page(run: Run, folder: str | Path) -> Path:
    """Write `folder/index.html` and its figures as `folder/figures/*.png` and `*.svg`; return the page's path.

    A pass has its first figure alone, and as SVG alone: figures of noise are not worth the time that they take.
    """
    folder = Path(folder)
    cases = sorted(run.cases, key=lambda case: STATUSES.index(case.status))
    room = INLINE_BYTES
    shown: dict[tuple[str, int], Shown] = {}
    overview = {name: render(drawing, name, size) for name, drawing, size in _overview(run)}
    for picture in overview.values():
        picture.save(folder / "figures")
    for case in cases:
        drawn = [(i, f) for i, f in enumerate(case.verdict.findings if case.verdict else ()) if f.figure is not None]
        passed = case.status == "passed"
        for index, finding in drawn[:1] if passed else drawn:
            stem = file_stem(case.name, finding.check, str(index))
            picture = render(parse_figure(finding.figure or {}), stem, png=not passed)
            picture.save(folder / "figures")
            svg = picture.on_page
            room -= len(svg)
            shown[case.name, index] = Shown(picture, svg if room >= 0 else "")
    text = (
        _environment()
        .get_template("page.html")
        .render(
            run=run,
            cases=cases,
            overview=overview,
            shown=shown,
            counts={status: sum(case.status == status for case in cases) for status in STATUSES},
            headline=headline(run),
            worst=_tone(run),
            marks=_MARKS,
            style=_asset("page.css"),
            script=_asset("page.js"),
            script_hash=_csp_hash(_asset("page.js")),
        )
    )
    return write_file(folder / "index.html", text)


def headline(run: Run) -> tuple[str, str]:
    """Return the verdict of a run in words: a sentence that stands alone, and one that qualifies it."""
    count = {status: sum(case.status == status for case in run.cases) for status in STATUSES}
    wrong, of = count["rejected"] + count["surprise"], f"of {_cases(len(run.cases))}"
    judged = count["passed"] + count["known"]
    if not run.cases:
        first = "No case was run"
    elif wrong:
        first = f"{wrong} {of} came out wrong"
    elif count["error"]:
        first = f"{count['error']} {of} could not be judged"
    elif count["inconclusive"]:
        first = f"Nothing was rejected, but {count['inconclusive']} {of} {_are(count['inconclusive'])} inconclusive"
    elif not judged:
        first = f"Nothing was judged: all {_cases(len(run.cases))} were skipped"
    else:
        first = f"{'The one case' if judged == 1 else f'All {judged} cases'} judged came out as expected"
    words = {
        "rejected": "rejected",
        "surprise": "not as declared",
        "error": "failed to run",
        "inconclusive": "inconclusive",
        "known": "rejected as declared",
        "skipped": "skipped",
        "passed": "not rejected",
    }
    second = ", ".join(f"{count[status]} {words[status]}" for status in STATUSES if count[status])
    return first, second


def _overview(run: Run) -> Iterable[tuple[str, Any, tuple[float, float]]]:
    """Yield the figures of the whole run: only subjects that ought to be right have uniform p-values."""
    right = [case.verdict for case in run.cases if case.verdict and case.expected == "not rejected"]
    exact = tuple(f.p_value for v in right for f in v.findings if f.exact and f.p_value is not None)
    if exact:
        yield "p-values", PValues(exact), (5.6, 4.2)
    passes = tuple(
        (case.name, case.verdict.resolution.kind, case.verdict.resolution.value)
        for case in run.cases
        if case.status == "passed" and case.verdict and case.verdict.resolution and case.verdict.resolution.value > 0
    )
    if passes:
        drawing = Resolutions(passes)
        yield "resolutions", drawing, drawing.size


@cache
def _environment() -> jinja2.Environment:
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda value: visible(value) if type(value) is str else value,
    )
    environment.filters |= {
        "anchor": anchor,
        "label": label,
        "number": number,
        "grouped": grouped,
        "sentence": sentence,
        "cases": _cases,
    }
    return environment


def number(value: float | None) -> str:
    """Return two or three digits of `value`, a dash for None."""
    return "–" if value is None else f"{value:.3g}"


def grouped(value: float) -> str:
    """Return a count with thin spaces between thousands."""
    return f"{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def sentence(text: str) -> str:
    """Return `text` with a capital and a full stop."""
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")


def _tone(run: Run) -> str:
    found = {case.status for case in run.cases}
    bad, unsure = found & {"rejected", "surprise", "error"}, not found & {"passed", "known"} or "inconclusive" in found
    return "bad" if bad else "care" if unsure else "good"


def _cases(n: int) -> str:
    return "1 case" if n == 1 else f"{n} cases"


def _are(n: int) -> str:
    return "is" if n == 1 else "are"


@cache
def _asset(name: str) -> str:
    return (Path(__file__).parent / name).read_text(encoding="utf-8")


def _csp_hash(script: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
