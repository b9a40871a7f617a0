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

from fogproof.checks.density.features import kept
from fogproof.checks.promises import Watch
from fogproof.checks.statistics.evenness import CALLS
from fogproof.checks.statistics.labels import Sums
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.repeats import KEPT
from fogproof.checks.statistics.serial import Successions
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
    check    fingerprint of the check that drew them: only tallies of one check merge
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
    check: str = ""

    @property
    def continuous(self) -> int:
        """How many samples belong to the continuous part."""
        return int(self.fine[0].sum())

    def merged(self, other: Tally) -> Tally:
        """Return the tally of both, which are of one check; the batches of `self` come first."""
        if self.check and other.check and self.check != other.check:
            rule = "must be of one check: the same subject, samples, seed and version"
            raise InvalidValueError("tallies", rule, f"those of {self.check} and {other.check}")
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
            self.check or other.check,
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON-ready form."""
        serial = self.serial
        return {
            "check": self.check,
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
        try:
            return Tally._of(state, watch)
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError, zlib.error) as error:
            rule = "must be what Tally.to_dict returned"
            raise InvalidValueError("state", rule, f"{type(error).__name__}: {error}") from None

    @staticmethod
    def _of(state: dict[str, Any], watch: Watch) -> Tally:
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
            str(state["check"]),
        )


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
