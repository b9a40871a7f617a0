"""Which statistical tests a subject meets: it depends on what the subject declares, never on its samples."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fogproof.checks.call_sizes import one_law
from fogproof.checks.density.grid import Grid
from fogproof.checks.escalation import Test
from fogproof.checks.few_values import few_values, few_values_axes
from fogproof.checks.mixture import MixtureTest
from fogproof.checks.normalisation import FLOOR
from fogproof.checks.prepared import Prepared
from fogproof.checks.statistics import labels
from fogproof.checks.statistics.binomial import binomial
from fogproof.checks.statistics.cells import blocks
from fogproof.checks.statistics.chi_square import chi_square_along, joint
from fogproof.checks.statistics.evenness import evenness_test
from fogproof.checks.statistics.known import NOTHING_MORE, Declarable
from fogproof.checks.statistics.kolmogorov import kolmogorov
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.repeats import repeats_test
from fogproof.checks.statistics.scan import scan, scan_ends, scan_plane
from fogproof.checks.statistics.serial import serial_test
from fogproof.checks.statistics.smooth import cross, smooth
from fogproof.checks.statistics.sparse_chi_square import joint_fine
from fogproof.checks.subject import named
from fogproof.checks.tally import Tally
from fogproof.checks.verdict import Finding

_CELLS = 512  # of the chi-square test along an axis
_COARSER = 3  # levels of the tree from one chi-square of labels to the next


def tests_of(prepared: Prepared, tally: Tally) -> list[Test]:
    """Return the statistical tests of a subject; which ones depends on what it declares, not on the samples."""
    subject, grid = prepared.subject, prepared.grid
    tests: list[Test] = []

    def add(kind: str, run: Callable[..., Finding], name: str, *arguments: Any) -> None:
        tests.append(Test(kind, partial(run, name, *arguments)))

    vacuum = 1 - sum(subject.atoms.values()) <= FLOOR[subject.precision]  # nothing is left for a density
    if prepared.counted and not vacuum:
        _add_cells(add, grid, tally, 2.0**-subject.bits)
    if prepared.counter.mixture is not None and not vacuum:
        _add_labels(add, prepared.counter.mixture, tally, not prepared.counted)
    _add_streams(add, prepared, tally, vacuum)
    n = max(tally.drawn, 1)
    wrong_atom = "wrong probability of an atom"
    rest, tried = prepared.convention(tally)
    if rest is not None:
        slack = FLOOR[subject.precision]
        what, cause = "probability of the continuous part", wrong_atom if subject.atoms else "lost samples"
        found = tally.continuous, max(tried, 1), rest - slack, rest + slack
        add("lost samples", binomial, "continuous part", what, *found, cause)
    for label, q in subject.events.items():
        what, hits = f"probability of the event {label:g}", tally.events[float(label)]
        add("event", binomial, "declared event", what, hits, n, q * (1 - 1e-15), q * (1 + 1e-15), "wrong event label")
    for point, q in subject.atoms.items():
        what = f"probability of the atom at {named(point)}"
        add(
            "atom",
            binomial,
            "atom",
            what,
            tally.atoms[point],
            max(tried, 1),
            q * (1 - 1e-15),
            q * (1 + 1e-15),
            wrong_atom,
        )
    if prepared.pilot.channels and subject.albedo is not None:
        claims = np.broadcast_to(np.asarray(subject.albedo, dtype=float), (prepared.pilot.channels,))
        data = tally.weights or (Moments(),) * len(claims)
        for channel, claimed in enumerate(claims.tolist()):
            name = "mean weight" if len(claims) == 1 else f"mean weight of channel {channel}"
            add(
                "mean weight",
                _mean_weight,
                name,
                data[channel],
                claimed,
                _WEIGHTS if subject.eval is None else NOTHING_MORE,
            )
    return tests


def _add_streams(add: Callable[..., None], prepared: Prepared, tally: Tally, vacuum: bool) -> None:
    """Add the tests of samples against each other: of their order, their calls, their repetitions."""
    subject, grid = prepared.subject, prepared.grid
    if not subject.quasi_random:
        add("serial correlation", serial_test, "serial correlation", tally.serial)
    if prepared.counter.evens and not vacuum:
        calls = np.concatenate([prepared.first_call[None], tally.calls])
        add("evenness", evenness_test, "independence within a call", tuple(m.label for m in grid.marginals), calls)
    if prepared.calls is not None:
        asked = subject, prepared.calls, prepared.pilot.points, prepared.seed
        add("size of the call", one_law, "size of the call", *asked)
    if prepared.counter.fingerprinted:
        for coordinate in few_values_axes(subject):
            drawn = prepared.pilot.points, tally.points
            add("few values", few_values, f"different values of {coordinate}", subject, coordinate, *drawn)
        add("repeated points", repeats_test, "repeated points", tally.prints, prepared.expected_repeats)


def _add_cells(add: Callable[..., None], grid: Grid, tally: Tally, grain: float) -> None:
    """Add the tests of counts in cells of known probability; `grain` is the step of the sampler's uniforms."""
    several = len(grid.marginals) > 1
    for axis, (marginal, counts) in enumerate(zip(grid.marginals, tally.fine, strict=True)):
        if len(counts) < 2:
            continue
        of, along = (f" of {marginal.label}", f" in {marginal.label}") if several else ("", "")
        add("distribution", kolmogorov, f"distribution{of}", marginal, counts)
        add("smooth", smooth, f"smooth components{along}", marginal, counts)
        add("chi-square", chi_square_along, f"chi-square{along}", marginal, counts, _CELLS)
        add("scan", scan, f"scan{along}", marginal, counts)
        if marginal.ends:
            low, high = tally.extremes[axis]
            add("ends", scan_ends, f"ends{of}", marginal, counts, low, high, grain)
    if grid.plane is not None and tally.plane is not None:
        plane, coarse = grid.plane, blocks(tally.plane, len(grid.plane.mass))
        labels = (grid.marginals[0].label, grid.marginals[1].label)
        add("joint", joint, "chi-square, joint", plane, coarse)
        add("dependence", cross, "dependence of the axes", labels, plane, coarse)
        add("patches", scan_plane, "scan for patches", labels, plane, tally.plane)
        if plane.independent:
            add("fine joint", joint_fine, "chi-square, fine joint", plane, tally.plane)


def _add_labels(add: Callable[..., None], mixture: MixtureTest, tally: Tally, alone: bool) -> None:
    """Add the label tests, under the one or both conventions on lost samples; `alone`, if nothing else looks along the axes."""
    sums = tally.labels or (mixture.nothing(), mixture.nothing())
    conventions = sums if tally.given_up else sums[:1]
    add("labels", labels.whole, "labels", conventions)
    depth = mixture.tree.depth
    for level in range(depth, 1, -_COARSER):
        add("label cells", labels.cells_at, f"labels in {1 << level} cells", level, conventions)
    add("label scores", labels.smooth, "labels along smooth functions", conventions)
    if alone and mixture.strips.size:
        add("label strips", labels.along_axes, "labels along the axes", mixture.strips, mixture.law.axes, conventions)
    add("label levels", labels.levels, "labels by level of the pdf", conventions)
    add("largest cell", labels.largest, "labels, largest cell", mixture.describe, conventions)


_WEIGHTS = Declarable(other="give eval, and every single weight is held to eval(x) / pdf(x)")


def _mean_weight(name: str, data: Moments, claimed: float, ways: Declarable, alpha: float) -> Finding:
    return mean_test(name, name, data, claimed, 1e-6 * abs(claimed), alpha, "wrong weight", ways=ways)
