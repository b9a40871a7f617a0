"""What goes wrong with points of an area or a volume: axes swapped, turned round or shifted, powers of the radius."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import permutations

import numpy as np

from fogproof.checks.diagnosis import correlations, folds
from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.grids import SHIFTS
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, known_number, of_points
from fogproof.checks.diagnosis.lines import SCALES, STRETCHED
from fogproof.domains import Product

_HALF_TURN = 0.01  # radians that chance leaves of it
_EVEN = 1e-9  # relative difference of densities that are one
_ANYWHERE = 6.0  # logarithm of how much likelier a lost sign empties a half plane that begins at no axis
_ENDLESS = 1e300  # between the ends of an unbounded axis as its known law has them
_MOST_SWAPPED = 4  # dimensions


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to points of k coordinates, the simplest first."""
    domain = setting.domain
    k = domain.shape[0]
    center = np.asarray(getattr(domain, "center", np.zeros(k)))
    box = _corners(setting)
    for axis, low in enumerate([] if box is None else box[0].tolist()):
        words = f"these samples fit the pdf over coordinate {axis}: a square root of it is missing, or a factor"
        yield Hypothesis("missing Jacobian", words, _over(axis, low))
    yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: lambda x: np.ones(len(x)))
    for order in permutations(range(k)) if k <= _MOST_SWAPPED else ():
        if order != tuple(range(k)):
            words = f"these samples fit the pdf with its axes taken in the order {', '.join(map(str, order))}"
            yield Hypothesis("swapped axes", words, of_points(partial(np.take, indices=order, axis=1)))
    if box is not None:
        for axis in range(k):
            yield from _along(axis, float(box[0, axis]), float(box[1, axis]))
    else:
        yield Hypothesis("sign convention", "these samples fit the pdf of -x", lambda s, _: lambda x: s.p(-x))
    names = [f"coordinate {axis}" for axis in range(k)]
    yield from folds.hypotheses(setting, names, azimuth=(0, 1) if box is None else ())
    if k == 2 and box is None:
        yield from _folded(setting, center)
    yield Hypothesis(
        "missing Jacobian",
        "these samples fit the pdf times a power of the radius, {value}",
        lambda s, a: lambda x: s.p(x) * np.maximum(np.sum((x - center) ** 2, axis=1), 1e-24) ** (0.5 * a),
        (-2.0, -1.5, -1.0, -0.5, 0.5, 1.0, 2.0),
        known_number(
            {
                -1.0: "a square root of r is missing, or a factor r",
                1.0: "a factor r too many",
                -2.0: "a factor r^2 is missing",
            }
        ),
        otherwise="wrong power",
        null=0.0,
    )
    if k == 3 and box is None:
        words = "a sine is missing: these samples are uniform in theta where the pdf means volume"
        yield Hypothesis("missing Jacobian", words, lambda s, _: lambda x: s.p(x) / _sine(x - center))
    if not np.isfinite(domain.measure):
        yield from correlations.hypotheses(setting)
        yield Hypothesis(
            "wrong scale",
            "these samples fit the pdf stretched by {value}" + " in all columns" * isinstance(domain, Product),
            lambda s, a: lambda x: s.p(x / a),
            SCALES,
            STRETCHED,
            null=1.0,
        )


def _folded(setting: Setting, center: np.ndarray) -> Iterator[Hypothesis]:
    """Yield that half of the plane is empty and its points are at their mirror images, as of a radius without its sign.

    A claim that is its own mirror image has the same points where an azimuth takes half a turn. That one begins at an axis.
    """
    phi = np.sort(np.arctan2(*(setting.contrast.x - center).T[::-1]))
    gaps = np.diff(phi, append=phi[0] + 2 * np.pi)
    at = int(np.argmax(gaps))
    if abs(gaps[at] - np.pi) > _HALF_TURN:
        return
    even = np.allclose(setting.values, setting.p(2 * center - setting.contrast.points), rtol=_EVEN)
    if even and abs(np.sin(phi[at])) < _HALF_TURN:
        return
    middle = phi[at] + 0.5 * gaps[at] + np.pi
    towards = np.array([np.cos(middle), np.sin(middle)])
    words = "half of the plane is empty, and its points lie at their mirror images through the centre: the sign of r is lost"
    reach = -np.sin(0.5 * (np.pi - gaps[at]))  # of samples beyond the half plane

    def density(x: np.ndarray, p: Density) -> np.ndarray:
        y = x - center
        kept = y @ towards >= reach * np.sqrt(np.sum(y * y, axis=1))
        return np.where(kept, p(x) + p(center - y), 0.0)

    prior = _ANYWHERE if even else 0.0
    yield Hypothesis("lost sign", words, lambda s, _: lambda x: density(x, s.p), prior=prior)


def _corners(setting: Setting) -> np.ndarray | None:
    """Return the lowest and the highest corner (2, k) of a box, None of another domain: a box fills the space between."""
    ends = setting.law.place(np.stack([np.zeros(len(setting.law.axes)), np.ones(len(setting.law.axes))]))
    with np.errstate(over="ignore", invalid="ignore"):
        volume = np.prod(ends[1] - ends[0])
    return ends if np.isclose(volume, setting.domain.measure) else None


def _over(axis: int, low: float) -> Callable[[Setting, float], Density]:
    return lambda s, _: lambda x: s.p(x) / np.maximum(np.abs(x[:, axis] - low), 1e-12)


def _sine(x: np.ndarray) -> np.ndarray:
    """Return the sine of the angle to the z axis."""
    length = np.sqrt(np.maximum(np.sum(x * x, axis=1), 1e-24))
    return np.maximum(np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2) / length, 1e-9)


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
        null=0.0,
    )
    yield Hypothesis(
        "missing Jacobian",
        f"these samples fit the pdf times a power of coordinate {axis}, {{value}}",
        lambda s, a: lambda x: s.p(x) * np.maximum(np.abs(x[:, axis]), 1e-12) ** a,
        (-1.5, -1.0, -0.5, 0.5, 1.0, 1.5),
        otherwise="wrong power",
        null=0.0,
    )
