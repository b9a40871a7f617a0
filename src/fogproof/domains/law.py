"""What a domain gives: which points are its own, their measure, and one known law on it.

The known law is a bijection with the unit cube: uniform numbers placed by it are points of the law. Its coordinates are what
cells are cut in, its density is what an unknown density is held against. It need not be like any sampler's law; it must only reach
every point.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

_BESIDE = 2.0  # steps of a coordinate: uniform numbers below 1/2 may be as coarse as those above
_LAST = 1 - 2.0**-53  # below 1


@dataclass(frozen=True)
class Law:
    """A known law on a domain of k coordinates.

    axes         k names of the coordinates
    place        (n, k) uniform numbers in [0, 1) -> n points of the law
    coordinates  n points and (n, k) numbers in [0, 1) -> (n, k) in [0, 1], the inverse of `place`; where single points have
                 probability, the numbers say where in the interval of its point each one lies, elsewhere they are not looked at
    density      n points -> (n,) density of the law in the measure of the domain, > 0
    stepped      whether single points have probability
    """

    axes: tuple[str, ...]
    place: Callable[[np.ndarray], np.ndarray]
    coordinates: Callable[[np.ndarray, np.ndarray], np.ndarray]
    density: Callable[[np.ndarray], np.ndarray]
    stepped: bool = False

    def neighbours(self, x: np.ndarray) -> list[np.ndarray]:
        """Return the points of the law beside n points, at both sides along each axis, as far as its coordinates are coarse.

        Around 0, where coordinates do not end, numbers lie much closer.
        """
        u = self.coordinates(x, np.full((len(x), len(self.axes)), 0.5))
        beside = []
        for axis in range(len(self.axes)):
            step = _BESIDE * np.spacing(u[:, axis])
            for moved in (u[:, axis] - step, u[:, axis] + step):
                there = u.copy()
                there[:, axis] = np.clip(moved, 0.0, _LAST)
                beside.append(self.place(there))
        return beside


@runtime_checkable
class Domain(Protocol):
    """Where samples live, and the measure that their density refers to. Any object with these parts is a domain.

    One whose points hold whole numbers says so by a further part, `whole`: one truth for each number of a point; one whose points
    hold directions by `vectors`: the first column of each, and that after its last.
    """

    @property
    def shape(self) -> tuple[int, ...]:
        """Of one point: () for a number, (k,) for k numbers."""

    @property
    def measure(self) -> float:
        """Of the whole domain; infinite, or NaN where it is not known."""

    def contains(self, x: np.ndarray, slack: float) -> np.ndarray:
        """Return (n,) which points lie in the domain, up to rounding errors of relative size `slack`; NaN never does.

        Ends forgive `at_the_ends(slack)` of the domain's own size; where it has none, of that of the points.
        """

    def law(self, pilot: np.ndarray) -> Law:
        """Return a known law; on unbounded domains the points `pilot` set its scale."""


def whole_columns(domain: Domain) -> tuple[bool, ...]:
    """Return which numbers of a point are whole ones: they are exact, and between two of them there is nothing."""
    return tuple(getattr(domain, "whole", (False,) * math.prod(domain.shape)))


def vector_columns(domain: Domain) -> tuple[tuple[int, int], ...]:
    """Return the first column of each direction in a point, and that after its last."""
    return tuple(getattr(domain, "vectors", ()))


def at_the_ends(slack: float) -> float:
    """Return how far beyond its ends a point may lie by rounding, as a share of the domain's size.

    Formulas lose digits there: h tan(theta) has h / t times the error of its angle, a few hundred ulps and more for a small h.
    A quarter of the digits is forgiven: of 16 roundings, 9e-12 in double precision and 3e-5 in single.
    """
    return float(slack**0.75)


def squared(x: np.ndarray) -> np.ndarray:
    """Return (n,) the squared lengths of vectors (n, k)."""
    return np.einsum("...i,...i->...", x, x)
