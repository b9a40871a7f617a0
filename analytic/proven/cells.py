"""Layers and voxels along one ray as exact pieces: the crossings of their planes are fractions, sorted."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

from fogproof.analytic.proven.balls import flint, rational
from fogproof.analytic.proven.pieces import Piece, constant


class ProvenStretch(NamedTuple):
    """Between two crossings: where it starts, its length (None if endless), and the cell along each axis."""

    start: Any
    length: Any
    cell: tuple[int, ...]


def stretches(o: list[Any], w: list[Any], planes: list[list[Any]], s: Any) -> Iterator[ProvenStretch]:
    """Yield what lies between consecutive crossings of all planes, each crossing an exact fraction.

    o, w    coordinate and its growth a metre, along each axis
    planes  along each axis, in order; None stands for infinity
    s       length of the ray, None if endless
    """
    fq = flint().fmpq
    met = {fq(0)} | ({s} if s is not None else set())
    for x, d, places in zip(o, w, planes, strict=True):
        met |= {(p - x) / d for p in places if p is not None and d != 0}
    cuts: list[Any] = sorted(t for t in met if t >= 0 and (s is None or t <= s))
    ends = [*cuts[1:], None] if s is None else cuts[1:]
    for start, end in zip(cuts, ends, strict=False):
        middle = start + 1 if end is None else (start + end) / 2
        place = [x + middle * d for x, d in zip(o, w, strict=True)]
        cell = [_cell(places, p) for places, p in zip(planes, place, strict=True)]
        known = tuple(c for c in cell if c is not None)
        if len(known) == len(cell):
            yield ProvenStretch(start, None if end is None else end - start, known)


def constant_cells(medium: Any, o: list[Any], w: list[Any], planes: list[list[Any]], s: Any) -> list[Piece]:
    """Return a piece for each cell of constant coefficients."""
    found = []
    for _, length, cell in stretches(o, w, planes, s):
        at = [rational(a[cell] if a.ndim else a) for a in (medium.albedo, medium.emission)]
        found.append(constant(rational(medium.sigma_t[cell]), length, *at))
    return found


def _cell(places: list[Any], p: Any) -> int | None:
    """Return which interval between the places holds p, closed below and open above; None stands for infinity."""
    for i, (low, high) in enumerate(pairwise(places)):
        if (low is None or low <= p) and (high is None or p < high):
            return i
    return None
