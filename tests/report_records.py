"""Records of runs that never happened (every status, every figure, hostile text), and a reader of pages."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.checks.verdict import Finding, Resolution, Verdict

HOSTILE = {
    "script": "<script>document.title = 'owned'</script>",
    "attribute": '"><img src=x onerror=alert(1)>',
    "path": "../../../../etc/passwd",
    "absolute": "/etc/passwd",
    "drive": "C:\\nul",
    "hidden": ".bashrc",
    "long": "very-long-" * 1000,
    "emoji": "🌫️ fog 👩‍🚀",
    "right-to-left": "ضباب كثيف",
    "override": "abc\u202egnp.exe",
    "control": "bell\x07 escape\x1b[31m null\x00 return\r",
    "surrogate": "half \ud83d",
    "formula": '=HYPERLINK("x")',
    "jinja": "{{ 7 * 7 }}{% raw %}",
    "entity": "&lt;b&gt; ]]>",
    "math": "$\\frac{1}{$ _under",
    "blank": " ",
    "upper": "HG",
    "lower": "hg",
}


def bins_figure(rng: np.random.Generator, shift: float = 0.0, n: int = 32, samples: int = 100_000) -> dict[str, Any]:
    edges = np.linspace(0, 4, n + 1)
    cdf = 1 - np.exp(-edges)
    expected = np.diff(cdf)
    expected[-1] += 1 - cdf[-1]
    wrong = expected * (1 + shift * np.linspace(-1, 1, n))
    observed = rng.multinomial(samples, wrong / wrong.sum()) / samples
    edges = [*edges[:-1].tolist(), float("inf")]
    return {"kind": "bins", "edges": edges, "label": "t [m]", "expected": expected, "observed": observed}


def z_figure(rng: np.random.Generator, shift: float = 0.0) -> dict[str, Any]:
    mu, phi = np.linspace(-1, 1, 17), np.linspace(-np.pi, np.pi, 33)
    z = rng.normal(size=(16, 32)) + shift * np.linspace(-8, 8, 16)[:, None]
    return {"kind": "z-map", "edges": [mu, phi], "labels": ["mu", "phi [rad]"], "z": z}


def mean_figure(rng: np.random.Generator, shift: float = 0.0) -> dict[str, Any]:
    n = (10 ** np.linspace(2, 6, 17)).astype(int)
    walk = np.cumsum(rng.normal(size=n.size) * np.sqrt(np.diff(n, prepend=0)))
    return {
        "kind": "mean",
        "reference": 0.135335,
        "error": 1e-12,
        "n": n,
        "mean": 0.135335 + shift + 0.3 * walk / n,
        "stderr": 0.3 / np.sqrt(n),
    }


def verdict(
    rng: np.random.Generator, kind: str = "sampler", outcome: Any = "not rejected", figures: bool = True
) -> Verdict:
    shift = 0.25 if outcome == "rejected" else 0.0
    sampler = kind == "sampler"
    figure = (bins_figure if sampler else mean_figure)(rng, shift * (1 if sampler else 0.01)) if figures else None
    p = 1e-40 if outcome == "rejected" else float(rng.uniform())
    first = Finding(
        check="goodness of fit of the distance" if sampler else "mean against the reference",
        outcome=outcome,
        message="the shares of 32 bins do not fit their probabilities"
        if shift
        else "the shares fit their probabilities",
        p_value=p,
        alpha=2.5e-8,
        exact=True,
        statistic=31.4159,
        effect=0.0012,
        resolution=Resolution("Kolmogorov distance" if sampler else "relative bias", float(rng.uniform(1, 9)) * 1e-3),
        figure=figure,
    )
    second = Finding("finite and in the domain", "not rejected", "all points lie in the domain", None, None, False)
    third = Finding(
        "directions",
        outcome,
        "cells over mu and phi",
        float(rng.uniform()),
        2.5e-8,
        figure=z_figure(rng, shift) if figures else None,
    )
    findings = (first, second, third) if sampler else (first, second)
    return Verdict(findings, 1e-7, 1_000_000, 123, 0.8, {"precision": "float64"})


def case(name: str, status: str = "passed", rng: np.random.Generator | None = None, **changes: Any) -> dict[str, Any]:
    rng = rng or np.random.default_rng(1)
    outcome = {"rejected": "rejected", "known": "rejected", "inconclusive": "inconclusive"}.get(status, "not rejected")
    judged = status not in ("skipped", "error")
    kind = changes.get("kind", "sampler")
    reasons = {
        "known": "rejects directions at the poles in single precision",
        "surprise": "the published pdf lacks a factor of two",
        "skipped": "mitsuba is not installed; install it with: python -m pip install 'fogproof[mitsuba]'",
        "error": "ValueError: the sampler returned 3 points for 5 uniforms",
    }
    figures = changes.pop("figures", True)
    return {
        "name": name,
        "title": f"Directions and distances of {name[:60]}",
        "kind": kind,
        "status": status,
        "expected": "rejected" if status in ("known", "surprise") else "not rejected",
        "reason": reasons.get(status, ""),
        "source": "Henyey & Greenstein 1941",
        "reference": "analytic.phase_pdf, analytic.phase_cdf",
        "twin": "g with the wrong sign",
        "reproduce": f"fogproof verify '{name[:60]}' --seed 123",
        "seconds": 1.2,
        "verdict": verdict(rng, kind, outcome, figures).to_dict() if judged else None,
    } | changes


def record(cases: list[dict[str, Any]], **changes: Any) -> dict[str, Any]:
    return {
        "schema": "fogproof/results/1",
        "kind": "verify",
        "fogproof": "0.1.0",
        "environment": {"python": "3.11.2", "numpy": "2.4.0", "mitsuba": None, "platform": "Linux", "cores": 2},
        "command": "fogproof verify --report build/report",
        "seed": 123,
        "alpha": 1e-6,
        "started": "2026-01-31T12:00:00Z",
        "seconds": 31.2,
        "exit_code": 0,
        "cases": cases,
    } | changes


def typical(passes: int = 34) -> dict[str, Any]:
    """A run with every status and some passes."""
    rng = np.random.default_rng(7)
    names = [f"hg/g={g:g}" for g in np.linspace(-0.95, 0.95, passes)]
    kinds = ["sampler", "estimator"]
    cases = [case(name, rng=rng, kind=kinds[i % 3 == 2]) for i, name in enumerate(names)]
    cases.append(case("mitsuba/hg/g=0.95", "rejected", rng))
    cases.append(case("transmittance/ratio tracking", "rejected", rng, kind="estimator"))
    cases.append(case("airlight/equiangular", "inconclusive", rng, kind="estimator"))
    cases += [case(f"lecture/{status}", status, rng) for status in ("known", "surprise", "skipped", "error")]
    return record(cases, exit_code=1)


VOID = {"meta", "link", "br", "img", "input", "hr"}


class Page(HTMLParser):
    """The elements of a page; opening and closing tags must match."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.open: list[str] = []
        self.words = ""
        self.html = path.read_text(encoding="utf-8")
        self.feed(self.html)
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not {"style", "script", "svg"} & set(self.open):
            self.words += data

    def all(self, wanted):
        return [attributes for tag, attributes in self.elements if tag == wanted]
