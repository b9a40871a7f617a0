"""What is remembered of the samples: counts and sums of a fixed size, however many samples there are.

Tallies of different batches merge, and a tally can be written down and read again: a check can be interrupted, spread over machines
and resumed. Merged in the order of the batches it has the same bits every time.
"""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from fogproof.checks.density.features import Ranges, kept
from fogproof.checks.density.grid import Grid
from fogproof.checks.mixture import MixtureTest
from fogproof.checks.promises import Watch
from fogproof.checks.statistics.evenness import CALLS, GROUPS
from fogproof.checks.statistics.labels import Sums
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.repeats import KEPT, fingerprints
from fogproof.checks.statistics.serial import Successions
from fogproof.checks.streams import BATCH
from fogproof.checks.subject import Subject
from fogproof.contracts import Draw
from fogproof.errors import InvalidValueError


@dataclass(frozen=True)
class Tally:
    """Counts of samples.

    batches  numbers of the batches that it is of, increasing
    drawn    samples drawn, whatever became of them
    fine     for each axis, (m,) samples of the continuous part in each fine cell
    plane    (size, size) of them in each cell of the plane, or None
    extremes (k, 2) their smallest and largest counted coordinates
    atoms    how often each declared atom was hit
    events   how often each declared event label came up
    serial   products of successive scores
    prints   fingerprints of the points of the first batches
    points   the points of the first batch
    weights  moments of the returned weights, channel by channel
    strange  points whose density the quadrature does not know
    labels   sums of the label test: with all samples, and with those only that were not given up; None without the test
    given_up samples that the sampler itself gave up on
    calls    (calls, k, 32) coarse counts of the first calls, where a stream may be stratified
    watch    what was seen of each promise
    """

    batches: tuple[int, ...]
    drawn: int
    fine: tuple[np.ndarray, ...]
    plane: np.ndarray | None
    extremes: np.ndarray
    atoms: dict[Any, int]
    events: dict[float, int]
    serial: Successions | None
    prints: np.ndarray
    points: np.ndarray
    weights: tuple[Moments, ...]
    strange: np.ndarray
    labels: tuple[Sums, Sums] | None
    given_up: int
    calls: np.ndarray
    watch: Watch = field(repr=False)

    @property
    def continuous(self) -> int:
        """How many samples belong to the continuous part."""
        return int(self.fine[0].sum())

    def merged(self, other: Tally) -> Tally:
        """Return the tally of both; the batches of `self` come first."""
        if other.drawn == 0:
            return self
        if self.drawn == 0:
            return other
        if self.batches[-1] >= other.batches[0]:
            raise InvalidValueError(
                "batches", "must be merged in order and only once", (self.batches[-1], other.batches[0])
            )
        plane = None if self.plane is None or other.plane is None else self.plane + other.plane
        serial = self.serial.merged(other.serial) if self.serial and other.serial else self.serial or other.serial
        low = np.minimum(self.extremes[:, 0], other.extremes[:, 0])
        high = np.maximum(self.extremes[:, 1], other.extremes[:, 1])
        weights = tuple(a.merged(b) for a, b in zip(self.weights, other.weights, strict=True))
        return Tally(
            self.batches + other.batches,
            self.drawn + other.drawn,
            tuple(a + b for a, b in zip(self.fine, other.fine, strict=True)),
            plane,
            np.stack([low, high], axis=-1),
            {point: hits + other.atoms[point] for point, hits in self.atoms.items()},
            {label: hits + other.events[label] for label, hits in self.events.items()},
            serial,
            np.concatenate([self.prints, other.prints])[:KEPT],
            self.points if len(self.points) else other.points,
            weights,
            kept(self.strange, other.strange),
            _joined(self.labels, other.labels),
            self.given_up + other.given_up,
            np.concatenate([self.calls, other.calls])[:CALLS],
            self.watch.merged(other.watch),
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON-ready form."""
        serial = self.serial
        return {
            "batches": list(self.batches),
            "drawn": self.drawn,
            "fine": [_packed(counts) for counts in self.fine],
            "plane": None if self.plane is None else _packed(self.plane),
            "extremes": _packed(self.extremes),
            "atoms": [[_written(point), hits] for point, hits in self.atoms.items()],
            "events": [[label, hits] for label, hits in self.events.items()],
            "serial": None if serial is None else [_packed(getattr(serial, f.name)) for f in fields(serial)],
            "prints": _packed(self.prints),
            "points": _packed(self.points),
            "weights": [moments.to_dict() for moments in self.weights],
            "strange": _packed(self.strange),
            "labels": None if self.labels is None else [[_packed(a) for a in each.columns] for each in self.labels],
            "given_up": self.given_up,
            "calls": _packed(self.calls),
            "broken": {name: list(what) for name, what in self.watch.broken.items()},
            "seen": self.watch.seen,
        }

    @staticmethod
    def from_dict(state: dict[str, Any], watch: Watch) -> Tally:
        """Return the tally that `to_dict` wrote; `watch` supplies the subject."""
        serial = state["serial"]
        broken = {name: (count, example) for name, (count, example) in state["broken"].items()}
        return Tally(
            tuple(state["batches"]),
            state["drawn"],
            tuple(_unpacked(text) for text in state["fine"]),
            None if state["plane"] is None else _unpacked(state["plane"]),
            _unpacked(state["extremes"]),
            {_read(point): hits for point, hits in state["atoms"]},
            dict(state["events"]),
            None if serial is None else Successions(*map(_unpacked, serial)),
            _unpacked(state["prints"]),
            _unpacked(state["points"]),
            tuple(Moments.from_dict(moments) for moments in state["weights"]),
            _unpacked(state["strange"]),
            None if state["labels"] is None else _label_sums(state["labels"]),
            state["given_up"],
            _unpacked(state["calls"]),
            replace(watch, broken=broken, seen=dict(state["seen"])),
        )


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


def _joined(first: tuple[Sums, Sums] | None, second: tuple[Sums, Sums] | None) -> tuple[Sums, Sums] | None:
    if first is None or second is None:
        return first or second
    return first[0].merged(second[0]), first[1].merged(second[1])


def _label_sums(state: list[Any]) -> tuple[Sums, Sums]:
    every, valid = (Sums(*map(_unpacked, columns)) for columns in state)
    return every, valid


def _written(point: Any) -> Any:
    return [float(number).hex() for number in point] if isinstance(point, tuple) else float(point).hex()


def _read(point: Any) -> Any:
    return tuple(map(float.fromhex, point)) if isinstance(point, list) else float.fromhex(point)


def _packed(array: np.ndarray) -> dict[str, Any]:
    data = base64.b64encode(zlib.compress(np.ascontiguousarray(array).tobytes(), 1)).decode()
    return {"dtype": str(array.dtype), "shape": list(array.shape), "data": data}


def _unpacked(packed: dict[str, Any]) -> np.ndarray:
    data = zlib.decompress(base64.b64decode(packed["data"]))
    return np.frombuffer(data, dtype=packed["dtype"]).reshape(packed["shape"]).copy()
