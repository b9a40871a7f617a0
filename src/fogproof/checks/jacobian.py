"""A given Rosenblatt map against the pdf: the determinant of its derivative is the density, or one of the two is wrong.

Both are functions, so no sample and no integral is needed: F(x) is differentiated numerically along the coordinates of the domain's
known law, in which |det dF/du| is the ratio of the pdf to that law's density (Rosenblatt 1952). Steps of several sizes must agree
before a derivative is believed, so that jumps and corners of F are passed over, not judged.
"""

from __future__ import annotations

import numpy as np

from fogproof.checks.density.determinant import Map, determinant
from fogproof.checks.probes import agreement
from fogproof.checks.subject import Subject, call, numbers
from fogproof.checks.verdict import Finding

_NAME = "cdf against the pdf"
_POINTS = 2048
_STEPS = (1e-4, 1e-5, 1e-6, 1e-7)  # of the way to the nearer end of an axis
_AGREE = 1e-4  # relative difference of two steps' determinants, below which the smaller one is believed
_TOLERANCE = 1e-3  # relative difference from the pdf that is never rejected
_FEW = 3  # points that differ may do so by chance
_TOO_FEW = 0.25  # of the points: with fewer derivatives nothing is said


def jacobian_agreement(subject: Subject, points: np.ndarray) -> Finding:
    """Compare the pdf with the derivative of the given cdf at sampled points (n, ...) of a domain of two or more coordinates."""

    def rosenblatt(x: np.ndarray) -> np.ndarray:
        assert subject.cdf is not None
        return numbers("cdf(x)", call("cdf(x)", subject.cdf, x), (len(x), len(law.axes)))

    law = subject.domain.law(points[:_POINTS])
    found = _compared(subject, rosenblatt, points[:_POINTS])
    if isinstance(found, float):
        message = f"the given cdf has a derivative at {found:.0%} of the samples only: its pdf cannot be told"
        return Finding(_NAME, "inconclusive", message)
    return agreement(_NAME, *found, "pdf and derivative of the cdf at x =", _TOLERANCE)


def agrees(subject: Subject, cube: Map, points: np.ndarray) -> str:
    """Return how the pdf contradicts the derivative of a map from points to the unit cube, "" if it does not."""
    found = _compared(subject, cube, points[:_POINTS], 1 - sum(subject.atoms.values()))
    if isinstance(found, float):
        return f"it has a derivative at {found:.0%} of the samples only"
    finding = agreement(_NAME, *found, "pdf and its derivative at x =", _TOLERANCE)
    return "" if finding.outcome == "not rejected" else finding.message


def _compared(
    subject: Subject, cube: Map, points: np.ndarray, mass: float = 1.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | float:
    """Return pdf, derivative, slack and place at points with a derivative; the share of these if they are too few.

    mass  of the points that the map makes uniform: all but the atoms
    """
    law = subject.domain.law(points)
    u = law.coordinates(points, np.full((len(points), len(law.axes)), 0.5))
    ratio = _determinants(lambda v: cube(law.place(v)), u)
    claimed, known = subject.density(points), law.density(points)
    good = np.isfinite(ratio) & np.isfinite(claimed)
    if not len(points) or np.mean(good) < _TOO_FEW:
        return float(np.mean(good)) if len(points) else 0.0
    points, claimed, right = points[good], claimed[good], (mass * ratio * known)[good]
    slack = _TOLERANCE * (np.abs(right) + np.abs(claimed)) + subject.rounding_spread(subject.density, points)
    off = np.abs(claimed - right) > slack
    if 0 < np.count_nonzero(off) <= _FEW:
        points, claimed, right, slack = points[~off], claimed[~off], right[~off], slack[~off]
    return claimed, right, slack, points


def _determinants(f: Map, u: np.ndarray) -> np.ndarray:
    """Return (n,) |det df/du| at u (n, k), NaN where no two steps agree."""
    found = np.full(len(u), np.nan)
    before = None
    for step in _STEPS:
        now = determinant(f, u, step)
        if before is not None:
            agree = np.abs(now - before) <= _AGREE * np.maximum(np.abs(now), np.abs(before))
            found = np.where(np.isnan(found) & agree, now, found)
        before = now
    return found
