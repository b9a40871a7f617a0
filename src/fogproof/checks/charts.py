"""Charts: each domain as a box of one or two coordinates, in which bins are boxes and integrals are iterated.

The measure of the domain is `jacobian` times the box's own. Sphere and hemisphere use (mu, phi) about a pole, whose measure is the
solid angle itself; the disk uses (r^2, phi). Unbounded lines are mapped to (0, 1) by a rational map scaled by a pilot sample, so
that the density's bulk lies in the middle whatever its unit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fogproof.domains import (
    Discrete,
    Domain,
    HalfLine,
    Interval,
    RealLine,
    UnitDisk,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
)
from fogproof.errors import InvalidValueError


@dataclass(frozen=True)
class Chart:
    """Coordinates of a domain: `to_point` (m, k) -> points, `from_point` its inverse, `jacobian` (m, k) -> (m,)."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    labels: tuple[str, ...]
    to_point: Callable[[np.ndarray], np.ndarray]
    from_point: Callable[[np.ndarray], np.ndarray]
    jacobian: Callable[[np.ndarray], np.ndarray]


def chart_of(domain: Domain, pilot: np.ndarray, axis: tuple[float, float, float] | None) -> Chart:
    """Return the chart of a continuous domain; `pilot` points set its scale, `axis` the pole of the sphere."""
    match domain:
        case UnitSphere():
            return _sphere(-1.0, np.asarray(axis or (0.0, 0.0, 1.0)))
        case UnitHemisphere():
            return _sphere(0.0, np.array([0.0, 0.0, 1.0]))
        case UnitDisk():
            return _disk()
        case UnitSquare():
            return Chart((0.0, 0.0), (1.0, 1.0), ("x", "y"), _same, _same, _ones)
        case Interval(a, b):
            return Chart((a,), (b,), ("x",), _line_point, _line_coordinate, _ones)
        case HalfLine(a):
            return _half_line(a, float(np.median(pilot - a)) if len(pilot) else 1.0)
        case RealLine():
            center, spread = _center_and_spread(pilot)
            return _real_line(center, spread)
        case Discrete():
            raise InvalidValueError("domain", "must be continuous to have a chart", domain)


def frame(axis: np.ndarray) -> np.ndarray:
    """Return rows (t1, t2, axis) of an orthonormal frame: Gram-Schmidt on the coordinate axis farthest from `axis`."""
    axis = axis / np.sqrt(axis @ axis)
    other = np.eye(3)[np.argmin(np.abs(axis))]
    t1 = other - (other @ axis) * axis
    t1 /= np.sqrt(t1 @ t1)
    return np.stack([t1, np.cross(axis, t1), axis])


def _sphere(lowest: float, axis: np.ndarray) -> Chart:
    rows = frame(axis)

    def to_point(c: np.ndarray) -> np.ndarray:
        mu, phi = c[:, 0], c[:, 1]
        sine = np.sqrt((1 - mu) * (1 + mu))
        local = np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)
        return local if np.array_equal(rows, np.eye(3)) else local @ rows

    def from_point(x: np.ndarray) -> np.ndarray:
        local = x @ rows.T
        return np.stack([np.clip(local[:, 2], lowest, 1), np.arctan2(local[:, 1], local[:, 0])], axis=-1)

    return Chart((lowest, -np.pi), (1.0, np.pi), ("mu", "phi"), to_point, from_point, _ones)


def _disk() -> Chart:
    def to_point(c: np.ndarray) -> np.ndarray:
        r = np.sqrt(c[:, 0])
        return np.stack([r * np.cos(c[:, 1]), r * np.sin(c[:, 1])], axis=-1)

    def from_point(x: np.ndarray) -> np.ndarray:
        return np.stack([np.clip(np.sum(x * x, axis=-1), 0, 1), np.arctan2(x[:, 1], x[:, 0])], axis=-1)

    return Chart((0.0, -np.pi), (1.0, np.pi), ("r^2", "phi"), to_point, from_point, lambda c: np.full(len(c), 0.5))


def _half_line(a: float, scale: float) -> Chart:
    m = scale if 0 < scale < np.inf else 1.0

    def to_point(c: np.ndarray) -> np.ndarray:
        return a + m * c[:, 0] / (1 - c[:, 0])

    def from_point(x: np.ndarray) -> np.ndarray:
        t = np.maximum(x - a, 0)
        return (t / (t + m))[:, None]

    return Chart((0.0,), (1.0,), ("x",), to_point, from_point, lambda c: m / (1 - c[:, 0]) ** 2)


def _real_line(center: float, spread: float) -> Chart:
    def to_point(c: np.ndarray) -> np.ndarray:
        v = 2 * c[:, 0] - 1
        return center + spread * v / np.sqrt((1 - v) * (1 + v))

    def from_point(x: np.ndarray) -> np.ndarray:
        z = (x - center) / spread
        return (0.5 + 0.5 * z / np.hypot(1, z))[:, None]

    def jacobian(c: np.ndarray) -> np.ndarray:
        v = 2 * c[:, 0] - 1
        return 2 * spread * ((1 - v) * (1 + v)) ** -1.5

    return Chart((0.0,), (1.0,), ("x",), to_point, from_point, jacobian)


def _center_and_spread(pilot: np.ndarray) -> tuple[float, float]:
    low, center, high = np.quantile(pilot, [0.25, 0.5, 0.75]) if len(pilot) else (-1.0, 0.0, 1.0)
    return float(center), float(high - low) if high > low else 1.0


def _same(c: np.ndarray) -> np.ndarray:
    return c


def _ones(c: np.ndarray) -> np.ndarray:
    return np.ones(len(c))


def _line_point(c: np.ndarray) -> np.ndarray:
    return c[:, 0]


def _line_coordinate(x: np.ndarray) -> np.ndarray:
    return x[:, None]
