"""From a subject to what it is when it is ready: its claim integrated, cells laid out, single questions asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from fogproof.checks import sampled_integrals
from fogproof.checks.call_sizes import small_calls
from fogproof.checks.claim import Claim, claimed
from fogproof.checks.counter import Counter
from fogproof.checks.density.charts import Chart, chart_of
from fogproof.checks.density.features import Ranges
from fogproof.checks.density.grid import Grid
from fogproof.checks.density.grid_of_map import line_grid_from_cdf, pilot_grid, unit_cube_grid
from fogproof.checks.density.rounding import ROUNDED, Rounded, blurred, coarsely_moved
from fogproof.checks.edges import edge_uniforms, no_edge_uniforms
from fogproof.checks.given_cdf import agreement, continuous_cdf, rosenblatt
from fogproof.checks.hints import cube_map, cut, supported, why_not_inverse
from fogproof.checks.jacobian import jacobian_agreement
from fogproof.checks.map_density import map_density
from fogproof.checks.mixture import MixtureTest
from fogproof.checks.normalisation import albedo, mean_cosine
from fogproof.checks.pilot import LARGE_PILOT, PILOT, Pilot, draw_pilot
from fogproof.checks.prepared import Prepared
from fogproof.checks.probes import pdf_twice, precision_agreement, reference_agreement, support_of_eval, writing
from fogproof.checks.promises import at_any_atom, inside
from fogproof.checks.purity import heeds_generator, purity
from fogproof.checks.statistics.serial import in_units
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.checks.table import table_grid
from fogproof.checks.verdict import Finding
from fogproof.domains import Discrete, Law
from fogproof.errors import InvalidValueError

_MOST_ENTRIES = 1 << 22  # of a table that is summed over
_STEPS = 2.0  # of declared uniforms of few bits: a sample is made of one or two that matter
_PRECISION_POINTS = 4096
_CANCELLED = 4.0  # units in the last place of an axis that single precision may lose

Count = Callable[[np.ndarray], tuple[np.ndarray, ...]]
"""Points (n, ...) to the coordinates (n,) in which they are counted."""


def prepare(subject: Subject, samples: int, seed: int) -> Prepared:
    """Integrate the claim, lay out cells for up to `samples` samples, and ask all single questions."""
    pilot = draw_pilot(subject, seed)
    channels = len(np.atleast_1d(np.asarray(subject.albedo, dtype=float))) if subject.albedo is not None else 1
    if pilot.channels and channels not in (1, pilot.channels):
        rule = f"must be one number, or one a channel of the weights, {pilot.channels}"
        raise InvalidValueError("albedo", rule, subject.albedo)
    subject, written = writing(subject, pilot.points)
    subject, no_support = supported(subject, pilot.points)
    no_inverse = why_not_inverse(subject, pilot.points)
    if no_inverse:
        subject = replace(subject, inverse=None)
    chart, no_breaks = cut(subject, chart_of(subject.domain, pilot.points, subject.axis))
    prepared = _prepared(subject, samples, seed, pilot, chart)
    if subject.breaks and not no_breaks and prepared.claim and prepared.claim.doubt:
        no_breaks = f"breaks (not used: the pdf is not smooth between them; {prepared.claim.doubt})"
    own = subject.dimensions is None and not subject.quasi_random
    calls = small_calls(subject, seed) if own else None
    disbelieved = tuple(filter(None, (no_breaks, no_support, no_inverse)))
    findings = (*written, *prepared.findings)
    return replace(prepared, findings=findings, calls=calls, seed=seed, disbelieved=disbelieved)


def _prepared(subject: Subject, samples: int, seed: int, pilot: Pilot, chart: Chart | None) -> Prepared:
    findings = _questions(subject, pilot, seed)
    if isinstance(subject.domain, Discrete) and subject.domain.n <= _MOST_ENTRIES:
        grid, count = table_grid(subject, int(subject.domain.n))
        counter = _counter(subject, grid, count, None, pilot, None)
        return Prepared(subject, samples, pilot, None, counter, tuple(findings), True)
    rounded = _rounded(subject, pilot.points, seed)
    claim = None if chart is None else claimed(subject, chart, pilot.points, samples, rounded)
    if claim is None or claim.doubt:
        mixture = _mixture(subject, samples, seed, pilot)
        findings += _sampled_integrals(subject, mixture, pilot)
        grid, count, counted = _cells_beside(subject, samples, claim, mixture.law, pilot, rounded)
        counter = _counter(subject, grid, count, None, pilot, mixture)
        return Prepared(subject, samples, pilot, claim, counter, tuple(findings), counted)
    if subject.axis is not None and subject.mean_cosine is not None:
        findings.append(mean_cosine(subject, claim.chart, claim.density, claim.leaves, claim.work, claim.rounding))
    if subject.eval is not None and subject.albedo is not None:
        findings += albedo(subject, claim.chart, claim.leaves, claim.work, claim.rounding)
    if subject.precision == "float32" and subject.dimensions is not None:
        findings.append(_precision(subject, claim, seed))
    grid, count, beside = claim.grid, claim.chart.count, None
    ranges: Ranges | None = claim.ranges
    if subject.cdf is not None:
        grid, count = _by_cdf(subject, claim, samples, rounded)
        ranges = None
        if len(claim.chart.axes) == 1:
            findings.append(agreement(subject, claim, grid.marginals[0]))
        else:
            findings.append(jacobian_agreement(subject, pilot.points))
    if len(claim.chart.axes) > 1 and (subject.cdf is not None or not _independent(grid)):
        law = subject.domain.law(pilot.points)
        beside = MixtureTest.of(subject, law, pilot.points, seed, 1)
    if subject.inverse is not None:
        grid, count, ranges = *_by_inverse(subject, samples, rounded), None
    counter = _counter(subject, grid, count, ranges, pilot, beside)
    return Prepared(subject, samples, pilot, claim, counter, tuple(findings), True)


def _questions(subject: Subject, pilot: Pilot, seed: int) -> list[Finding]:
    """Return what is found by single questions to the functions given."""
    findings = []
    if subject.dimensions is None:
        findings.append(no_edge_uniforms())
        if subject.pilot is None and not subject.quasi_random:  # where a generator has a say
            findings.append(heeds_generator(subject, seed))
    else:
        uniforms = subject.uniforms(batch_generator(seed, "samples", 0, 0), PILOT)
        findings += [*purity(subject, uniforms), edge_uniforms(subject, pilot.labels)]
        findings += map_density(subject, pilot.points, seed)
    if subject.reference is not None and len(pilot.points):
        findings.append(reference_agreement(subject, pilot.points))
    findings += pdf_twice(subject, pilot.points)
    if subject.eval is not None:
        findings.append(support_of_eval(subject, pilot.points))
    return findings


def _by_inverse(subject: Subject, samples: int, rounded: Rounded) -> tuple[Grid, Count]:
    """Return the cells of the unit cube, and how samples are counted in them by the given inverse."""
    cube = cube_map(subject)
    axes = len(subject.domain.law(np.empty((0, *subject.domain.shape))).axes)
    labels = tuple(f"inverse, {k + 1} of {axes}" for k in range(axes))
    return _cube(subject, labels, samples, lambda x: tuple(np.ascontiguousarray(cube(x).T)), rounded)


def _cube(
    subject: Subject, labels: tuple[str, ...], samples: int, count: Count, rounded: Rounded
) -> tuple[Grid, Count]:
    """Return the cells of the unit cube under a given map, with what rounding does to points before they are mapped."""
    if subject.precision == "float32":
        rounded = coarsely_moved(subject.domain.law(rounded.points), rounded)
    return blurred(unit_cube_grid(labels, samples, subject.roundoff), count, rounded), count


def _rounded(subject: Subject, points: np.ndarray, seed: int) -> Rounded:
    """Return what rounding does to points of the pilot, and whether double precision leads elsewhere."""
    shown, exact = points, None
    if subject.precision == "float32" and subject.dimensions is not None:
        u = subject.uniforms(batch_generator(seed, "samples", 0, 0), ROUNDED)
        single, double = subject.draw_at(u), subject.draw_at(u.astype(np.float64))
        both = inside(subject, single) & inside(subject, double)
        both &= ~at_any_atom(subject, single.x) & ~at_any_atom(subject, double.x)
        if not np.array_equal(single.x[both], double.x[both]):
            shown, exact = single.x[both], double.x[both]
    grain = 0.0 if subject.uniform_bits is None else _STEPS * 2.0**-subject.uniform_bits
    return Rounded(shown, subject.nudged(shown[:ROUNDED]), exact, subject.roundoff, grain)


def _independent(grid: Grid) -> bool:
    return grid.plane is not None and grid.plane.independent


def _by_cdf(subject: Subject, claim: Claim, samples: int, rounded: Rounded) -> tuple[Grid, Count]:
    """Return the cells that a given cdf makes, and how samples are counted in them."""
    if len(claim.chart.axes) == 1:
        cdf = partial(continuous_cdf, subject, claim.chart)
        return line_grid_from_cdf(claim.grid, cdf, 8 * subject.roundoff), claim.chart.count
    labels = tuple(f"cdf of {axis.label}" for axis in claim.chart.axes)
    return _cube(subject, labels, samples, partial(rosenblatt, subject), rounded)


def _mixture(subject: Subject, samples: int, seed: int, pilot: Pilot) -> MixtureTest:
    """Return the test by labels where nothing else knows the density: with a pilot as large as so many samples are worth."""
    wanted, points = int(np.clip(samples // 8, PILOT, LARGE_PILOT)), pilot.points
    if wanted > PILOT and subject.pilot is None:
        points = np.concatenate([points, draw_pilot(subject, seed, 1, wanted - PILOT).points])
    return MixtureTest.of(subject, subject.domain.law(points), points, seed, samples).wider(points)


def _sampled_integrals(subject: Subject, mixture: MixtureTest, pilot: Pilot) -> list[Finding]:
    """Return what is found by integrals over points of the known law, and by the derivative of a given cdf."""
    findings = []
    if subject.axis is not None and subject.mean_cosine is not None:
        findings.append(sampled_integrals.mean_cosine(mixture))
    if subject.eval is not None and subject.albedo is not None:
        findings += sampled_integrals.albedo(mixture)
    if subject.cdf is not None and len(mixture.law.axes) > 1 and not mixture.law.stepped:
        findings.append(jacobian_agreement(subject, pilot.points))
    return findings


def _cells_beside(
    subject: Subject, samples: int, claim: Claim | None, law: Law, pilot: Pilot, rounded: Rounded
) -> tuple[Grid, Count, bool]:
    """Return cells beside the labels, how samples are counted in them, and whether a given map tells their probabilities."""
    axes = len(law.axes)
    if subject.inverse is not None and not law.stepped:
        return *_by_inverse(subject, samples, rounded), True
    if subject.cdf is not None and claim is not None and axes == 1:
        return *_by_cdf(subject, claim, samples, rounded), True
    if subject.cdf is not None and (axes == 2 or claim is not None):
        labels = (f"cdf of {law.axes[0]}", f"cdf of {law.axes[-1]}")
        return *_cube(subject, labels, samples, partial(rosenblatt, subject), rounded), True

    def place(x: np.ndarray) -> tuple[np.ndarray, ...]:
        return tuple(law.coordinates(x, np.full((len(x), axes), 0.5)).T)

    return pilot_grid(law.axes, np.stack(place(pilot.points), axis=-1)), place, False


def _counter(
    subject: Subject,
    grid: Grid,
    count: Count,
    ranges: Ranges | None,
    pilot: Pilot,
    mixture: MixtureTest | None,
) -> Counter:
    table = isinstance(subject.domain, Discrete)
    scores = tuple(in_units(m.scores) for m in (grid.marginals[:1] if table else grid.marginals))
    fingerprinted = not (table or (mixture is not None and mixture.law.stepped))
    return Counter(subject, grid, count, ranges, pilot.labels, scores, fingerprinted, mixture)


def _precision(subject: Subject, claim: Claim, seed: int) -> Finding:
    assert subject.dimensions is not None
    u = batch_generator(seed, "precision", 0, 0).random((_PRECISION_POINTS, subject.dimensions), dtype=np.float32)

    def probability(x: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        counted, moved = claim.chart.count(x), [claim.chart.count(y) for y in subject.nudged(x)]
        found = []
        for axis, m in enumerate(claim.grid.marginals):
            step = _CANCELLED * subject.roundoff * (m.edges[-1] - m.edges[0])
            at, c = m.at(counted[axis]), counted[axis]
            others = [c - step, c + step, *(each[axis] for each in moved)]
            gaps = [np.abs(m.at(np.clip(o, m.edges[0], m.edges[-1])) - at) for o in others]
            found.append((at, np.max([np.minimum(gap, 1 - gap) for gap in gaps], axis=0)))
        return found

    return precision_agreement(subject, u, probability)
