"""A density on a grid, from a file: the numbers that somebody plotted, or an environment map.

Two columns on a line (points, densities) or on the sphere (cosines to `axis`, densities per steradian): linear in between.
(h, w) numbers on the unit square: constant on each cell, row h along the second coordinate, as an image lies. There a spec must say
so, as an array of densities may as well be meant to be interpolated.

A table of a curved density is not the density. How far linear interpolation is off is estimated by leaving out every second point
(Richardson), and only so many samples are judged as cannot see it: n int (p' - p)^2 / p <= 1/10, a bound on the noncentrality of
any test of cells. `exact = true` says that the table is the law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from fogproof.contracts import Reference
from fogproof.domains import Domain, HalfLine, Interval, RealLine, UnitSphere, UnitSquare
from fogproof.errors import InvalidInputError, InvalidValueError, UnsupportedError
from fogproof.pipe.files import read_rows

_UNSEEN = 0.1  # noncentrality that no test sees
_SAME = 1e-6  # of an integral: printed digits
_LEAST = 1000  # samples, fewer decide nothing
Interpolation = Literal["linear", "constant"]
_LINES = (Interval, HalfLine, RealLine)


@dataclass(frozen=True)
class Table:
    """A density made of a table; see `fogproof.pipe.truth.KnownLaw` for its parts."""

    density: Callable[[np.ndarray], Reference]
    cdf: Callable[[np.ndarray], np.ndarray] | None = None
    most: int | None = None
    notes: tuple[str, ...] = ()


def read_density(
    path: Path,
    domain: Domain,
    axis: tuple[float, float, float] | None,
    exact: bool,
    mass: float = 1.0,
    interpolation: Interpolation | None = None,
) -> Table:
    """Return the density that a file holds for a domain, or raise a `FogproofError` that names the file.

    mass           its integral: what atoms leave
    interpolation  linear on lines and the sphere, which is meant if it is None; constant on the square, which must be said
    """
    if not isinstance(domain, (*_LINES, UnitSphere, UnitSquare)):
        raise UnsupportedError(f"a table serves lines, the sphere and the square, not {domain}", "table")
    _require_interpolation(domain, interpolation)
    rows, names = read_rows(path, 0, "float64")
    if isinstance(domain, UnitSquare):
        return _map(path, rows, mass)
    if rows.shape[1] != 2 or len(rows) < 2:
        raise InvalidInputError(
            f"{path} must have two columns and at least two rows, got {list(rows.shape)}", str(path)
        )
    x, p = rows.T[::-1] if names == ("pdf", "x") else rows.T
    sphere = isinstance(domain, UnitSphere)
    low, high = (-1.0, 1.0) if sphere else (getattr(domain, end, sign * np.inf) for end, sign in (("a", -1), ("b", 1)))
    broken = _broken(x, p, low, high, sphere)
    if broken:
        hint = (
            "" if _broken(p, x, low, high, sphere) else "; its columns are swapped: points come first, then densities"
        )
        raise InvalidInputError(f"{path}: {broken}{hint}", str(path))
    measure = 2 * np.pi if sphere else 1.0
    scale, most, notes = _tamed(path, x, p * measure, mass, exact)
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


def _require_interpolation(domain: Domain, interpolation: Interpolation | None) -> None:
    """Refuse what a domain's tables do not have, and a square's of which it is not said."""
    square = isinstance(domain, UnitSquare)
    if square and interpolation is None:
        rule = "must be said of a table on the square: each number is the density of a cell"
        raise InvalidValueError("interpolation", rule, None, 'interpolation = "constant"')
    if square and interpolation == "linear":
        fix = "give one density for each cell, as many cells as it needs"
        raise UnsupportedError(f"a table on the square is constant on each cell, not linear; {fix}", "interpolation")
    if not square and interpolation == "constant":
        fix = "give each step by two points, one on either side"
        raise UnsupportedError(
            f"a table on {domain} is linear between its points, not constant; {fix}", "interpolation"
        )


def _broken(x: np.ndarray, p: np.ndarray, low: float, high: float, whole: bool) -> str:
    """Return what is wrong with points and densities on [low, high], "" if nothing is; `whole`: they must reach its ends."""
    if not (np.diff(x) > 0).all() or not np.isfinite(x).all():
        return "the first column must increase"
    if not (np.isfinite(p) & (p >= 0)).all() or not p.any():
        return "the second column must hold finite densities >= 0"
    if x[0] < low or x[-1] > high or (whole and (x[0] > low or x[-1] < high)):
        rule = f"from {low:g} to {high:g}" if whole else f"inside [{low:g}, {high:g}]"
        return f"the first column must run {rule}, got {x[0]:g} to {x[-1]:g}"
    return ""


def _unnormalised(path: Path, total: float, mass: float) -> tuple[str, ...]:
    due = "1" if mass == 1 else f"{mass:g}, which the atoms leave"
    return (f"the densities in {path} integrate to {total:.6g} where {due} is due: divide them by {total / mass:.6g}",)


def _linear(x: np.ndarray, p: np.ndarray, at: np.ndarray) -> Reference:
    value = np.interp(at, x, p, left=0.0, right=0.0)
    return Reference(value, 1e-14 * value)


def _map(path: Path, values: np.ndarray, mass: float) -> Table:
    h, w = values.shape
    if not (np.isfinite(values) & (values >= 0)).all():
        raise InvalidInputError(f"{path}: densities must be finite and >= 0", str(path))

    def density(x: np.ndarray) -> Reference:
        column, row = (np.clip((x[:, i] * n).astype(np.intp), 0, n - 1) for i, n in ((0, w), (1, h)))
        return Reference(values[row, column])

    total = float(values.mean())
    return Table(density, notes=() if abs(total - mass) <= _SAME * mass else _unnormalised(path, total, mass))


def _tamed(
    path: Path, x: np.ndarray, p: np.ndarray, mass: float, exact: bool
) -> tuple[float, int | None, tuple[str, ...]]:
    """Return what the table is to be multiplied by, how many samples it can judge, and what is to be said of it."""
    total = float(np.sum(0.5 * np.diff(x) * (p[1:] + p[:-1])))
    if exact:
        return 1.0, None, () if abs(total - mass) <= _SAME * mass else _unnormalised(path, total, mass)
    coarse = np.interp(x, x[::2], p[::2]) if len(x) > 4 else np.zeros_like(p)
    off = np.abs(p - coarse) / 3
    floor = np.maximum(p, 1e-3 * p.max())
    noncentrality = float(np.trapezoid(off**2 / floor, x))
    doubt = float(np.trapezoid(off, x))
    if abs(total - mass) > 3 * doubt + 1e-9:  # no interpolation explains that: let it be judged
        return 1.0, None, _unnormalised(path, total, mass)
    if noncentrality == 0:
        return mass / total, None, ()
    most = int(min(_UNSEEN / noncentrality, 1e12))
    if most < _LEAST:
        raise InvalidInputError(
            f"{path} is too coarse: straight lines between its {len(x)} points miss the density by so much that"
            f" {most} samples would see it; give more points, or exact = true if it is made of straight lines",
            str(path),
        )
    return mass / total, most, (f"the table of {len(x)} points is good enough to judge {most} samples",)
