"""The pdf against the sampler's own map: where it sends uniforms densely, the pdf must be large.

The points that a part of the uniforms leads to have at least the probability of that part, and more if other parts lead there
too. So pdf(x(u)) |det dx/du| is at least 1 on average over every part of the uniforms, and exactly 1 where a single u leads to
each point: the change of variables, as an inequality that no right sampler breaks. Both are functions, so no sample is counted
and chance has no part in it but in which uniforms are looked at: what 1e9 samples could not show is seen to five digits.

It is asked where as many uniforms matter as points have coordinates. The derivative is taken in the coordinates of the domain's
known law by central differences of fourth order (Abramowitz & Stegun 1964, 25.3.6), and believed where three steps agree; jumps
are passed over. Averages over parts are judged, not single points: a table of the inverse cdf is right on average alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fogproof.checks.promises import at_any_atom, inside
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Precision, Subject
from fogproof.checks.verdict import Finding
from fogproof.domains import Discrete
from fogproof.domains.law import Law
from fogproof.errors import shorten

NAME = "pdf against the map"

_POINTS, _MOST = 1 << 10, 1 << 12  # uniforms looked at, and at most so many times their dimensions
_HALVINGS = 5  # of the points: 32 parts
_STEPS = (0.03, 0.01, 0.003, 1e-3, 3e-4, 1e-4)  # of the way to the nearer end of a uniform
_STENCIL = np.array([-1.0, -0.5, 0.5, 1.0])  # places in steps
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 6  # over the step
_AGREE: dict[Precision, float] = {"float64": 1e-4, "float32": 1e-3}  # relative, of three steps
_TOLERANCE: dict[Precision, float] = {"float64": 2e-5, "float32": 4e-4}  # of an average, never rejected
_DOUBT = 8.0  # standard errors of an average
_ENOUGH = 0.05  # of the uniforms: with fewer derivatives nothing is said
_RARE = 21.0  # over the uniforms looked at: what has that probability is met by one of them, but for a chance of 1e-9
_FEW = 8  # points of a part that have one
_MOST_AXES = 16


@dataclass(frozen=True)
class MapDensity:
    """What was seen at uniforms u (n, d) that lead to points x: pdf times derivative (n,), and what steps disagree by (n,).

    The derivative is NaN where it is not believed. Other uniforms may still matter with the probability `rare`, and lead elsewhere.
    """

    u: np.ndarray
    x: np.ndarray
    volume: np.ndarray
    doubt: np.ndarray
    rare: float

    @property
    def believed(self) -> MapDensity:
        """What was seen at points that have a derivative."""
        told = ~np.isnan(self.volume)
        return MapDensity(self.u[told], self.x[told], self.volume[told], self.doubt[told], self.rare)


def map_density(subject: Subject, points: np.ndarray, seed: int) -> list[Finding]:
    """Return one finding, or none where the map has no such derivative; `points` (n, ...) set the scale of the domain's law."""
    if subject.dimensions is None or subject.dimensions > _MOST_AXES or isinstance(subject.domain, Discrete):
        return []
    law = subject.domain.law(points)
    if law.stepped or len(law.axes) > subject.dimensions:
        return []
    found = _seen(subject, law, seed)
    if found is None:
        return []
    believed = found.believed
    if len(believed.u) < max(_ENOUGH * len(found.u), _FEW):
        return []
    return [_judged(subject, believed)]


def _judged(subject: Subject, seen: MapDensity) -> Finding:
    tolerance = _TOLERANCE[subject.precision] + seen.rare
    worst, where = 0.0, np.empty(0, dtype=int)
    for part in [np.arange(len(seen.u)), *_parts(seen.u)]:
        lacking = 1 - seen.volume[part]
        if len(part) < _FEW or not np.all(np.isfinite(lacking)):
            continue
        mean = float(np.mean(lacking))
        doubt = _DOUBT * float(np.std(lacking)) / np.sqrt(len(part)) + float(np.mean(seen.doubt[part]))
        if mean > max(worst, tolerance + doubt):
            worst, where = mean, part
    if not len(where):
        return Finding(NAME, "not rejected", _agreement(seen.volume), effect=max(0.0, 1 - float(np.mean(seen.volume))))
    place = int(where[np.argmax(1 - seen.volume[where])])
    message = (
        f"where a part of the uniforms leads, as around x = {shorten(seen.x[place])}, samples are"
        f" {1 / max(1 - worst, 1e-300):.5g} times as dense as the pdf says: it times the derivative of the map is"
        f" {1 - worst:.5g} there on average, and for a right pdf never less than 1"
    )
    alike = bool(np.ptp(seen.volume) < tolerance)
    if alike:
        message += "; it is the same everywhere: the pdf is too small, or there are points that no uniforms lead to"
    return Finding(NAME, "rejected", message, effect=worst, cause="skipped band" if alike else "shape")


def _agreement(volume: np.ndarray) -> str:
    one = np.abs(volume - 1)
    digits = float(np.quantile(one, 0.99))
    if digits < 1e-2:
        return f"pdf times the derivative of the map is 1 to within {digits:.1g} at 99% of {len(volume)} uniforms"
    return f"pdf times the derivative of the map is nowhere less than 1 on average, at {len(volume)} uniforms"


def _parts(u: np.ndarray) -> list[np.ndarray]:
    """Return the indices of parts of the uniforms (n, d), cut in halves along one axis after the other."""
    parts = [np.arange(len(u))]
    for level in range(_HALVINGS):
        axis = level % u.shape[1]
        parts = [half for part in parts for half in np.array_split(part[np.argsort(u[part, axis])], 2)]
    return parts


def _seen(subject: Subject, law: Law, seed: int) -> MapDensity | None:
    """Return what there is to see, None where more or fewer uniforms matter than there are coordinates."""
    count = min(_POINTS, _MOST // (subject.dimensions or 1))
    u = subject.uniforms(batch_generator(seed, "map", 0, 0), count).astype(np.float64)
    x, at, good = _placed(subject, law, u)
    axes = [column for column in range(u.shape[1]) if _matters(subject, law, u, column, at)]
    if len(axes) != len(law.axes):
        return None
    rare = _RARE / len(u) if len(axes) < u.shape[1] else 0.0
    u, x = u[good], x[good]
    claimed = subject.density(x) / law.density(x)
    derivative, doubt = _derivatives(subject, law, u, axes)
    return MapDensity(u[:, axes], x, claimed * derivative, doubt, rare)


def _matters(subject: Subject, law: Law, u: np.ndarray, column: int, at: np.ndarray) -> bool:
    moved = u.copy()
    moved[:, column] = np.roll(moved[:, column], 1)
    return not np.array_equal(_placed(subject, law, moved)[1], at, equal_nan=True)


def _derivatives(subject: Subject, law: Law, u: np.ndarray, axes: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Return |det dx/du| (n,) in the law's coordinates, NaN where no three steps agree, and by how much they do not agree."""
    found, doubt = np.full((2, len(u)), np.nan)
    tried: list[np.ndarray] = []
    todo = np.arange(len(u))
    for step in _STEPS:
        tried.append(_derivative(subject, law, u[todo], axes, step))
        if len(tried) < 3:
            continue
        with np.errstate(all="ignore"):
            gap = np.max([np.abs(a - b) / np.minimum(a, b) for a, b in pairwise(tried)], axis=0)
        sure = gap < _AGREE[subject.precision]
        found[todo[sure]], doubt[todo[sure]] = tried[1][sure], gap[sure]
        todo, tried = todo[~sure], [each[~sure] for each in tried[1:]]
        if not len(todo):
            break
    return found, doubt


def _derivative(subject: Subject, law: Law, u: np.ndarray, axes: list[int], step: float) -> np.ndarray:
    """Return |det dx/du| (n,) by differences over one step, in one call: other people's programs are slow to begin."""
    lengths = step * np.minimum(u[:, axes], 1 - u[:, axes])
    moved = np.tile(u, (len(axes), len(_STENCIL), 1, 1))
    for i, axis in enumerate(axes):
        moved[i, :, :, axis] += _STENCIL[:, None] * lengths[:, i]
    at = _placed(subject, law, moved.reshape(-1, u.shape[1]))[1].reshape(*moved.shape[:3], len(axes))
    with np.errstate(all="ignore"):
        matrix = np.einsum("p,ipnk->nki", _WEIGHTS, at) / lengths[:, None, :]
        return np.abs(np.linalg.det(matrix))


def _placed(subject: Subject, law: Law, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points of uniforms, their coordinates (n, k), NaN where there is no density, and where there is one."""
    draw = subject.draw_at(u.astype(subject.precision))
    good = inside(subject, draw) & ~at_any_atom(subject, draw.x)
    if draw.valid is not None:
        good &= draw.valid
    at = np.full((len(u), len(law.axes)), np.nan)
    if good.any():
        at[good] = law.coordinates(draw.x[good], np.full((int(good.sum()), len(law.axes)), 0.5))
    return draw.x, at, good
