"""A subject made ready to be sampled: its claim integrated, cells laid out, and what needs no samples already found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.checks.density.charts import Chart, chart_of
from fogproof.checks.density.features import Ranges, emptiest, ranges_of_line, ranges_of_plane
from fogproof.checks.density.grid import (
    Grid,
    Marginal,
    blurred,
    grid_of,
    line_grid_from_cdf,
    refilled,
    unit_square_grid,
)
from fogproof.checks.density.lookup import Lookup
from fogproof.checks.density.model import Density, Effort, integrated, looked_at, looked_at_plane
from fogproof.checks.density.quadrature import Leaves
from fogproof.checks.edges import edge_uniforms, no_edge_uniforms
from fogproof.checks.jacobian import jacobian_agreement
from fogproof.checks.normalisation import FLOOR, albedo, effort, mean_cosine, normalisation, rounding_share
from fogproof.checks.probes import cdf_agreement, precision_agreement, reference_agreement
from fogproof.checks.promises import inside, usual_labels
from fogproof.checks.purity import purity
from fogproof.checks.statistics.repeats import KEPT, expected_repeats
from fogproof.checks.statistics.serial import in_units
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject, call, nudged, numbers
from fogproof.checks.tally import Counter, Tally
from fogproof.checks.verdict import Finding
from fogproof.domains import Discrete, HalfLine, RealLine, UnitHemisphere, UnitSphere

PILOT = 1 << 14
"""Samples that set scales and show where the density is; they are not counted."""

_COMPARED = 1024  # groups of cells in which a given cdf is compared with the pdf
_PRECISION_POINTS = 4096


@dataclass(frozen=True)
class Pilot:
    """A first sample: good points (n, ...) of the continuous part, usual event labels, and how many channels its weights have."""

    points: np.ndarray
    labels: dict[Any, int]
    channels: int


@dataclass(frozen=True)
class Claim:
    """The integrated density of a continuous domain; `found` says whether looking closer has changed it."""

    chart: Chart
    density: Density
    work: Effort
    rounding: float
    leaves: Leaves
    grid: Grid
    found: bool = False


@dataclass(frozen=True)
class Prepared:
    """All that does not depend on the tested samples.

    claim     None on `Discrete`
    findings  of deterministic checks, but for the normalisation, which the samples may still refine
    """

    subject: Subject
    samples: int
    pilot: Pilot
    claim: Claim | None
    counter: Counter
    findings: tuple[Finding, ...]

    @property
    def grid(self) -> Grid:
        """The cells that samples are counted in."""
        return self.counter.grid

    def normalisation(self, drawn: int) -> Finding:
        """Return the finding on the integral of the pdf."""
        if self.claim is None:
            mass = self.subject.density(np.arange(self.grid.marginals[0].mass.size, dtype=np.float64))
            error = 4 * self.subject.roundoff * float(np.sum(np.abs(mass)))
            return normalisation(self.subject, float(mass.sum()), error, 0.0, 0.0)
        claim = self.claim
        hidden = 16 / drawn if claim.found else 0.0
        leaves = claim.leaves
        finding = normalisation(self.subject, leaves.total, leaves.total_error, claim.rounding, hidden)
        agreed = any(f.check == "cdf against the pdf" and f.outcome == "not rejected" for f in self.findings)
        if finding.outcome == "inconclusive" and agreed:
            message = (
                f"{finding.message.partition(';')[0]}, and agrees with the given cdf wherever it can be integrated"
            )
            return replace(finding, outcome="not rejected", message=message)
        return finding

    def expected_repeats(self, n: int) -> float:
        """Return about how many repeated points a right sampler may show among n."""
        points = self.pilot.points[:2048]
        if self.claim is None or len(points) == 0:
            return 0.0
        pole = 0.0
        if isinstance(self.subject.domain, (UnitSphere, UnitHemisphere)):
            marginal = self.claim.grid.marginals[0]
            near = 4 * self.subject.roundoff * (marginal.edges[-1] - marginal.edges[0])
            low, high = marginal.at(np.array([marginal.edges[0] + near, marginal.edges[-1] - near]))
            pole = float(low + (1 - high))
        p = self.subject.density(points)
        return expected_repeats(
            min(n, KEPT),
            self.subject.domain,
            self.subject.precision,
            points,
            np.where(np.isfinite(p), p, 0.0),
            pole,
            self.subject.uniform_bits,
        )

    def refined(self, tally: Tally) -> Prepared:
        """Return the same with the density integrated anew where the samples showed something unknown."""
        claim = self.claim
        if claim is None or self.counter.ranges is None:
            return self
        strange = claim.chart.coordinates(tally.strange) if len(tally.strange) else np.empty((0, len(claim.chart.axes)))
        if len(claim.chart.axes) == 1:
            probes = emptiest(claim.chart.axes[0], claim.grid.marginals[0], tally.fine[0])
            points = np.sort(np.concatenate([strange[:, 0], probes]))
            leaves = looked_at(claim.density, claim.leaves, points, claim.work)
        else:
            leaves = looked_at_plane(claim.density, claim.leaves, strange, claim.work)
        if leaves is claim.leaves:
            return self
        grid = refilled(claim.grid, claim.chart, leaves, self.samples)
        counted = grid if self.subject.cdf is None else self.grid
        claim = replace(claim, leaves=leaves, grid=grid, found=True)
        return replace(self, claim=claim, counter=replace(self.counter, grid=counted))


def prepare(subject: Subject, samples: int, seed: int) -> Prepared:
    """Integrate the claim, lay out cells for up to `samples` samples, and ask all single questions."""
    pilot = _pilot(subject, seed)
    findings = []
    if subject.dimensions is None:
        findings.append(no_edge_uniforms())
    else:
        uniforms = subject.uniforms(batch_generator(seed, "samples", 0, 0), PILOT)
        findings += [*purity(subject, uniforms), edge_uniforms(subject, pilot.labels)]
    if subject.reference is not None and len(pilot.points):
        findings.append(reference_agreement(subject, pilot.points))
    if isinstance(subject.domain, Discrete):
        grid = Grid((_discrete(subject),), None)
        counter = _counter(subject, grid, lambda x: (x,), None, pilot, fingerprinted=False)
        return Prepared(subject, samples, pilot, None, counter, tuple(findings))
    claim = _claim(subject, pilot.points, samples)
    if subject.axis is not None and subject.mean_cosine is not None:
        findings.append(mean_cosine(subject, claim.chart, claim.density, claim.leaves, claim.work))
    if subject.eval is not None and subject.albedo is not None:
        findings += albedo(subject, claim.chart, claim.leaves, claim.work)
    if subject.precision == "float32" and subject.dimensions is not None:
        findings.append(_precision(subject, claim, seed))
    grid, count, ranges = claim.grid, claim.chart.count, None
    if subject.cdf is None:
        ranges = _ranges(claim)
    elif len(claim.chart.axes) == 1:
        grid = line_grid_from_cdf(grid, partial(_continuous_cdf, subject, claim.chart), 8 * subject.roundoff)
        findings.append(_cdf_agreement(subject, claim, grid.marginals[0]))
    else:
        labels = (claim.chart.axes[0].label, claim.chart.axes[1].label)
        grid, count = unit_square_grid(labels, samples), partial(_rosenblatt, subject)
        findings.append(jacobian_agreement(subject, pilot.points))
    counter = _counter(subject, grid, count, ranges, pilot, fingerprinted=True)
    return Prepared(subject, samples, pilot, claim, counter, tuple(findings))


def _counter(
    subject: Subject,
    grid: Grid,
    count: Callable[[np.ndarray], tuple[np.ndarray, ...]],
    ranges: Ranges | None,
    pilot: Pilot,
    fingerprinted: bool,
) -> Counter:
    scores = tuple(in_units(m.scores) for m in grid.marginals)
    return Counter(subject, grid, count, ranges, pilot.labels, scores, fingerprinted)


def _pilot(subject: Subject, seed: int) -> Pilot:
    draw = subject.draw(batch_generator(seed, "samples", 0, 0), PILOT)
    good = inside(subject, draw)
    for at in subject.at_atom(draw.x).values():
        good = good & ~at
    if draw.valid is not None:
        good = good & draw.valid
    channels = 0 if draw.weight is None else draw.weight.size // len(draw.x)
    return Pilot(draw.x[good], usual_labels(subject, draw), channels)


def _claim(subject: Subject, points: np.ndarray, samples: int) -> Claim:
    chart = chart_of(subject.domain, points, subject.axis)
    work = effort(subject, points)

    def density(c: np.ndarray) -> np.ndarray:
        p = subject.density(chart.to_point(c))
        return np.where(p == 0, 0.0, p * chart.jacobian(c))

    pilot = chart.coordinates(points) if len(points) else np.empty((0, len(chart.axes)))
    leaves = integrated(chart, density, pilot, work)
    grid = grid_of(chart, leaves, samples)
    grid = blurred(grid, chart, points[:2048], nudged(points[:2048], subject.roundoff), subject.roundoff)
    rounding = rounding_share(subject, points) if subject.precision == "float32" and len(points) else 0.0
    return Claim(chart, density, work, rounding, leaves, grid)


def _ranges(claim: Claim) -> Ranges:
    chart, grid = claim.chart, claim.grid
    if grid.plane is not None:
        return ranges_of_plane(chart, claim.leaves, grid.marginals, grid.plane)
    return ranges_of_line(
        chart.axes[0], grid.marginals[0], chart.jacobian, lambda t: claim.density(np.ascontiguousarray(t)[:, None])
    )


def _discrete(subject: Subject) -> Marginal:
    assert isinstance(subject.domain, Discrete)
    n = int(subject.domain.n)
    mass = subject.density(np.arange(n, dtype=np.float64))
    mass = np.where(np.isfinite(mass) & (mass > 0), mass, 0.0)
    cdf = np.concatenate([[0.0], np.cumsum(mass)]) / (mass.sum() if mass.sum() > 0 else 1.0)
    edges = np.arange(n + 1) - 0.5
    error, none = np.full(n + 1, 4 * subject.roundoff), np.zeros(n + 1)
    return Marginal("x", edges, edges, cdf, none, error, none, False, Lookup.of(edges), lambda x: x, True)


def _continuous_cdf(subject: Subject, chart: Chart, counted: np.ndarray) -> np.ndarray:
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


def _rosenblatt(subject: Subject, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    assert subject.cdf is not None
    values = numbers("cdf(x)", call("cdf(x)", subject.cdf, x), (len(x), 2))
    return values[:, 0], values[:, 1]


def _cdf_agreement(subject: Subject, claim: Claim, given: Marginal) -> Finding:
    own = claim.grid.marginals[0]
    at = np.unique(np.arange(_COMPARED + 1) * len(own.mass) // _COMPARED)
    scale = 1 - sum(subject.atoms.values())
    right = np.diff(own.cdf[at]) * claim.leaves.total
    slack = own.doubt(at[:-1], at[1:]) + FLOOR[subject.precision] + claim.rounding
    return cdf_agreement(np.diff(given.cdf[at]) * scale, right, slack, own.shown[at[1:]])


def _precision(subject: Subject, claim: Claim, seed: int) -> Finding:
    assert subject.dimensions is not None
    u = batch_generator(seed, "precision", 0, 0).random((_PRECISION_POINTS, subject.dimensions), dtype=np.float32)

    def probability(x: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        counted = zip(claim.grid.marginals, claim.chart.count(x), strict=True)
        return [(m.at(c), np.interp(c, m.edges, m.blur)) for m, c in counted]

    return precision_agreement(subject, u, probability)
