"""A density on a grid, from a file: the numbers that somebody plotted, or an environment map.

CSV of two columns on a line (points, densities) or on the sphere (cosines to `axis`, densities per steradian): linear in between.
`.npy` (h, w) on the unit square: constant on each cell, row h along the second coordinate, as an image lies.

A table of a curved density is not the density. How far linear interpolation is off is estimated by leaving out every second point
(Richardson), and only so many samples are judged as cannot see it: n int (p' - p)^2 / p <= 1/10, a bound on the noncentrality of
any test of cells. `exact = true` says that the table is the law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fogproof.contracts import Reference
from fogproof.domains import Domain, HalfLine, Interval, RealLine, UnitSphere, UnitSquare
from fogproof.errors import InvalidInputError, InvalidValueError, UnsupportedError
from fogproof.pipe.files import read_rows

_UNSEEN = 0.1  # noncentrality that no test sees
_LEAST = 1000  # samples, fewer decide nothing
_LINES = (Interval, HalfLine, RealLine)


@dataclass(frozen=True)
class Table:
    """A density made of a table; see `fogproof.pipe.truth.KnownLaw` for its parts."""

    density: Callable[[np.ndarray], Reference]
    cdf: Callable[[np.ndarray], np.ndarray] | None = None
    most: int | None = None
    notes: tuple[str, ...] = ()


def read_density(path: Path, domain: Domain, axis: tuple[float, float, float] | None, exact: bool) -> Table:
    """Return the density that a file holds for a domain, or raise a `FogproofError` that names the file."""
    rows, _ = read_rows(path, 0, "float64")
    if isinstance(domain, UnitSquare):
        return _map(path, rows)
    if not isinstance(domain, (*_LINES, UnitSphere)):
        raise UnsupportedError(f"a table serves lines, the sphere and the square, not {domain}", "table")
    if rows.shape[1] != 2 or len(rows) < 2:
        raise InvalidInputError(
            f"{path} must have two columns and at least two rows, got {list(rows.shape)}", str(path)
        )
    x, p = rows.T
    sphere = isinstance(domain, UnitSphere)
    low, high = (-1.0, 1.0) if sphere else (getattr(domain, end, sign * np.inf) for end, sign in (("a", -1), ("b", 1)))
    if not (np.diff(x) > 0).all() or not np.isfinite(x).all():
        raise InvalidInputError(f"{path}: the first column must increase", str(path))
    if not (np.isfinite(p) & (p >= 0)).all() or not p.any():
        raise InvalidInputError(f"{path}: the second column must hold finite densities >= 0", str(path))
    if x[0] < low or x[-1] > high or (sphere and (x[0] > low or x[-1] < high)):
        rule = "from -1 to 1" if sphere else f"inside [{low:g}, {high:g}]"
        raise InvalidInputError(f"{path}: the first column must run {rule}, got {x[0]:g} to {x[-1]:g}", str(path))
    measure = 2 * np.pi if sphere else 1.0
    scale, most, notes = (1.0, None, ()) if exact else _tamed(path, x, p * measure)
    p = p * scale
    if sphere:
        if axis is None:
            raise InvalidValueError("axis", "must be given with a table on the sphere", None, "axis = [0, 0, 1]")
        pole = np.asarray(axis, dtype=float)
        return Table(lambda y: _linear(x, p, y @ pole), None, most, notes)
    before = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(x) * (p[1:] + p[:-1]))])

    def cdf(y: np.ndarray) -> np.ndarray:
        i = np.clip(np.searchsorted(x, y, side="right") - 1, 0, len(x) - 2)
        t = np.clip(y, x[0], x[-1]) - x[i]
        slope = (p[i + 1] - p[i]) / (x[i + 1] - x[i])
        return np.asarray(before[i] + t * (p[i] + 0.5 * slope * t))

    return Table(lambda y: _linear(x, p, y), cdf, most, notes)


def _linear(x: np.ndarray, p: np.ndarray, at: np.ndarray) -> Reference:
    value = np.interp(at, x, p, left=0.0, right=0.0)
    return Reference(value, 1e-14 * value)


def _map(path: Path, values: np.ndarray) -> Table:
    h, w = values.shape
    if not (np.isfinite(values) & (values >= 0)).all():
        raise InvalidInputError(f"{path}: densities must be finite and >= 0", str(path))

    def density(x: np.ndarray) -> Reference:
        column, row = (np.clip((x[:, i] * n).astype(np.intp), 0, n - 1) for i, n in ((0, w), (1, h)))
        return Reference(values[row, column])

    return Table(density)


def _tamed(path: Path, x: np.ndarray, p: np.ndarray) -> tuple[float, int | None, tuple[str, ...]]:
    """Return what the table is to be multiplied by, how many samples it can judge, and what is to be said of it."""
    total = float(np.sum(0.5 * np.diff(x) * (p[1:] + p[:-1])))
    coarse = np.interp(x, x[::2], p[::2]) if len(x) > 4 else np.zeros_like(p)
    off = np.abs(p - coarse) / 3
    floor = np.maximum(p, 1e-3 * p.max())
    noncentrality = float(np.trapezoid(off**2 / floor, x))
    doubt = float(np.trapezoid(off, x))
    if abs(total - 1) > 3 * doubt + 1e-9:
        return 1.0, None, ()  # no interpolation explains that: let it be judged
    if noncentrality == 0:
        return 1 / total, None, ()
    most = int(min(_UNSEEN / noncentrality, 1e12))
    if most < _LEAST:
        raise InvalidInputError(
            f"{path} is too coarse: straight lines between its {len(x)} points miss the density by so much that"
            f" {most} samples would see it; give more points, or exact = true if it is made of straight lines",
            str(path),
        )
    return 1 / total, most, (f"the table of {len(x)} points is good enough to judge {most} samples",)
