"""A cdf that the user gives: what samples are counted by, and what the pdf is held against."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.checks.claim import Claim
from fogproof.checks.density.charts import Chart
from fogproof.checks.density.grid import Marginal
from fogproof.checks.normalisation import FLOOR
from fogproof.checks.probes import cdf_agreement
from fogproof.checks.subject import Subject, call, numbers
from fogproof.checks.verdict import Finding
from fogproof.domains import HalfLine, RealLine

_SAME = 1e-5  # differences of two functions that are meant to be one
_COMPARED = 1024  # groups of cells in which a given cdf is compared with the pdf


def continuous_cdf(subject: Subject, chart: Chart, counted: np.ndarray) -> np.ndarray:
    """Return the given cdf (m,) at counted coordinates of a line, without the atoms' steps; at infinite ends it is 0 and 1."""
    assert subject.cdf is not None
    t = chart.axes[0].uncounted(counted)
    points = chart.to_point(t[:, None])
    left = isinstance(subject.domain, RealLine) & (t <= 0)
    right = isinstance(subject.domain, (RealLine, HalfLine)) & (t >= 1)
    inner = ~(left | right)
    values = np.where(right, 1.0, 0.0)
    values[inner] = numbers("cdf(x)", call("cdf(x)", subject.cdf, points[inner]), (int(inner.sum()),))
    points = np.where(right, np.inf, np.where(left, -np.inf, points))
    for point, probability in subject.atoms.items():
        values = values - np.where(points >= point, probability, 0.0)
    return values


def rosenblatt(subject: Subject, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the two columns (n,) of a given Rosenblatt map at points (n, k)."""
    assert subject.cdf is not None
    values = numbers("cdf(x)", call("cdf(x)", subject.cdf, x), (len(x), 2))
    return values[:, 0], values[:, 1]


def agreement(subject: Subject, claim: Claim, given: Marginal) -> Finding:
    """Hold the cells' probabilities of a given cdf on a line against the integrals of the pdf."""
    own = claim.grid.marginals[0]
    at = np.unique(np.arange(_COMPARED + 1) * len(own.mass) // _COMPARED)
    scale = 1 - sum(subject.atoms.values())
    right = np.diff(own.cdf[at]) * claim.leaves.total
    slack = own.doubt(at[:-1], at[1:]) + FLOOR[subject.precision] + claim.rounding
    finding = cdf_agreement(np.diff(given.cdf[at]) * scale, right, slack, own.shown[at[1:]])
    if finding.outcome == "rejected":
        return _named(finding, subject, own.shown[at[1:-1]], given.cdf[at[1:-1]], own.cdf[at[1:-1]])
    return finding


def _named(finding: Finding, subject: Subject, points: np.ndarray, given: np.ndarray, right: np.ndarray) -> Finding:
    """Return the finding with what stands for the cdf, (m,) at points between the ends, less its value at the left end."""
    if min(np.max(np.abs(given - level + right), initial=0.0) for level in (0.0, 1.0)) < _SAME:
        words = "1 - cdf(x) fits the pdf: this is the complementary cdf, the probability above x"
        return replace(finding, message=f"{finding.message}; {words}", cause="complementary cdf")
    told = np.isfinite(points)
    with np.errstate(all="ignore"):
        cdf = numbers("cdf(x)", call("cdf(x)", subject.cdf, points[told]), (int(told.sum()),)) if subject.cdf else given
        pdf = subject.density(points[told])
    if np.allclose(cdf, pdf, rtol=_SAME, atol=0):
        return replace(finding, message=f"{finding.message}; cdf(x) is pdf(x) itself")
    return finding
