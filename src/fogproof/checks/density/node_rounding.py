"""What rounding of quadrature's own points may add to an integral.

A node is a coordinate; the density sees the point it leads to, whose numbers are rounded. Where a density varies over a width w,
an error of ulp / w follows, which no halving of boxes removes: for a cone about z with half an angle of 1e-5, half an ulp of z = 1
is a millionth. So where boxes are narrow the density is asked again at points moved by one rounding.
"""

from __future__ import annotations

import numpy as np

from fogproof.checks.density.charts import Chart
from fogproof.checks.density.quadrature import KRONROD, NODES, Leaves
from fogproof.checks.subject import UNIT_ROUNDOFF, Subject, in_domain
from fogproof.domains.law import vector_columns

_ROUNDOFF = UNIT_ROUNDOFF["float64"] / 2  # `nudged` moves by four of it: an ulp of a number just below 1
_NARROW = 2.0**-18  # extent of a box, of the size of its points: a wider one's polynomial changes by less than 1e-8
_BLOCK = 1 << 17  # points at once


def node_rounding(subject: Subject, chart: Chart, leaves: Leaves) -> float:
    """Return a bound on what rounding of the points of the leaves' nodes adds to the integral of the density."""
    narrow = np.flatnonzero(_narrow(chart, leaves))
    each = max(_BLOCK // 15 ** len(chart.axes), 1)
    return sum(_moved(subject, chart, leaves.chosen(narrow[i : i + each])) for i in range(0, len(narrow), each))


def _nodes(leaves: Leaves, places: np.ndarray) -> np.ndarray:
    """Return (m, q^k, k) the coordinates at q places in [-1, 1] along each axis of m boxes."""
    k = leaves.low.shape[1]
    at = np.stack(np.meshgrid(*[places] * k, indexing="ij"), axis=-1).reshape(-1, k)
    middle, half = 0.5 * (leaves.low + leaves.high), 0.5 * (leaves.high - leaves.low)
    return np.asarray(middle[:, None] + half[:, None] * at)


def _narrow(chart: Chart, leaves: Leaves) -> np.ndarray:
    """Return (m,) which boxes reach less far along an axis of space than points there are large, by a factor of `_NARROW`."""
    c = _nodes(leaves, NODES[[0, 7, 14]])
    x = chart.to_point(c.reshape(-1, c.shape[-1]))
    size = np.abs(x) if x.ndim == 1 else np.maximum(np.abs(x), np.minimum(np.abs(x).max(axis=1, keepdims=True), 1.0))
    x, size = (part.reshape(*c.shape[:2], -1) for part in (x, size))
    return np.asarray((np.ptp(x, axis=1) < _NARROW * size.max(axis=1)).any(axis=1))


def _moved(subject: Subject, chart: Chart, leaves: Leaves) -> float:
    """Return by how much the integral changes at most: node by node the more of both ways, summed over the axes of space."""
    k = leaves.low.shape[1]
    c = _nodes(leaves, NODES).reshape(-1, k)
    x, jacobian = chart.to_point(c), chart.jacobian(c)
    p = subject.density(x)
    slack = _ROUNDOFF if vector_columns(subject.domain) else 0.0  # a length of 1 may be off; no node lies beyond an end
    change = []
    for y in subject.nudged(x, _ROUNDOFF):
        inside = in_domain(subject.domain, y, slack)
        with np.errstate(invalid="ignore"):
            change.append(np.where(inside, np.abs(subject.density(y) - p) * jacobian, 0.0))
    most = np.sum([np.maximum(a, b) for a, b in zip(change[::2], change[1::2], strict=True)], axis=0)
    values = np.where(np.isfinite(most), most, 0.0).reshape(len(leaves.low), *[15] * k)
    for _ in range(k):
        values = values @ KRONROD
    return float(values @ np.prod(0.5 * (leaves.high - leaves.low), axis=1))
