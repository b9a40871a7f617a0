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


PLAN = {
    "terms": [
        {"name": "attenuation", "kept": True, "why": "homogeneous: T = exp(-sigma_t s)"},
        {"name": "emission", "kept": False, "why": "sigma_a L_e = 0"},
    ],
    "solver": "transmittance",
    "estimator": "AnalogTransmittance",
    "why": "nothing is gained along the ray",
}
ORACLE = {
    "quantity": "transmittance",
    "values": 22,
    "relative": 7e-16,
    "share": 0.15,
    "broken": 0,
    "hardest": '{"q": 1}',
}


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
    caught = {"outcome": "rejected", "checks": ["mean cosine", "chi-square in mu"], "p_value": 1e-80, "samples": 20_000}
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
        "twin_result": caught if judged else None,
        "plan": PLAN if kind == "estimator" else None,
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
        "oracle": [ORACLE],
        "cases": cases,
    } | changes


def estimate(value: float, width: float = 0.2) -> dict[str, float]:
    return {"value": value, "low": value * (1 - width), "high": value * (1 + width)}


def entry(
    name: str, axis: str = "samples", points: str = "random", status: str = "passed", **changes: Any
) -> dict[str, Any]:
    """An estimator of a study: its error falls like the square root of the count, or like its inverse."""
    random = axis == "samples" and points == "random"
    counts = [1] if axis == "nothing" else [100, 1000, 10_000]
    errors = [0.0 if axis == "nothing" else 0.3 / n ** (0.5 if random else 1.0) for n in counts]
    rejected = status in ("known", "rejected")
    outcome = {"known": "rejected", "passed": "not rejected"}.get(status, status)
    finding = Finding("mean", outcome, "mean 0.1353 +- 0.001", None if rejected else 0.3, 1e-8, True, 1.0, 1e-4)
    return {
        "name": name,
        "kind": name.removesuffix(" + sobol"),
        "title": name,
        "label": name,
        "options": {},
        "points": points,
        "axis": axis,
        "expected": "rejected" if status == "known" else "not rejected",
        "reason": "biased by its steps" if status == "known" else "",
        "outcome": outcome,
        "status": status,
        "warning": "",
        "findings": [finding],
        "moments": {"n": 11_100, "mean": 0.135, "m2": 1.0, "m3": 0.0, "m4": 3.0, "low": 0.0, "high": 1.0},
        "bias": estimate(1e-4),
        "variance": estimate(0.09) | {"measured": 0.09, "exact": 0.09, "exact_error": 0.0, "method": ""}
        if random
        else None,
        "slope": estimate(-0.5) | {"expected": -0.5} if axis == "samples" else None,
        "march": {"order": estimate(2.0), "floor": 1e-9, "at": 10_000, "reached": False} if axis == "steps" else None,
        "cost": 2.5,
        "counts": [
            {"count": n, "replicates": 8, "mean": 0.135, "rmse": e, "rmse_low": e / 2, "rmse_high": 2 * e}
            | {"predicted": e if random else None}
            for n, e in zip(counts, errors, strict=True)
        ],
        "speed": {
            "cpu": estimate(1e-7),
            "wall": 2e-7,
            "batches": 3,
            "cpu_total": 0.01,
            "counts": [estimate(1e-7) | {"count": n, "seconds": n * 1e-7} for n in counts],
            "targets": [
                {"error": 0.01, "samples": 1e4, "seconds": 1e-3, "how": "computed"},
                {"error": 0.001, "samples": 1e6, "seconds": 0.1, "how": "computed"},
                {"error": 0.0001, "samples": None, "seconds": None, "how": "the bias is larger"},
            ],
            "efficiency": None if rejected else "inf" if axis == "nothing" else 1e8,
            "relative": None
            if rejected
            else dict.fromkeys(("value", "low", "high"), "inf")
            if axis == "nothing"
            else estimate(1.0),
            "rank": None if rejected or points == "sobol" else 1,
            "gain": estimate(40.0) if points == "sobol" else None,
        },
    } | changes


def study(name: str = "haze", question: str = "Which is best in haze?", **changes: Any) -> dict[str, Any]:
    """A study of one scene with every kind of estimator, and a history."""
    entries = [
        entry("exact", "nothing"),
        entry("delta"),
        entry("delta + sobol", points="sobol"),
        entry("ratio", status="inconclusive", warning="heavy tail: one realisation of 11100 has 40% of the variance"),
        entry("march", "steps", status="known"),
        entry("broken", status="rejected"),
    ]
    answer = {"best": "exact", "best_random": "delta", "text": "Exact is best. Delta is the best random one."}
    scene = {
        "name": name,
        "question": question,
        "quantity": "fog",
        "unit": "W/(m^2 sr)",
        "described": {"medium": {"sigma_a": 0.1}},
        "reference": {"value": 0.1353352832366127, "error": 1e-17, "method": "exp(-tau)", "source": "Bouguer 1729"},
        "answer": answer | {"ranking": ["exact", "delta"], "out": ["march"]},
        "estimators": entries,
        "plan": PLAN,
    }
    change = {
        "scene": name,
        "estimator": "delta",
        "became": ["slower"],
        "time": estimate(2.0),
        "variance": estimate(1.0),
    }
    record_of_run = record([], kind="study", exit_code=1, command="fogproof study lecture.toml -o build/study")
    del record_of_run["cases"], record_of_run["oracle"]
    return (
        record_of_run
        | {
            "title": "A study",
            "executor": "threads",
            "workers": 2,
            "fingerprint": "f" * 32,
            "digest": "d" * 64,
            "confidence": 0.99,
            "settings": {"samples": [100, 1000, 10_000], "replicates": 8},
            "batches": {"planned": 20, "done": 19, "failed": 1},
            "cpu_seconds": 1.5,
            "answers": [{"question": question, "scene": name, **answer}],
            "scenes": [scene],
            "failures": [
                {
                    "batch": 7,
                    "scene": name,
                    "estimator": "ratio",
                    "count": 100,
                    "attempts": 3,
                    "error": "ZeroDivisionError",
                }
            ],
            "sessions": [],
            "mixed": True,
            "history": {
                "before": {"title": "A study", "started": "2026-01-30", "fogproof": "0.1.0"},
                "same_draws": True,
                "alpha": 1e-6,
                "mood": 0.9,
                "wander": 0.1,
                "gone": ["haze / old"],
                "new": [],
                "worse": True,
                "text": "delta became slower",
                "changes": [change, change | {"estimator": "ratio", "became": []}],
            },
        }
        | changes
    )


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
