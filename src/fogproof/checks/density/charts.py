"""Charts: each domain as a box of one or two coordinates, in which integrals are iterated and cells are boxes.

The measure of the domain is `jacobian` times the box's own. Sphere and hemisphere use (theta, phi) about a pole, in which every
smooth density is smooth; the disk uses (r, phi). Unbounded lines are mapped to (0, 1) by a map scaled by a pilot sample: its bulk
lies in the middle whatever its unit, and heavy tails are not crowded at an end.

A coordinate has three forms: the one integrated over; the one samples are counted in, a cheap increasing function of it (for theta
the versine 1 - cos theta, computed without loss near either pole, whatever the rounding of the vector's length); and the one shown
to people (for theta the forward cosine mu).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from fogproof.domains import (
    Domain,
    HalfLine,
    Interval,
    RealLine,
    Rectangle,
    UnitDisk,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
)
from fogproof.domains.line import Tail, centre

Map = Callable[[np.ndarray], np.ndarray]


def _same(c: np.ndarray) -> np.ndarray:
    return c


@dataclass(frozen=True)
class Axis:
    """One coordinate of a chart, from `low` to `high`.

    label      what people call the coordinate they are shown
    ends       whether its ends are ends of the domain: those of an angle that runs round are not
    counted    (m,) coordinate -> the increasing function of it that samples are counted in
    uncounted  its inverse
    shown      (m,) coordinate -> what people are shown
    hidden     its inverse
    breaks     (b,) where the density may jump
    """

    label: str
    low: float
    high: float
    ends: bool = True
    counted: Map = _same
    uncounted: Map = _same
    shown: Map = _same
    hidden: Map = _same
    breaks: np.ndarray = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True)
class Chart:
    """Coordinates of a domain.

    to_point  (m, k) coordinates -> points
    count     points -> the counted coordinates, one (m,) array an axis
    jacobian  (m, k) -> (m,) the measure of the domain over that of the box
    """

    axes: tuple[Axis, ...]
    to_point: Map
    count: Callable[[np.ndarray], tuple[np.ndarray, ...]]
    jacobian: Map

    @property
    def pieces(self) -> int:
        """How many boxes the breaks make."""
        return int(np.prod([len(axis.breaks) + 1 for axis in self.axes]))

    def cut(self, breaks: Mapping[str, np.ndarray]) -> Chart:
        """Return the chart with further places at which boxes begin, given as people are shown them."""
        axes = []
        for axis in self.axes:
            at = axis.hidden(breaks.get(axis.label, np.empty(0)))
            axes.append(replace(axis, breaks=np.unique(at[(at > axis.low) & (at < axis.high)])))
        return replace(self, axes=tuple(axes))

    def coordinates(self, x: np.ndarray) -> np.ndarray:
        """Return the (m, k) coordinates of points: exact to rounding, slower than `count`."""
        columns = zip(self.axes, self.count(x), strict=True)
        return np.stack([axis.uncounted(counted) for axis, counted in columns], axis=-1)


def chart_of(domain: Domain, pilot: np.ndarray, axis: tuple[float, float, float] | None) -> Chart | None:
    """Return the chart of a domain, None where there is none; `pilot` points set its scale, `axis` the pole of the sphere."""
    match domain:
        case UnitSphere():
            return _sphere(np.pi, np.asarray(axis or (0.0, 0.0, 1.0)))
        case UnitHemisphere():
            return _sphere(np.pi / 2, np.array([0.0, 0.0, 1.0]))
        case UnitDisk():
            return _disk()
        case UnitSquare():
            return unit_square(("x", "y"))
        case Rectangle((x0, y0), (x1, y1)):
            sides = (Axis("x", x0, x1), Axis("y", y0, y1))
            return Chart(sides, _same, lambda x: (x[:, 0], x[:, 1]), _ones)
        case Interval(a, b):
            return Chart((Axis("x", a, b),), lambda c: c[:, 0], lambda x: (x,), _ones)
        case HalfLine(a):
            return _half_line(a, Tail.of(pilot - a))
        case RealLine():
            return _real_line(pilot)
    return None


def unit_square(labels: tuple[str, str]) -> Chart:
    """Return the chart of [0, 1]^2: a domain itself, and where a Rosenblatt map leads."""
    axes = (Axis(labels[0], 0.0, 1.0), Axis(labels[1], 0.0, 1.0))
    return Chart(axes, _same, lambda x: (x[:, 0], x[:, 1]), _ones)


def frame(axis: np.ndarray) -> np.ndarray:
    """Return rows (t1, t2, axis) of an orthonormal frame: Gram-Schmidt on the coordinate axis farthest from `axis`."""
    axis = axis / np.sqrt(axis @ axis)
    other = np.eye(3)[np.argmin(np.abs(axis))]
    t1 = other - (other @ axis) * axis
    t1 /= np.sqrt(t1 @ t1)
    return np.stack([t1, np.cross(axis, t1), axis])


def _versine(theta: np.ndarray) -> np.ndarray:
    return 2 * np.sin(0.5 * theta) ** 2


def _angle(versine: np.ndarray) -> np.ndarray:
    return 2 * np.arcsin(np.sqrt(np.clip(0.5 * versine, 0, 1)))


def _azimuth() -> Axis:
    """Return the angle that runs round; people may count it from 0 or from -pi."""
    return Axis("phi", -np.pi, np.pi, False, hidden=lambda phi: np.arctan2(np.sin(phi), np.cos(phi)))


def _sphere(highest: float, axis: np.ndarray) -> Chart:
    rows = frame(axis)
    turned = not np.array_equal(rows, np.eye(3))

    def to_point(c: np.ndarray) -> np.ndarray:
        sine = np.sin(c[:, 0])
        local = np.stack([sine * np.cos(c[:, 1]), sine * np.sin(c[:, 1]), np.cos(c[:, 0])], axis=-1)
        return local @ rows if turned else local

    def count(points: np.ndarray) -> tuple[np.ndarray, ...]:
        x, y, z = np.ascontiguousarray(points.T)
        if turned:  # column by column: threads of a matrix product would cost more than they save
            x, y, z = (row[0] * x + row[1] * y + row[2] * z for row in rows)
        versine = (x * x + y * y) / (1 + np.abs(z))
        return np.where(z < 0, 2 - versine, versine), np.arctan2(y, x)

    mu = Axis("mu", 0.0, highest, True, _versine, _angle, np.cos, lambda mu: np.arccos(np.clip(mu, -1, 1)))
    axes = (mu, _azimuth())
    return Chart(axes, to_point, count, lambda c: np.sin(c[:, 0]))


def _disk() -> Chart:
    def to_point(c: np.ndarray) -> np.ndarray:
        return np.stack([c[:, 0] * np.cos(c[:, 1]), c[:, 0] * np.sin(c[:, 1])], axis=-1)

    def count(points: np.ndarray) -> tuple[np.ndarray, ...]:
        x, y = np.ascontiguousarray(points.T)
        return x * x + y * y, np.arctan2(y, x)

    axes = (Axis("r", 0.0, 1.0, True, np.square, np.sqrt), _azimuth())
    return Chart(axes, to_point, count, lambda c: c[:, 0])


def _half_line(a: float, tail: Tail) -> Chart:
    def to_point(c: np.ndarray) -> np.ndarray:
        return a + tail.quantile(c[:, 0])

    def count(x: np.ndarray) -> tuple[np.ndarray, ...]:
        return (tail.cdf(np.maximum(x - a, 0)),)

    shown = Axis("x", 0.0, 1.0, shown=lambda t: to_point(t[:, None]), hidden=lambda x: count(x)[0])
    return Chart((shown,), to_point, count, lambda c: 1 / tail.density(tail.quantile(c[:, 0])))


def _heavy_line(pilot: np.ndarray) -> Chart:
    law = RealLine().law(pilot)
    hidden = lambda x: law.coordinates(x, x)[:, 0]  # noqa: E731
    shown = Axis("x", 0.0, 1.0, shown=lambda t: law.place(t[:, None]), hidden=hidden)
    return Chart((shown,), law.place, lambda x: (law.coordinates(x, x)[:, 0],), lambda c: 1 / law.density(law.place(c)))


def _real_line(pilot: np.ndarray) -> Chart:
    center, spread = _center_and_spread(pilot)
    if Tail.of(np.abs(pilot - center)).b < 1:
        return _heavy_line(pilot)

    def to_point(c: np.ndarray) -> np.ndarray:
        t = c[:, 0]
        return center + spread * (t - 0.5) / np.sqrt(t * (1 - t))

    def count(x: np.ndarray) -> tuple[np.ndarray, ...]:
        z = np.abs(x - center) / spread
        with np.errstate(over="ignore"):
            beyond = 0.5 / (1 + z * z + z * np.sqrt(1 + z * z))  # (1 - z / sqrt(1 + z^2)) / 2 without loss
        return (np.where(x < center, beyond, 1 - beyond),)

    def jacobian(c: np.ndarray) -> np.ndarray:
        return 0.25 * spread * (c[:, 0] * (1 - c[:, 0])) ** -1.5

    shown = Axis("x", 0.0, 1.0, shown=lambda t: to_point(t[:, None]), hidden=lambda x: count(x)[0])
    return Chart((shown,), to_point, count, jacobian)


def _center_and_spread(pilot: np.ndarray) -> tuple[float, float]:
    low, high = np.quantile(pilot, [0.25, 0.75]) if len(pilot) else (-1.0, 1.0)
    return centre(pilot), float(high - low) if high > low else 1.0


def _ones(c: np.ndarray) -> np.ndarray:
    return np.ones(len(c))
