"""Templates of pages: escaping everywhere, text made visible, one style and one script inside each page."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from fogproof.reports.text import anchor, label
from fogproof.text import duration as in_words
from fogproof.text import p_value, visible

if TYPE_CHECKING:
    import jinja2
    from markupsafe import Markup

    from fogproof.checks import Verdict
    from fogproof.reports.records.runs import Case

_STATUSES = {"surprise": "!", "rejected": "✗", "error": "⚠", "inconclusive": "?", "known": "⚑", "skipped": "–"}
_CHANGES = {"worse": "✗", "mended": "✓", "changed": "≠", "new": "+", "gone": "–", "same": "="}
_BECAME = {"biased": "✗", "noisier": "↑", "slower": "↑", "different": "≠", "less noisy": "↓", "faster": "↓"}
_TRUST = {"kept": "✓", "broken": "✗", "caught": "✓", "blind": "✗"}
_MARKS = _STATUSES | {"passed": "✓"} | _CHANGES | _BECAME | _TRUST


def fill(template: str, **values: Any) -> str:
    """Return the page that `template` makes of `values`; text among them is shown as it is, whatever it holds."""
    script = _asset("page.js")
    allowed = "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    page = _environment().get_template(template)
    return page.render(style=_asset("page.css"), script=script, script_hash=allowed, **values)


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
    environment.globals["marks"] = _MARKS
    environment.filters |= {
        "anchor": anchor,
        "label": label,
        "number": number,
        "p_value": lambda p: "–" if p is None else p_value(p),
        "grouped": grouped,
        "sentence": sentence,
        "cases": cases,
        "duration": duration,
        "units_kept": units_kept,
        "keys": keys,
        "breakable": breakable,
        "linked": linked,
        "smallest_p": smallest_p,
    }
    return environment


@cache
def _asset(name: str) -> str:
    return (Path(__file__).parent / name).read_text(encoding="utf-8")


def number(value: float | None) -> str:
    """Return three digits of `value`, a dash for None."""
    return "–" if value is None else f"{value:.3g}"


def duration(seconds: float) -> str:
    """Return a time with a unit that suits it."""
    return in_words(seconds, "\N{NARROW NO-BREAK SPACE}")


def smallest_p(verdict: Verdict | None) -> str:
    """Return the smallest p-value of what rejected, or of all if nothing did; "certain" where that took no chance at all."""
    if verdict is None:
        return "–"
    ps = [finding.p_value for finding in verdict.findings if finding.outcome == verdict.outcome == "rejected"]
    known = [p for p in ps if p is not None]
    if ps:
        return p_value(min(known)) if known else "certain"
    return "–" if verdict.p_value is None else p_value(verdict.p_value)


def units_kept(text: str) -> str:
    """Return `text` with every unit of time and per cent kept on the line of its number."""
    return re.sub(r"(?<=\d) (?=%|(?:ns|µs|ms|s|min|h)\b)", "\N{NARROW NO-BREAK SPACE}", text)


def breakable(name: str) -> Markup:
    """Return a name that may go on in the next line after a slash or an underscore, and so breaks no word."""
    from markupsafe import Markup, escape

    return Markup(re.sub("([/_])(?=.)", r"\1<wbr>", str(escape(visible(name)))))


def linked(text: str, cases: Sequence[Case]) -> Markup:
    """Return a text in which the names of cases lead to their sections."""
    from markupsafe import Markup

    names = sorted({case.name for case in cases}, key=len, reverse=True)
    parts = re.split(f"({'|'.join(map(re.escape, names))})", text) if names else [text]
    link = Markup('<a href="#{}"><bdi>{}</bdi></a>')
    return Markup("").join(
        link.format(quote(anchor(part)), breakable(part)) if part in names else keys(part) for part in parts
    )


def keys(text: str) -> Markup:
    """Return a text in which what stands in back-ticks is code."""
    from markupsafe import Markup, escape

    return Markup(re.sub("`([a-z]+)`", r"<code>\1</code>", str(escape(visible(text)))))


def grouped(value: float) -> str:
    """Return a count with thin spaces between thousands."""
    return f"{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def sentence(text: str) -> str:
    """Return `text` with a capital and a full stop."""
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")


def cases(n: int) -> str:
    """Return "1 case", "2 cases"."""
    return "1 case" if n == 1 else f"{n} cases"
