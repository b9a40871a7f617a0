"""Frames about a normal: turned, or built by a formula with a slip, so that its axes are not orthogonal.

The frame of Duff et al. (2017) takes s, the sign of z, in five places; where z > 0 each of them is without effect.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_LEAN = 0.03  # mean length of directions that have a direction
_LEAST = 1e-6  # determinant of three axes that span space
_POINTS, _STEPS = 256, 20  # that tell an axis of symmetry, and steps towards it
_MOST, _SYMMETRIC = 0.9, 1e-8  # of the points differ by so little of the variance of a logarithm
_AZIMUTHS, _HALVED = 8, 50  # in which an edge is looked for, and how often
_CIRCLE = 1e-6  # distance of an edge from its plane, of its own size
_SLIPS = {
    "in 1/(s + z)": (0,),
    "in the first axis": (1, 2, 3),
    "in the first axis' x": (1,),
    "in the first axis' y": (2,),
    "in the first axis' z": (3,),
    "in the second axis": (4,),
}


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to the frame about the mean direction of the claim, if it has one."""
    yield from _turned(setting)
    yield from _skewed(setting)


def _skewed(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that directions of a frame that is not orthogonal are normalised: such a map has a determinant."""
    mean = setting.claimed_mean()
    length = float(np.linalg.norm(mean))
    if length < _LEAN or mean[2] >= 0:
        return
    normal = mean / length
    right = duff(normal)
    for where, places in _SLIPS.items():
        wrong = duff(normal, places)
        if abs(np.linalg.det(wrong)) < _LEAST:
            continue
        words = f"these samples fit the pdf in a frame that is not orthogonal: its sign of z < 0 is missing {where}"
        back = np.linalg.inv(wrong) @ right
        yield Hypothesis(
            "skewed frame", f"{words} (Duff et al. 2017)", partial(_through, back, float(np.linalg.det(back))), fitted=2
        )


def _through(back: np.ndarray, determinant: float, setting: Setting, _: float) -> Density:
    """Return the density of directions x whose images under x -> x `back`, normalised, have the claimed one."""

    def density(x: np.ndarray) -> np.ndarray:
        y = x @ back
        length = np.sqrt(np.sum(y * y, axis=1))
        return setting.p(y / length[:, None]) * abs(determinant) / length**3

    return density


def duff(normal: np.ndarray, without: tuple[int, ...] = ()) -> np.ndarray:
    """Return the axes, rows of (3, 3), of the frame of Duff et al. (2017) about a normal, its sign left out in some places."""
    x, y, z = normal.tolist()
    s = [1.0 if place in without else float(np.copysign(1.0, z)) for place in range(5)]
    a = -1 / (s[0] + z)
    return np.array([[1 + s[1] * x * x * a, s[2] * x * y * a, -s[3] * x], [x * y * a, s[4] + y * y * a, -y], [x, y, z]])


def _turned(setting: Setting) -> Iterator[Hypothesis]:
    """Yield the turn that takes the mean direction of the claim to that of the samples, if both have one."""
    claim, samples = setting.claimed_mean(), setting.contrast.x.mean(axis=0)
    lengths = float(np.linalg.norm(claim)), float(np.linalg.norm(samples))
    if min(lengths) < _LEAN:
        return
    a, b = claim / lengths[0], samples / lengths[1]
    back = turn(b, a)
    degrees = float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))
    lean = ", ".join(f"{c:.3f}" for c in b)
    words = f"these samples fit the pdf in another frame: turned by {degrees:.3g} degrees, towards ({lean})"
    yield Hypothesis("rotated frame", words, lambda s, _: lambda x: s.p(x @ back.T), fitted=2)


def axis_of_symmetry(setting: Setting, near: np.ndarray) -> np.ndarray:
    """Return the axis (3,) about which half a turn changes nothing in the claim, or `near` itself if there is none close to it.

    Points of the known law tell a mean to a few thousandths; such an axis follows from the density alone.
    """
    from scipy.optimize import least_squares

    x = setting.claimed_points(_POINTS)
    logarithm, across = _logarithm(setting.p(x)), duff(near)[:2]

    def axis(step: np.ndarray) -> np.ndarray:
        tilted = near + step @ across
        return np.asarray(tilted / np.linalg.norm(tilted))

    def difference(step: np.ndarray) -> np.ndarray:
        n = axis(step)
        return _logarithm(setting.p(2 * (x @ n)[:, None] * n - x)) - logarithm

    found = least_squares(difference, np.zeros(2), max_nfev=_STEPS)
    left = float(np.quantile(found.fun**2, _MOST))  # beyond an edge of the claim nothing is told
    return axis(found.x) if left < _SYMMETRIC * float(np.var(logarithm)) else _axis_of_edge(setting, near, across)


def _axis_of_edge(setting: Setting, near: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Return the axis (3,) of the circle on which the claim ends, all around `near`; that itself if it ends on none.

    An even claim in a cone has no other mark of its axis. Its edge is found by bisection, in directions (m, 3) across `near`.
    """
    phi = 2 * np.pi * np.arange(_AZIMUTHS)[:, None] / _AZIMUTHS
    away = np.cos(phi) * across[0] + np.sin(phi) * across[1]

    def at(theta: np.ndarray) -> np.ndarray:
        return np.asarray(np.cos(theta)[:, None] * near + np.sin(theta)[:, None] * away)

    low, high = np.zeros(_AZIMUTHS), np.full(_AZIMUTHS, np.pi)
    if not setting.p(near[None])[0] > 0 or setting.p(-near[None])[0] > 0:
        return near
    for _ in range(_HALVED):
        middle = 0.5 * (low + high)
        within = setting.p(at(middle)) > 0
        low, high = np.where(within, middle, low), np.where(within, high, middle)
    edge = at(low)
    _, lengths, axes = np.linalg.svd(edge - edge.mean(axis=0))
    return axes[2] * np.sign(axes[2] @ near) if lengths[2] < _CIRCLE * lengths[1] else near


def _logarithm(p: np.ndarray) -> np.ndarray:
    return np.log(np.maximum(p, 1e-300))


def turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the rotation that takes the unit vector a to b the shortest way (Rodrigues)."""
    axis, cosine = np.cross(a, b), float(a @ b)
    if cosine < -1 + 1e-9:
        other = np.eye(3)[int(np.argmin(np.abs(a)))]
        axis = np.cross(a, other)
        axis /= np.linalg.norm(axis)
        return 2 * np.outer(axis, axis) - np.eye(3)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1 + cosine)
