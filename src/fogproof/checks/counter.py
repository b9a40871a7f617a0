"""From a batch of samples to its tally: every sample in its cells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.checks.density.features import Ranges
from fogproof.checks.density.grid import Grid
from fogproof.checks.mixture import MixtureTest
from fogproof.checks.promises import Watch
from fogproof.checks.statistics.evenness import CALLS, GROUPS
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.repeats import KEPT, fingerprints
from fogproof.checks.statistics.serial import Successions
from fogproof.checks.streams import BATCH
from fogproof.checks.subject import Subject
from fogproof.checks.tally import Tally
from fogproof.contracts import Draw


@dataclass(frozen=True)
class Counter:
    """Counts batches of one subject on one grid.

    count   points -> one counted coordinate (n,) an axis
    ranges  what densities the quadrature knows in each cell
    labels  the usual event label of each place
    scores  for each axis, the middle probability (m,) of each fine cell, in the units of serial correlation
    fingerprinted  whether repetitions mean anything
    mixture  of the label test, None without it
    """

    subject: Subject
    grid: Grid
    count: Any
    ranges: Ranges | None
    labels: dict[Any, int]
    scores: tuple[np.ndarray, ...]
    fingerprinted: bool
    mixture: MixtureTest | None = None

    @property
    def evens(self) -> bool:
        """Whether the points of one call may know each other: those of a function of uniforms cannot."""
        return self.subject.dimensions is None and not self.subject.quasi_random

    def empty(self) -> Tally:
        """Return the tally of no samples."""
        k = len(self.grid.marginals)
        plane = self.grid.plane
        return Tally(
            (),
            0,
            tuple(np.zeros(len(m.mass), dtype=np.int64) for m in self.grid.marginals),
            None if plane is None else np.zeros((plane.size, plane.size), dtype=np.int64),
            np.tile([np.inf, -np.inf], (k, 1)),
            dict.fromkeys(self.subject.atoms, 0),
            dict.fromkeys(map(float, self.subject.events), 0),
            None,
            np.empty(0, dtype=np.uint64),
            np.empty((0, *self.subject.domain.shape)),
            (),
            np.empty(0),
            None,
            0,
            np.empty((0, k, GROUPS), dtype=np.int64),
            Watch(self.subject, self.labels),
        )

    def tally(self, draw: Draw, index: int) -> Tally:
        """Return the tally of batch number `index`."""
        subject, grid = self.subject, self.grid
        watch = Watch(subject, self.labels)
        good, p = watch.look(draw)
        points = draw.x if good.all() else draw.x[good]
        coordinates = self.count(points)
        cells = [m.lookup(c) for m, c in zip(grid.marginals, coordinates, strict=True)]
        fine = tuple(np.bincount(c, minlength=len(m.mass)) for m, c in zip(grid.marginals, cells, strict=True))
        plane = at = None
        if grid.plane is not None:
            size = grid.plane.size
            rows = [r[c] for r, c in zip(grid.plane.rows, cells, strict=True)]
            plane = np.bincount(rows[0] * size + rows[1], minlength=size * size).reshape(size, size)
            at = grid.plane.coarse(cells)
        strange = np.empty(0)
        if self.ranges is not None and len(points):
            strange = points[self.ranges.strange(cells[0] if at is None else at, p)]
        extremes = np.array([[c.min(), c.max()] if len(c) else [np.inf, -np.inf] for c in coordinates])
        hits = {point: int(np.count_nonzero(where)) for point, where in subject.at_atom(draw.x).items()}
        labels = np.empty(0) if draw.event is None else draw.event
        events = {float(label): int(np.count_nonzero(labels == label)) for label in subject.events}
        first = index * BATCH < KEPT
        serial = (
            Successions.of([s[c] for s, c in zip(self.scores, cells, strict=False)], first) if len(points) else None
        )
        remembered = self.fingerprinted and first
        prints = fingerprints(points) if remembered else np.empty(0, dtype=np.uint64)
        kept_points = points if index == 0 else np.empty((0, *subject.domain.shape))
        weights: tuple[Moments, ...] = ()
        if draw.weight is not None:
            columns = draw.weight.reshape(len(draw.x), -1).T
            weights = tuple(Moments.of(np.ascontiguousarray(column)) for column in columns)
        mixed = self.mixture is not None and index < self.mixture.most
        sums = self.mixture.count(draw, good, p, index) if self.mixture is not None and mixed else None
        lost = 0 if draw.valid is None else int(np.count_nonzero(~draw.valid))
        n, strange = len(draw.x), strange[:4096]
        calls = self.coarse(fine)[None] if self.evens and index < CALLS else np.empty((0, len(fine), GROUPS), np.int64)
        return Tally(
            (index,),
            n,
            fine,
            plane,
            extremes,
            hits,
            events,
            serial,
            prints,
            kept_points,
            weights,
            strange,
            sums,
            lost,
            calls,
            watch,
        )

    def coarse(self, fine: tuple[np.ndarray, ...]) -> np.ndarray:
        """Return (k, 32) counts in groups of the fine cells, of about equal probability."""
        groups = zip(self.grid.marginals, fine, strict=True)
        rows = [np.bincount(np.minimum((m.scores * GROUPS).astype(np.intp), GROUPS - 1), c, GROUPS) for m, c in groups]
        return np.stack(rows).astype(np.int64)

    def coarse_at(self, points: np.ndarray) -> np.ndarray:
        """Return (k, 32) counts of points, as one call of them has."""
        cells = zip(self.grid.marginals, self.count(points), strict=True)
        return self.coarse(tuple(np.bincount(m.lookup(c), minlength=len(m.mass)) for m, c in cells))
