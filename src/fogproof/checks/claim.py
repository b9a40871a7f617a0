"""A claimed density, integrated over the chart of its domain, and whether the integral is known.

An error estimate that compares two sets of nodes is no bound where the density jumps: a jump outside both gives 0 +- 0. So the
density is integrated twice, over boxes that are differently placed, and looked at on evenly spread points and at the pilot. It is
known where both integrals agree and no look finds a density that the polynomials do not have. Only then quadrature judges.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from fogproof.checks.density.charts import Chart
from fogproof.checks.density.features import Ranges, ranges_of_line, ranges_of_plane
from fogproof.checks.density.grid import Grid
from fogproof.checks.density.grid_of_density import grid_of
from fogproof.checks.density.lattice import lattice
from fogproof.checks.density.model import Density, Effort, integrated, second_view, unknown
from fogproof.checks.density.node_rounding import node_rounding
from fogproof.checks.density.quadrature import Leaves
from fogproof.checks.density.rounding import Rounded, blurred
from fogproof.checks.normalisation import FLOOR, effort, pdf_noise
from fogproof.checks.subject import Subject
from fogproof.domains import Law

_LOOKS = {1: 1 << 17, 2: 400_000}  # evenly spread points on so many axes
_HIGH = 40.0  # times the known law's density: lower ones hold no mass that one of the points could stand for
_COARSE = 50.0  # times the error that is never rejected: an integral known no better is not known
_MOST = 2048  # points of one kind that are compared with the polynomials
_MOVED = 1e-3  # by rounding of its points: an integral known no better says nothing
_PLAINLY = 2.0  # an integral above it is not 1
_CONFIRMED = 0.1  # relative: as near as evenly spread points come to an integral that is one
_LAST = 2.0**-50  # of an end: a few floating-point numbers from it
_STRONGEST = 0.01  # 1 less the power of a pole that has a finite integral
_STRANGE = 0.01  # share of the pilot that may not be as the polynomials have it


@dataclass(frozen=True)
class Claim:
    """The integrated density of a continuous domain.

    rounding  of the pdf and of the points it is asked at: what it may add to the integral
    doubt  why the integral is not known, "" if it is
    found  whether looking closer has changed it
    """

    chart: Chart
    density: Density
    work: Effort
    rounding: float
    leaves: Leaves
    grid: Grid
    ranges: Ranges
    doubt: str
    found: bool = False


def claimed(subject: Subject, chart: Chart, points: np.ndarray, samples: int, rounded: Rounded) -> Claim:
    """Integrate the subject's density over its chart; `points` are a pilot sample of the continuous part."""
    work = effort(subject, points)

    def density(c: np.ndarray) -> np.ndarray:
        p = subject.density(chart.to_point(c))
        return np.where(p == 0, 0.0, p * chart.jacobian(c))

    pilot = chart.coordinates(points) if len(points) else np.empty((0, len(chart.axes)))
    leaves = integrated(chart, density, pilot, work)
    grid = blurred(grid_of(chart, leaves, samples), chart.count, rounded)
    rounding = pdf_noise(subject, points) if subject.precision == "float32" else 0.0
    ranges = _ranges(chart, leaves, grid, density)
    floor = (FLOOR[subject.precision] + rounding) * _height(subject, leaves.total, points)
    doubt = _within_rounding(subject, chart, floor)
    doubt = doubt or _doubt(leaves, floor, lambda: second_view(chart, density, pilot, work))
    doubt = doubt or _strange(subject, chart, density, leaves, work, points)
    moved = 0.0 if doubt else node_rounding(subject, chart, leaves)
    if moved > _MOVED:
        doubt = f"rounding of the points that quadrature asks may move the integral by {moved:.1g}"
    return Claim(chart, density, work, rounding + moved, leaves, grid, ranges, doubt)


def _ranges(chart: Chart, leaves: Leaves, grid: Grid, density: Density) -> Ranges:
    if grid.plane is not None:
        return ranges_of_plane(chart, leaves, grid.marginals, grid.plane)
    line: Callable[[np.ndarray], np.ndarray] = lambda t: density(np.ascontiguousarray(t)[:, None])  # noqa: E731
    return ranges_of_line(chart.axes[0], grid.marginals[0], chart.jacobian, line)


def _height(subject: Subject, total: float, points: np.ndarray) -> float:
    """Return the integral, where it is plainly not 1 and evenly spread points have it too: errors are relative to it. Else 1.

    A pole whose one node at the end is 1e250 high is no such integral.
    """
    if not (np.isfinite(total) and abs(total) > _PLAINLY):
        return 1.0
    x, base = _spread(subject, points)
    return abs(total) if abs(np.mean(subject.density(x) / base) / total - 1) < _CONFIRMED else 1.0


def _doubt(leaves: Leaves, floor: float, again: Callable[[], Leaves]) -> str:
    """Return why two integrals of one density do not settle it to `floor`, "" if they do."""
    words = f"quadrature gives {leaves.total:.6g} +- {leaves.total_error:.1g}"
    if not leaves.total_error <= _COARSE * floor:
        return words
    other = again()
    if not abs(leaves.total - other.total) <= floor + leaves.total_error + other.total_error:
        return f"{words} and, over other boxes, {other.total:.6g} +- {other.total_error:.1g}"
    return ""


def _within_rounding(subject: Subject, chart: Chart, floor: float) -> str:
    """Return at which end of a line the pdf diverges so that the last few floating-point numbers hold more than `floor`.

    There the integral over real numbers and that over floating-point ones differ. A pole at 0 has numbers as fine as it needs.
    """
    if len(chart.axes) > 1 or not chart.axes[0].ends:
        return ""
    for end, inwards in ((chart.axes[0].low, 1.0), (chart.axes[0].high, -1.0)):
        x = float(chart.to_point(np.array([[end]]))[0])
        step = _LAST * abs(x)
        if not (np.isfinite(x) and step > 0):
            continue
        near, far = subject.density(x + inwards * step * np.array([1.0, 2.0]))
        power = float(np.log2(near / far)) if 0 < far < near < np.inf else 0.0
        mass = near * step / max(1 - power, _STRONGEST)  # of a power of the distance, from 0 to it
        if power > 0 and mass > floor:
            return f"the pdf diverges at x = {x:.6g}, and numbers there are so coarse that the last few hold {mass:.2g} of it"
    return ""


def _strange(subject: Subject, chart: Chart, density: Density, leaves: Leaves, work: Effort, points: np.ndarray) -> str:
    """Return where the density is not as its polynomials have it, "" if nowhere that matters."""
    if len(points):
        odd = np.count_nonzero(unknown(density, leaves, chart.coordinates(points[:_MOST]), work))
        if odd > _STRANGE * len(points[:_MOST]):
            return f"quadrature does not know the pdf at {odd} of {len(points[:_MOST])} sampled points"
    x, base = _spread(subject, points)
    p = subject.density(x)
    for telling in (p > _HIGH * base, p == 0):
        at = np.flatnonzero(telling)
        at = at[:: max(len(at) // _MOST, 1)]
        if len(at) and (odd := np.count_nonzero(unknown(density, leaves, chart.coordinates(x[at]), work))):
            return f"quadrature does not know the pdf at {odd} of {len(x)} evenly spread points"
    return ""


def _spread(subject: Subject, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return evenly spread points of the domain (n, ...) and the known law's density there, those of bounded domains kept."""
    domain = subject.domain
    hashable: Any = domain
    return _spread_on(hashable) if np.isfinite(domain.measure) else _spread_by(domain.law(points))


@lru_cache(maxsize=4)
def _spread_on(domain: Any) -> tuple[np.ndarray, np.ndarray]:
    return _spread_by(domain.law(np.empty((0, *domain.shape))))


def _spread_by(law: Law) -> tuple[np.ndarray, np.ndarray]:
    k = len(law.axes)
    x = law.place(lattice(_LOOKS[k], k, np.full(k, 0.5)))
    return x, law.density(x)


def blind(axes: int) -> float:
    """Return the share of the domain below which something compact may lie between all points that were looked at."""
    return 4.0 / _LOOKS[axes]
