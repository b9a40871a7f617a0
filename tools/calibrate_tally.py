"""Small p-values counted by kind of check, whether they are too many, and the page that says so."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from fogproof.checks import Finding

LEVEL = 1e-3
BAND = 1e-3  # probability outside the band, all kinds together


@dataclass
class Tally:
    """p-values at or below the level, by kind of check: how many there were, how many small, and whether they are exact."""

    counted: Counter[str] = field(default_factory=Counter)
    small: Counter[str] = field(default_factory=Counter)
    exact: dict[str, bool] = field(default_factory=dict)
    values: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))

    def add(self, findings: Iterable[Finding]) -> None:
        """Take in the findings of one verdict about something that is right."""
        for finding in findings:
            if finding.p_value is not None:
                kind = kind_of(finding)
                self.counted[kind] += 1
                self.small[kind] += finding.p_value <= LEVEL
                self.exact[kind] = self.exact.get(kind, True) and finding.exact
                if finding.exact and len(self.values[kind]) < 20_000:
                    self.values[kind].append(finding.p_value)

    def merged(self, other: Tally) -> Tally:
        """Return both together."""
        values = {
            kind: self.values.get(kind, []) + other.values.get(kind, []) for kind in {**self.values, **other.values}
        }
        exact = {
            kind: self.exact.get(kind, True) and other.exact.get(kind, True) for kind in {**self.exact, **other.exact}
        }
        return Tally(self.counted + other.counted, self.small + other.small, exact, defaultdict(list, values))


def kind_of(finding: Finding) -> str:
    """Return the kind of check, without the name of an axis or a channel."""
    name = re.sub(r"labels in \d+ cells", "labels in cells", finding.check)
    return re.sub(r" (of|in) (mu|phi|r|r\^2|x|y|z|x: .*|from .*|cdf of .*|the order of p\(x\)|channel \d+)$", "", name)


def bands(tally: Tally) -> dict[str, tuple[int, int]]:
    """Return for each kind how few and how many small p-values there may be: 99.9 % bands over all kinds together."""
    from scipy.stats import binom

    tail = 0.5 * BAND / max(len(tally.counted), 1)
    return {kind: (int(binom.ppf(tail, n, LEVEL)), int(binom.isf(tail, n, LEVEL))) for kind, n in tally.counted.items()}


def outside(tally: Tally) -> list[str]:
    """Return the kinds whose small p-values are too many, or too few where they are exact."""
    found = []
    for kind, (low, high) in bands(tally).items():
        if tally.small[kind] > high or (tally.exact[kind] and tally.small[kind] < low):
            found.append(kind)
    return found


def uniformity(p_values: Iterable[float]) -> float:
    """Return the p-value of Kolmogorov's test that the values are uniform on [0, 1]."""
    from scipy.special import kolmogorov

    p = np.sort(np.asarray(list(p_values)))
    n = len(p)
    distance = max(np.max(np.arange(1, n + 1) / n - p), np.max(p - np.arange(n) / n))
    return float(kolmogorov(np.sqrt(n) * distance))


def page(tally: Tally, wholes: dict[tuple[str, int], Counter[str]], settings: str) -> str:
    """Return the result page."""
    lines = [
        "# Calibration",
        "",
        "How often the checks reject what is right, as measured by `make calibrate`.",
        "",
        settings,
        "",
        f"## p-values at or below {LEVEL:g}",
        "",
        "The band holds the count of a uniform p-value with probability 99.9 % over all kinds together. Exact p-values are",
        "uniform; the others are upper bounds, whose counts may be smaller. `uniform` is the p-value of Kolmogorov's test of it.",
        "",
        "| kind of check | p-values | small | band | sort | uniform |",
        "|---|--:|--:|---|---|--:|",
    ]
    for kind, (low, high) in sorted(bands(tally).items()):
        sort = "exact" if tally.exact[kind] else "bound"
        uniform = f"{uniformity(tally.values[kind]):.2g}" if tally.exact[kind] and tally.values[kind] else ""
        band = f"{low} to {high}" if tally.exact[kind] else f"up to {high}"
        lines.append(f"| {kind} | {tally.counted[kind]} | {tally.small[kind]} | {band} | {sort} | {uniform} |")
    lines += [
        "",
        f"Outside their bands: {', '.join(outside(tally)) or 'none'}.",
        "",
        "## Whole verdicts on right samplers, alpha = 1e-6",
        "",
        "| sampler | samples | seeds | rejected | inconclusive |",
        "|---|--:|--:|--:|--:|",
    ]
    for (name, samples), outcomes in wholes.items():
        row = (name, f"{samples:.0e}", sum(outcomes.values()), outcomes["rejected"], outcomes["inconclusive"])
        lines.append("| " + " | ".join(map(str, row)) + " |")
    return "\n".join(lines) + "\n"
