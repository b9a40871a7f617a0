"""What a sampler promises about every single sample, and needs no statistics to check."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof.checks import unit_lengths
from fogproof.checks.digits import rounded
from fogproof.checks.subject import Subject, call, in_domain, named
from fogproof.checks.telling import few_digits, nearly, ratio_of, relation
from fogproof.checks.verdict import Finding
from fogproof.contracts import Draw
from fogproof.domains.law import vector_columns
from fogproof.errors import shorten

_CAUSES = {
    "domain": "outside the domain",
    unit_lengths.NAME: "outside the domain",
    "positive pdf": "claimed hole",
    "finite weight": "not a number",
    "finite pdf": "not a number",
    "returned pdf": "wrong pdf returned",
    "returned probability": "wrong pdf returned",
    "weight": "wrong weight",
    "event": "wrong event label",
    "declared events": "wrong event label",
}


_POLE = ": take the distance from it for the coordinate, where numbers are finer, and what is there is judged too"
_NO_NUMBER = ", which has a part that is no number"
_TELLING = {
    "%.17g": "coarse numbers",
    "all are of single precision": "coarse numbers",
    "all are of half precision": "coarse numbers",
    " times pdf)": "wrong measure",
    "pdf is nan at": "not a number",
    _NO_NUMBER: "not a number",
    "pdf is -": "negative pdf",
}
"""Words of an example that say more than the name of the promise."""

_USUAL = 4.0  # times the median: noise has tails


def at_any_atom(subject: Subject, x: np.ndarray) -> np.ndarray:
    """Return (n,) which points are at a declared atom."""
    hits = list(subject.at_atom(x).values())
    return np.any(hits, axis=0) if hits else np.zeros(len(x), dtype=bool)


def inside(subject: Subject, draw: Draw) -> np.ndarray:
    """Return which samples are points of the domain or of a declared atom, or given up by the sampler itself."""
    good = in_domain(subject.domain, draw.x, subject.roundoff)
    if subject.atoms:
        good |= at_any_atom(subject, draw.x)
    return good if draw.valid is None else good | ~draw.valid


def _places(subject: Subject, x: np.ndarray) -> dict[Any, np.ndarray]:
    """Return which points (n,) are at each atom, by its point, and which are elsewhere, by None."""
    places: dict[Any, np.ndarray] = {None: ~at_any_atom(subject, x)}
    for point, at in subject.at_atom(x).items():
        places[point] = at
    return places


def usual_labels(subject: Subject, draw: Draw) -> dict[Any, int]:
    """Return the usual event label at each atom (by its point) and elsewhere (None), as far as the batch shows them."""
    if draw.event is None:
        return {}
    places = _places(subject, draw.x)
    labels = {place: draw.event[where] for place, where in places.items()}
    return {place: Counter(found.tolist()).most_common(1)[0][0] for place, found in labels.items() if len(found)}


@dataclass
class Watch:
    """Looks at every sample of every batch; keeps one example of each kind of broken promise, and how often it happened.

    labels  the event label that belongs to each atom, and to all other points (None)
    """

    subject: Subject
    labels: dict[Any, int] = field(default_factory=dict)
    broken: dict[str, tuple[int, str]] = field(default_factory=dict)
    seen: dict[str, int] = field(default_factory=dict)

    def look(self, draw: Draw) -> tuple[np.ndarray, np.ndarray]:
        """Check one batch; return (n,) which samples are good points of the continuous part, and (good,) the pdf there."""
        subject, x = self.subject, draw.x
        within = inside(subject, draw)
        long = ~within & unit_lengths.off_length(subject, x)
        few = few_digits(subject, x[~within])
        little = nearly(subject, x, ~within & ~long)

        def outside(i: int) -> str:
            length = f": {unit_lengths.told(subject, x[i])}" if long[i] else ""
            why = _NO_NUMBER if np.isnan(x[i]).any() else few or length or little
            return f"x = {shorten(x[i])} is not a point of {subject.domain}{why}"

        self._note("domain", ~within, outside, len(x))
        good = within
        if subject.atoms:
            good = good & ~at_any_atom(subject, x)
        if draw.valid is not None:
            good = good & draw.valid
        at = np.flatnonzero(good)
        points = x if len(at) == len(x) else x[at]
        if vector_columns(subject.domain):  # where every length is wrong no point is good
            self._lengths(x[long | good] if long.any() else points)
        p = subject.density(points)
        self._finite(draw)
        if draw.event is not None and subject.events:
            unknown = ~np.isin(draw.event, list(subject.events))
            self._note(
                "declared events", unknown, _quote("label", draw.event, "is not among the declared events"), len(x)
            )
        pole = (
            p == np.inf
        )  # rounding gathers samples where a density diverges: no error, and nothing can be said of them
        zero = ~(p > 0)
        if zero.any():  # the very edge of the support may be missed by rounding
            beside = (*subject.nudged(points[zero]), _within(subject, points[zero]))
            near = [subject.density(y) for y in beside]
            begins = np.any([np.isfinite(q) & (q > 0) for q in near], axis=0)
            zero[zero] = np.isnan(p[zero]) | ~begins  # no rounding makes a density of what is no number
        if pole.any():
            self._note("infinite pdf", pole, lambda i: f"pdf is inf at the sampled x = {shorten(points[i])}", len(at))
        self._note("positive pdf", zero, lambda i: f"pdf is {p[i]:g} at the sampled x = {shorten(points[i])}", len(at))
        if draw.pdf is not None:
            self._returned(draw.pdf, x, at, p)
        if draw.weight is not None and subject.eval is not None:
            self._weights(draw.weight[at], points)
        if draw.event is not None and subject.atoms:
            self._events(draw.event, x)
        return good, p

    def _lengths(self, points: np.ndarray) -> None:
        off = unit_lengths.off_length(self.subject, points)
        few = few_digits(self.subject, points[off])
        tell = lambda i: f"x = {shorten(points[i])}: {unit_lengths.told(self.subject, points[i])}{few}"  # noqa: E731
        self._note(unit_lengths.NAME, off, tell, len(points))

    def _finite(self, draw: Draw) -> None:
        """Weights and densities of valid samples must be numbers, wherever the samples are."""
        valid = np.ones(len(draw.x), dtype=bool) if draw.valid is None else draw.valid
        for name, values in (("weight", draw.weight), ("pdf", draw.pdf)):
            if values is None:
                continue
            odd = ~np.isfinite(values)
            rows = valid & (odd if odd.ndim == 1 else odd.any(axis=1))
            if name == "pdf" and rows.any():  # where the claimed density is infinite, what is returned may be too
                at = np.flatnonzero(rows & in_domain(self.subject.domain, draw.x, self.subject.roundoff))
                rows[at] = self.subject.density(draw.x[at]) != values[at]
            tell = lambda i, n=name, v=values: f"{n} {shorten(v[i])} at x = {shorten(draw.x[i])}"  # noqa: E731
            self._note(f"finite {name}", rows, tell, len(rows))

    def _returned(self, returned: np.ndarray, x: np.ndarray, at: np.ndarray, p: np.ndarray) -> None:
        subject = self.subject
        got = returned[at]
        differ = ~(np.abs(got - p) <= 64 * subject.roundoff * np.abs(p)) & (got != p)
        if differ.any():
            slack = subject.rounding_spread(subject.density, x[at[differ]])
            differ[differ] = ~(np.abs(got[differ] - p[differ]) <= _with_usual_noise(slack, p[differ]))
        why = ""
        if differ.any():
            why = rounded(subject.density, x[at[differ]], got[differ], p[differ], x) or relation(got[differ], p[differ])
        self._note(
            "returned pdf",
            differ,
            lambda i: (
                f"sample returned {got[i]:.9g}, pdf(x) is {p[i]:.9g} at x = {shorten(x[at[i]])}{ratio_of(got[i], p[i])}{why}"
            ),
            len(at),
        )
        for point, hits in subject.at_atom(x).items():
            values, declared = returned[hits], subject.atoms[point]
            wrong = ~(np.abs(values - declared) <= 1e7 * subject.roundoff * declared)
            text = f"at the atom {named(point)}, declared {declared:.9g}"
            self._note("returned probability", wrong, _quote("sample returned", values, text), len(wrong))

    def _weights(self, got: np.ndarray, points: np.ndarray) -> None:
        subject = self.subject

        def right(y: np.ndarray) -> np.ndarray:
            assert subject.eval is not None
            value = np.asarray(call("eval(x)", subject.eval, y), dtype=np.float64)
            p = subject.density(y)
            return value / (p if value.ndim == 1 else p[:, None])

        w = right(points)
        differ = ~(np.abs(got - w) <= 64 * subject.roundoff * np.abs(w)) & np.isfinite(w)
        rows = np.flatnonzero(differ if differ.ndim == 1 else differ.any(axis=1))
        wrong = np.zeros(len(points), dtype=bool)
        if len(rows):
            slack = _with_usual_noise(subject.rounding_spread(right, points[rows]), w[rows])
            off = ~(np.abs(got[rows] - w[rows]) <= slack) & differ[rows]
            wrong[rows] = off if off.ndim == 1 else off.any(axis=1)
        tell = lambda i: f"weight {shorten(got[i])}, eval/pdf is {shorten(w[i])} at x = {shorten(points[i])}"  # noqa: E731
        self._note("weight", wrong, tell, len(points))

    def _events(self, event: np.ndarray, x: np.ndarray) -> None:
        places = _places(self.subject, x)
        for place, where in places.items():
            if place not in self.labels:
                continue
            usual, got = self.labels[place], event[where]
            wrong = got != usual
            if place is not None and usual == self.labels.get(None):
                wrong = np.ones(len(got), dtype=bool)
            spot = "between the atoms" if place is None else f"at the atom {named(place)}"
            self._note("event", wrong, _quote("label", got, f"{spot}, where {usual} is usual"), len(got))

    def _note(self, name: str, bad: np.ndarray, tell: Callable[[int], str], n: int) -> None:
        self.seen[name] = self.seen.get(name, 0) + n
        count = int(np.count_nonzero(bad))
        if count:
            before, example = self.broken.get(name, (0, ""))
            self.broken[name] = (before + count, example or tell(int(np.argmax(bad))))

    def merged(self, other: Watch) -> Watch:
        """Return what both have seen; the first example stands."""
        seen = {name: self.seen.get(name, 0) + other.seen.get(name, 0) for name in {**self.seen, **other.seen}}
        broken = dict(self.broken)
        for name, (count, example) in other.broken.items():
            before, first = broken.get(name, (0, ""))
            broken[name] = (before + count, first or example)
        return Watch(self.subject, self.labels, broken, seen)

    def findings(self) -> list[Finding]:
        """Return one finding for each promise that was looked at."""
        found = []
        for name, n in self.seen.items():
            count, example = self.broken.get(name, (0, ""))
            seldom = name == unit_lengths.NAME and not unit_lengths.too_many(count, n)
            if count and not seldom:
                if name == "infinite pdf":
                    message = f"{count} of {n} samples: {example}; a pole so strong that rounding gathers samples on it{_POLE}"
                    found.append(Finding(name, "inconclusive", message, effect=count / n))
                    continue
                telling = (cause for words, cause in _TELLING.items() if words in example)
                cause = next(telling, _CAUSES[name])
                message = f"{count} of {n} samples: {example}"
                found.append(Finding(name, "rejected", message, effect=count / n, cause=cause))
            else:
                few = f" but {count}, and so few may be off at the pole of a lobe" if count else ""
                found.append(Finding(name, "not rejected", f"kept by all {n} samples{few}"))
        return found


def _within(subject: Subject, x: np.ndarray) -> np.ndarray:
    """Return the points, those beyond an end of the domain or at it moved inside; the others stay but for rounding."""
    law, edge = subject.domain.law(x), max(2.0**-46, 4 * subject.roundoff)  # of an axis, from its ends
    return law.place(np.clip(law.coordinates(x, np.full((len(x), len(law.axes)), 0.5)), edge, 1 - edge))


def _with_usual_noise(slack: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Return the slack of each value, or that of a usual one where it is larger.

    A few neighbours do not always show how noisy a function is: single precision rounds a cosine near 1, or does not.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = slack / np.abs(value)
    known = relative[np.isfinite(relative)]
    usual = _USUAL * float(np.median(known)) if len(known) else 0.0
    return np.maximum(slack, usual * np.abs(value))


def _quote(what: str, values: np.ndarray, rest: str) -> Callable[[int], str]:
    return lambda i: f"{what} {values[i]:.9g} {rest}"
