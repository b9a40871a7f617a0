"""A sampler that chooses one of two parts by a uniform number, taken apart: its map jumps there, and tells each part's density.

On either side of the jump the derivative of the map is one over the density of a part. A pdf that is a sum of the two parts' shows
with which weights: those of the choice, if both are right; the other way round, if they are exchanged; their squares, if the
number that chose is used again to place the sample without being stretched to [0, 1), as `uRemapped` of pbrt-v4's SampleDiscrete
is, because each part is then drawn from a piece of its own uniforms alone. So a mixture is known without its formula, and a cause
is an equation that holds or not: no sample is counted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.checks.density.determinant import Map, derivative, determinant
from fogproof.checks.map_density import placed
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Precision, Subject
from fogproof.domains import Discrete
from fogproof.domains.law import Law

_MOST_UNIFORMS = 6
_ROWS = 8  # other uniforms, for all of which the choice is the same
_GRID = 64  # values of the uniform that may choose
_HALVINGS = 40  # of the interval in which the map jumps
_JUMP = 1e-3  # of the spread of the points, at least
_SAME = 1e-6  # of a place where the map jumps
_POINTS, _STARTS = 512, 1 << 13  # points at which both parts are known, and uniforms near one of which each begins
_STEP: dict[Precision, float] = {"float64": 1e-4, "float32": 3e-3}  # of the way to the end of a uniform
_CLOSE: dict[Precision, float] = {"float64": 1e-7, "float32": 1e-5}  # to coordinates that are reached
_NEWTON = 12  # steps of his method
_FEWEST = 64  # points that both parts reach
_VARIES = 0.1  # by how much the ratio of two parts does, or one stands for both
_TOLERANCE: dict[Precision, float] = {"float64": 2e-3, "float32": 1e-2}  # relative error of a pdf that is a sum of both
_ALMOST_ALL = 0.95  # of the points, at which it is


@dataclass(frozen=True)
class Branch:
    """One side of a choice: the map (m, k) -> (m, k) from uniforms of its own to coordinates of the domain's known law."""

    law: Law
    map: Map
    precision: Precision

    def density(self, v: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return (m,) the density at points x, to which uniforms v lead."""
        with np.errstate(all="ignore"):
            return self.law.density(x) / determinant(self.map, v, _STEP[self.precision])

    def leading_to(self, at: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Return uniforms (m, k) that lead to coordinates (m, k), NaN where none are found, by Newton's method from near ones."""
        from scipy.spatial import cKDTree

        starts = rng.random((_STARTS, at.shape[1]))
        reached = self.map(starts)
        good = np.isfinite(reached).all(axis=1)
        if not good.any():
            return np.full_like(at, np.nan)
        v = starts[good][cKDTree(reached[good]).query(at)[1]]
        with np.errstate(all="ignore"):
            for _ in range(_NEWTON):
                slope = derivative(self.map, v, _STEP[self.precision])
                singular = ~(np.abs(np.linalg.det(slope)) > 0)
                slope[singular] = np.eye(at.shape[1])
                step = np.linalg.solve(slope, (at - self.map(v))[:, :, None])[:, :, 0]
                v = np.clip(v + np.nan_to_num(step), 0.5 * v, 0.5 * (1 + v))
            far = ~(np.abs(self.map(v) - at).max(axis=1) <= _CLOSE[self.precision])
        v[far] = np.nan
        return v


def chosen_wrongly(subject: Subject, points: np.ndarray, seed: int) -> tuple[str, str]:
    """Return the cause and the words if a choice between two parts is what is wrong, both "" if it is not.

    points  (n, ...) samples, which set the scale of the domain's law
    """
    if subject.dimensions is None or subject.dimensions > _MOST_UNIFORMS or isinstance(subject.domain, Discrete):
        return "", ""
    law = subject.domain.law(points)
    rng = batch_generator(seed, "diagnosis", 2, 0)
    for column in range(subject.dimensions):
        found = _choice(subject, law, column, rng)
        if found is None:
            continue
        w, again = found
        told = _weights(subject, law, column, w, again, rng)
        if told is not None:
            return _named(w, *told, again, _TOLERANCE[subject.precision])
    return "", ""


def _choice(subject: Subject, law: Law, column: int, rng: np.random.Generator) -> tuple[float, bool] | None:
    """Return where the map jumps along a uniform, whatever the others are, and whether that uniform places the sample too."""
    rows = rng.random((_ROWS, subject.dimensions or 0))
    grid = (np.arange(_GRID) + 0.5) / _GRID

    def at(values: np.ndarray) -> np.ndarray:
        """Return the points (rows, m, k) with m values (rows, m) of the uniform."""
        u = np.repeat(rows, values.shape[1], axis=0)
        u[:, column] = values.ravel()
        return placed(subject, law, u)[0].reshape(_ROWS, values.shape[1], -1)

    def apart(x: np.ndarray) -> np.ndarray:
        return np.linalg.norm(np.diff(x, axis=1), axis=2)

    x = at(np.tile(grid, (_ROWS, 1)))
    gaps = apart(x)
    if not np.all(np.isfinite(gaps)):
        return None
    first = gaps.argmax(axis=1)
    low, high = grid[first], grid[first + 1]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        left, right = apart(at(np.stack([low, middle, high], axis=1))).T
        low, high = np.where(left > right, low, middle), np.where(left > right, middle, high)
    left_over = apart(at(np.stack([low, high], axis=1)))[:, 0]
    spread = float(np.ptp(x.reshape(-1, x.shape[2]), axis=0).max())
    jumps = left_over > _JUMP * spread
    if np.count_nonzero(jumps) < max(1, _ROWS // 2) or np.ptp(low[jumps]) > _SAME:
        return None
    others = np.sort(gaps, axis=1)[:, :-1]
    return float(high[jumps].mean()), bool(others.max() > 0)


def _weights(
    subject: Subject, law: Law, column: int, w: float, again: bool, rng: np.random.Generator
) -> tuple[float, float] | None:
    """Return with which weights the pdf is the sum of both parts' densities, None if it is not, or they do not tell."""
    base = rng.random(subject.dimensions or 0)
    columns = [k for k in range(len(base)) if (again if k == column else _matters(subject, law, k, base))]
    if len(columns) != len(law.axes):
        return None

    def part(low: float, high: float) -> Branch:
        def map_of(v: np.ndarray) -> np.ndarray:
            u = np.tile(base, (len(v), 1))
            u[:, columns] = v
            u[:, column] = low + (high - low) * (u[:, column] if again else 0.5)
            return placed(subject, law, u)[1]

        return Branch(law, map_of, subject.precision)

    both = part(0.0, w), part(w, 1.0)
    densities = []
    for one, other in (both, both[::-1]):
        v = rng.random((_POINTS, len(columns)))
        at = one.map(v)
        v, at = v[np.isfinite(at).all(axis=1)], at[np.isfinite(at).all(axis=1)]
        back = other.leading_to(at, rng)
        met = np.isfinite(back).all(axis=1)
        if not met.any():
            continue
        x = law.place(at[met])
        pair = (one.density(v[met], x), other.density(back[met], x))
        densities.append(np.stack([*(pair if one is both[0] else pair[::-1]), subject.density(x)], axis=1))
    values = np.concatenate(densities) if densities else np.empty((0, 3))
    values = values[np.isfinite(values).all(axis=1) & (values > 0).all(axis=1)]
    if len(values) < _FEWEST or np.std(np.log(values[:, 0] / values[:, 1])) < _VARIES:
        return None
    told = values[:, :2] / values[:, 2:]  # relative to the pdf
    kept = np.ones(len(told), dtype=bool)
    for _ in range(3):  # without the few points near which a part is not smooth
        first, second = np.linalg.lstsq(told[kept], np.ones(int(kept.sum())), rcond=None)[0].tolist()
        off = np.abs(told @ (first, second) - 1)
        kept = off <= np.quantile(off, _ALMOST_ALL)
    return (first, second) if np.mean(off < _TOLERANCE[subject.precision]) >= _ALMOST_ALL else None


def _matters(subject: Subject, law: Law, column: int, base: np.ndarray) -> bool:
    u = np.tile(base, (2 * _ROWS, 1))
    u[:, column] = (np.arange(len(u)) + 0.5) / len(u)
    return bool(np.ptp(placed(subject, law, u)[1], axis=0).max() > 0)


def _named(w: float, first: float, second: float, again: bool, error: float) -> tuple[str, str]:
    """Return the cause and the words of weights of two parts in the pdf beside those of the choice, both "" if they agree."""

    def are(one: float, other: float) -> bool:
        return max(abs(first - one), abs(second - other)) < error

    if are(w, 1 - w):
        return "", ""
    chosen = f"the sampler takes one of two parts with probability {w:.4g}"
    if again and are(w * w, (1 - w) ** 2):
        words = f"{chosen} by a uniform number that it uses again to place the sample: stretch it to [0, 1) first, u / {w:.4g}"
        return "reused number", f"{words} below that and (u - {w:.4g}) / {1 - w:.4g} beyond"
    if are(1 - w, w):
        return (
            "swapped weights",
            f"{chosen}, and in the pdf that part has the weight {1 - w:.4g}: the two are exchanged",
        )
    if abs(first + second - 1) < error and min(first, second) > -error:
        return "wrong share", f"{chosen}, and in the pdf that part has the weight {first:.4g}"
    return "", ""
