"""The pdf against the sampler's own map: where it sends uniforms densely, the pdf must be large.

The points that a part of the uniforms leads to have at least the probability of that part, and more if other parts lead there
too. So pdf(x(u)) |det dx/du| is at least 1 on average over every part of the uniforms, and exactly 1 where a single u leads to
each point: the change of variables, as an inequality that no right sampler breaks. Both are functions, so no sample is counted
and chance has no part in it but in which uniforms are looked at: what 1e9 samples could not show is seen to five digits.

It is asked where as many uniforms matter as points have coordinates. The derivative is taken in the coordinates of the domain's
known law by central differences of fourth order (Abramowitz & Stegun 1964, 25.3.6), and believed where three steps agree.
Averages over parts are judged, not single points: a table of the inverse cdf is right on average alone. A part is rejected only
if differences over a billionth of the way say so too: seen from afar a table of a million cells is a straight line. Uniforms
without a derivative may lead anywhere, also where their neighbours lead: their share is allowed for.
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
_PART = 32  # uniforms of a part
_STEPS = (0.03, 0.01, 0.003, 1e-3, 3e-4, 1e-4)  # of the way to the nearer end of a uniform
_FINE, _FINEST_BITS = 1e-9, 10  # another such step, but of so many bits of a uniform at least
_STENCIL = np.array([-1.0, -0.5, 0.5, 1.0])  # places in steps
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 6  # over the step
_AGREE: dict[Precision, float] = {"float64": 1e-4, "float32": 1e-3}  # relative, of three steps
_ROUGH = 1e-2  # relative difference of the fine step, with more of which a derivative is not sound
_MOSTLY = 0.5  # of the derivatives: if fewer are sound nothing is said
_TOLERANCE: dict[Precision, float] = {"float64": 2e-5, "float32": 4e-4}  # of an average, never rejected
_DOUBT = 8.0  # standard errors of an average
_ENOUGH = 0.05  # of the uniforms: with fewer derivatives nothing is said
_IDLE = 1 << 17  # uniforms at which a column that nothing seems to depend on is tried once more
_RARE = 21.0  # over these: what has that probability is met by one of them, but for a chance of 1e-9
_FEW = 8  # points of a part that have one
_MOST_AXES = 16


@dataclass(frozen=True)
class MapDensity:
    """What was seen at uniforms u (n, k) that lead to points x: pdf times derivative (n,), and what steps disagree by (n,).

    The derivative is NaN where it is not believed; `fine` is the same by the fine step. Other uniforms may still matter with the
    probability `rare`, and lead elsewhere.
    """

    u: np.ndarray
    x: np.ndarray
    volume: np.ndarray
    fine: np.ndarray
    doubt: np.ndarray
    rare: float

    @property
    def believed(self) -> np.ndarray:
        """Which uniforms have a derivative (n,)."""
        return ~np.isnan(self.volume)

    @property
    def sound(self) -> np.ndarray:
        """Which have one that the fine step knows of too (n,)."""
        with np.errstate(all="ignore"):
            return np.abs(self.fine / self.volume - 1) < _ROUGH


def map_density(subject: Subject, points: np.ndarray, seed: int) -> list[Finding]:
    """Return one finding, or none where the map has no such derivative; `points` (n, ...) set the scale of the domain's law."""
    if subject.dimensions is None or subject.dimensions > _MOST_AXES or isinstance(subject.domain, Discrete):
        return []
    law = subject.domain.law(points)
    if law.stepped or len(law.axes) > subject.dimensions:
        return []
    seen = _seen(subject, law, seed)
    if seen is None or np.count_nonzero(seen.believed) < max(_ENOUGH * len(seen.u), _FEW):
        return []
    if np.mean(seen.sound[seen.believed]) < _MOSTLY:
        return []
    return [_judged(subject, seen)]


def _judged(subject: Subject, seen: MapDensity) -> Finding:
    worst, where = 0.0, np.empty(0, dtype=int)
    seen_from: list[float] = []  # what an average must lack, part by part
    scattered = 1 - float(np.mean(seen.sound[seen.believed]))  # among their neighbours: as if by chance
    for part in _parts(seen.u):
        told = part[seen.sound[part]]
        if len(told) < _FEW:
            continue
        elsewhere = max(1 - len(told) / len(part), scattered) + seen.rare * len(seen.u) / len(part)
        known = _least(seen.volume[told]) - float(np.mean(seen.doubt[told]))
        lacking = min(known, _least(seen.fine[told])) - elsewhere
        seen_from.append(1 - float(np.mean(seen.volume[told])) - lacking + _TOLERANCE[subject.precision])
        if lacking > max(worst, _TOLERANCE[subject.precision]):
            worst, where = lacking, told
    volume = seen.volume[seen.believed]
    if not len(where):
        return Finding(
            NAME, "not rejected", _agreement(volume, seen_from[0]), effect=max(0.0, 1 - float(np.mean(volume)))
        )
    effect = 1 - float(np.mean(seen.volume[where]))
    place = int(where[np.argmin(seen.volume[where])])
    message = (
        f"where a part of the uniforms leads, as around x = {shorten(seen.x[place])}, samples are"
        f" {1 / max(1 - effect, 1e-300):.8g} times as dense as the pdf says: it times the derivative of the map is"
        f" {1 - effect:.8g} there on average, and for a right pdf never less than 1"
    )
    alike = bool(np.ptp(volume) < _TOLERANCE[subject.precision])
    if alike:
        message += "; it is the same everywhere: the pdf is too small, or there are points that no uniforms lead to"
    return Finding(NAME, "rejected", message, effect=effect, cause="skipped band" if alike else "shape")


def _least(volume: np.ndarray) -> float:
    """Return what an average (n,) lacks of 1 beyond chance, -inf where it is not known."""
    spread = float(np.std(volume))
    lacking = 1 - float(np.mean(volume)) - _DOUBT * spread / np.sqrt(len(volume))
    return lacking if np.isfinite(lacking) else -np.inf


def _agreement(volume: np.ndarray, seen_from: float) -> str:
    """Return in words what was seen at all uniforms (n,), of which the average tells an error that is larger than `seen_from`."""
    one = np.abs(volume - 1)
    digits = float(np.quantile(one, 0.99))
    if digits < 1e-2:
        return f"pdf times the derivative of the map is 1 to within {digits:.1g} at 99% of {len(volume)} uniforms"
    average = f"pdf times the derivative of the map is {np.mean(volume):.5g} on average at {len(volume)} uniforms"
    return f"{average}; that it is less than 1 tells an error where more than {seen_from:.2g} is lacking"


def _parts(u: np.ndarray) -> list[np.ndarray]:
    """Return the indices of parts of uniforms (n, k): all, boxes by halves along one axis after the other, slices of each axis."""
    halves = [np.arange(len(u))]
    for level in range(int(np.log2(len(u) / _PART))):
        axis = level % u.shape[1]
        halves = [half for part in halves for half in np.array_split(part[np.argsort(u[part, axis])], 2)]
    slices = [part for column in u.T for part in np.array_split(np.argsort(column), len(u) // _PART)]
    return [np.arange(len(u)), *halves, *(slices if u.shape[1] > 1 else [])]


def _seen(subject: Subject, law: Law, seed: int) -> MapDensity | None:
    """Return what there is to see, None where more or fewer uniforms matter than there are coordinates."""
    count = min(_POINTS, _MOST // (subject.dimensions or 1))
    rng = batch_generator(seed, "map", 0, 0)
    u = rng.random((count, subject.dimensions or 0))
    x, at, good = placed(subject, law, u)
    columns = range(u.shape[1])
    axes = [column for column in columns if _matters(subject, law, u, column, at)]
    if len(axes) != len(law.axes):
        return None
    rare = 0.0
    if len(axes) < u.shape[1]:
        many = rng.random((_IDLE, u.shape[1]))
        there, rare = placed(subject, law, many)[1], _RARE / _IDLE
        if any(_matters(subject, law, many, column, there) for column in columns if column not in axes):
            return None
    volume, fine, doubt = np.full((3, count), np.nan)
    if good.any():
        claimed = subject.density(x[good]) / law.density(x[good])
        derivative, doubt[good] = _derivatives(subject, law, u[good], axes)
        smallest = max(_FINE, 2.0 ** (_FINEST_BITS - (subject.uniform_bits or 53)))
        volume[good], fine[good] = claimed * derivative, claimed * _derivative(subject, law, u[good], axes, smallest)
    return MapDensity(u[:, axes], x, volume, fine, doubt, rare)


def _matters(subject: Subject, law: Law, u: np.ndarray, column: int, at: np.ndarray) -> bool:
    moved = u.copy()
    moved[:, column] = np.roll(moved[:, column], 1)
    return not np.array_equal(placed(subject, law, moved)[1], at, equal_nan=True)


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
    at = placed(subject, law, moved.reshape(-1, u.shape[1]))[1].reshape(*moved.shape[:3], len(axes))
    with np.errstate(all="ignore"):
        matrix = np.einsum("p,ipnk->nki", _WEIGHTS, at) / lengths[:, None, :]
        return np.abs(np.linalg.det(matrix))


def placed(subject: Subject, law: Law, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points of uniforms, their coordinates (n, k), NaN where there is no density, and where there is one."""
    draw = subject.draw_at(u)
    good = inside(subject, draw) & ~at_any_atom(subject, draw.x)
    if draw.valid is not None:
        good &= draw.valid
    at = np.full((len(u), len(law.axes)), np.nan)
    if good.any():
        at[good] = law.coordinates(draw.x[good], np.full((int(good.sum()), len(law.axes)), 0.5))
    return draw.x, at, good
