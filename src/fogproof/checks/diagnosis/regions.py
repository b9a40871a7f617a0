"""What goes wrong with points of an area or a volume: axes swapped, turned round or shifted, powers of the radius."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import permutations

import numpy as np

from fogproof.checks.diagnosis.grids import SHIFTS
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, known_number, of_points

_ENDLESS = 1e300  # between the ends of an unbounded axis as its known law has them
_MOST_SWAPPED = 4  # dimensions


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to points of k coordinates, the simplest first."""
    domain = setting.domain
    k = domain.shape[0]
    yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: lambda x: np.ones(len(x)))
    for order in permutations(range(k)) if k <= _MOST_SWAPPED else ():
        if order != tuple(range(k)):
            words = f"these samples fit the pdf with its axes taken in the order {', '.join(map(str, order))}"
            yield Hypothesis("swapped axes", words, of_points(partial(np.take, indices=order, axis=1)))
    ends = setting.law.place(np.stack([np.zeros(len(setting.law.axes)), np.ones(len(setting.law.axes))]))
    with np.errstate(over="ignore"):
        volume = np.prod(ends[1] - ends[0])
    if np.isclose(volume, domain.measure):  # a box: it fills the space between its corners
        for axis in range(k):
            yield from _along(axis, float(ends[0, axis]), float(ends[1, axis]))
    else:
        yield Hypothesis("sign convention", "these samples fit the pdf of -x", lambda s, _: lambda x: s.p(-x))
    yield Hypothesis(
        "missing Jacobian",
        "these samples fit the pdf times a power of the radius, {value}",
        lambda s, a: lambda x: s.p(x) * np.maximum(np.sum(x * x, axis=1), 1e-24) ** (0.5 * a),
        (-2.0, -1.5, -1.0, -0.5, 0.5, 1.0, 2.0),
        known_number(
            {
                -1.0: "a square root of r is missing, or a factor r",
                1.0: "a factor r too many",
                -2.0: "a factor r^2 is missing",
            }
        ),
        otherwise="wrong power",
    )


def _along(axis: int, low: float, high: float) -> Iterator[Hypothesis]:
    def replaced(x: np.ndarray, column: np.ndarray) -> np.ndarray:
        y = x.copy()
        y[:, axis] = column
        return y

    if not high - low < _ENDLESS:
        return
    yield Hypothesis(
        "sign convention",
        f"these samples fit the pdf with axis {axis} turned round",
        of_points(lambda x: replaced(x, low + high - x[:, axis])),
    )
    yield Hypothesis(
        "shifted",
        f"these samples fit the pdf shifted round by {{value}} along axis {axis}",
        lambda s, d: lambda x: s.p(replaced(x, low + (x[:, axis] - d - low) % (high - low))),
        tuple((high - low) * f for f in SHIFTS),
    )
    yield Hypothesis(
        "missing Jacobian",
        f"these samples fit the pdf times a power of coordinate {axis}, {{value}}",
        lambda s, a: lambda x: s.p(x) * np.maximum(np.abs(x[:, axis]), 1e-12) ** a,
        (-1.5, -1.0, -0.5, 0.5, 1.0, 1.5),
        otherwise="wrong power",
    )
