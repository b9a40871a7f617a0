"""Directions: the sphere, the upper hemisphere, and any part of the sphere that its user can recognise."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from fogproof.domains.law import Law, at_the_ends, squared
from fogproof.errors import InvalidValueError
from fogproof.validate import number

TURN = 2 * np.pi
_LENGTH = 256  # slacks, of a single vector: a textbook cosine passes 1 by so much, and a length is no place
_BESIDE = 8  # directions around one that is not recognised


def azimuth(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return (n,) the angle about z as a share of the turn, in [0, 1], from -x over -y."""
    return np.clip(np.arctan2(y, x) / TURN + 0.5, 0.0, 1.0)


def direction(versine: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return (n, 3) unit vectors with 1 - z = versine in [0, 2] and the given share of the turn about z."""
    sine, phi = np.sqrt(np.maximum(versine * (2 - versine), 0.0)), TURN * (share - 0.5)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1 - versine], axis=-1)


def versine(x: np.ndarray) -> np.ndarray:
    """Return (n,) 1 - z of unit vectors (n, 3), without loss near +z, whatever the rounding of their length."""
    small = (x[:, 0] ** 2 + x[:, 1] ** 2) / (1 + np.abs(x[:, 2]))
    return np.where(x[:, 2] < 0, 2 - small, small)


def unit(x: np.ndarray, slack: float) -> np.ndarray:
    """Return which vectors (n, 3) have length 1; the rounding of a length moves no direction, so more of it is forgiven."""
    return np.abs(squared(x) - 1) <= 2 * _LENGTH * slack


def _around(x: np.ndarray, length: float) -> Iterator[np.ndarray]:
    """Yield (n, 3) steps of the given length across unit vectors (n, 3), evenly around each: no corner of 45 degrees is missed."""
    first = np.cross(x, np.eye(3)[np.argmin(np.abs(x), axis=1)])
    first /= np.sqrt(squared(first))[:, None]
    second = np.cross(x, first)
    for angle in TURN / _BESIDE * np.arange(_BESIDE):
        yield length * (np.cos(angle) * first + np.sin(angle) * second)


def cap(highest: float) -> Law:
    """Return the uniform law on the directions with 1 - z <= highest."""
    return Law(
        ("mu", "phi"),
        lambda u: direction(highest * u[:, 0], u[:, 1]),
        lambda x, v: np.stack([np.clip(versine(x) / highest, 0.0, 1.0), azimuth(x[:, 0], x[:, 1])], axis=-1),
        lambda x: np.full(len(x), 1 / (TURN * highest)),
    )


@dataclass(frozen=True)
class UnitSphere:
    """All directions; the pdf is per steradian."""

    shape = (3,)
    vectors = ((0, 3),)
    measure = 2 * TURN

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which vectors have length 1."""
        return unit(x, slack)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return cap(2.0)


@dataclass(frozen=True)
class UnitHemisphere:
    """Directions with z >= 0; the pdf is per steradian."""

    shape = (3,)
    vectors = ((0, 3),)
    measure = TURN

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which vectors have length 1 and do not point down."""
        return unit(x, slack) & (x[..., 2] >= -at_the_ends(slack))

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law."""
        return cap(1.0)


@dataclass(frozen=True)
class SpherePart:
    """The directions that a function of the user's recognises; the pdf is per steradian.

    A direction is also recognised if one beside it is, as far away as rounding may have moved it: see `at_the_ends`.

    inside  (n, 3) unit vectors -> (n,) bool
    solid_angle  [sr], if it is known
    """

    inside: Callable[[np.ndarray], np.ndarray]
    solid_angle: float = math.nan

    shape = (3,)
    vectors = ((0, 3),)

    def __post_init__(self) -> None:
        if not callable(self.inside):
            raise InvalidValueError("inside", "must be a function of directions", self.inside)
        if not (isinstance(self.solid_angle, float) and math.isnan(self.solid_angle)):
            rule = "must be a solid angle in (0, 4 pi]"
            angle = number("solid_angle", self.solid_angle, rule, 0, 2 * TURN * (1 + 1e-12))
            if angle == 0:
                raise InvalidValueError("solid_angle", rule, angle)
            object.__setattr__(self, "solid_angle", angle)

    @property
    def measure(self) -> float:
        """The solid angle."""
        return self.solid_angle

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return which vectors have length 1 and are recognised, or lie so near one that is that rounding explains it."""
        good = unit(x, slack)
        recognised = self._recognised(x)
        at = np.flatnonzero(good & ~recognised)
        for step in _around(x[at], at_the_ends(slack)) if len(at) else ():
            recognised[at] |= self._recognised(x[at] + step)
        return good & recognised

    def _recognised(self, x: np.ndarray) -> np.ndarray:
        recognised = np.asarray(self.inside(x))
        if recognised.shape != (len(x),):
            raise InvalidValueError("inside", f"must return one bool a direction, ({len(x)},)", recognised.shape)
        return recognised.astype(bool)

    def law(self, pilot: np.ndarray) -> Law:
        """Return the uniform law on the whole sphere."""
        return cap(2.0)
