"""Light with extent: what it sends to a point, as a rule over directions, and how such rules are made fine enough.

A light of radiance 1 sends sum_k weight_k g(w_k, distance_k) where an integral over the solid angle is meant, of a function g of
the direction back to the light and the way there. The rules of a light with rising numbers of nodes converge to that integral;
twice the difference of the last two is taken for the error of the last.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS

NODES = (8, 14, 24, 40, 68)
"""Nodes along each axis of the rules, one after the other."""

TOLERANCE = 1e-11
"""Relative difference of two rules that is small enough."""

LARGEST = 1 << 13
"""Most directions of a rule: what is missing then stands in the error."""

SIZE = 1 << 18
"""Directions evaluated at a time."""


class Incident(NamedTuple):
    """Where light of radiance 1 arrives from, at points (m, ...).

    direction  (m, k, 3) unit vectors from the points to the light
    distance   (m, k) of the light [m], inf for light from infinitely far
    weight     (m, k) solid angle [sr]
    """

    direction: np.ndarray
    distance: np.ndarray
    weight: np.ndarray


class Extent(NamedTuple):
    """How a light with extent lies to n rays.

    end     (n,) distance from the camera at which the ray meets the light, which is opaque [m]; inf if it does not
    places  (n, m) distances at which the light changes suddenly: where the ray crosses its plane, and the like
    foot    (n,) distance from the camera to the point nearest to its centre [m]
    reach   (n,) how far along the ray the light changes little [m]
    """

    end: np.ndarray
    places: np.ndarray
    foot: np.ndarray
    reach: np.ndarray


Rule = Callable[[np.ndarray, int], Incident]
"""(points (m, 3), nodes along each axis) -> the rule there."""

Received = Callable[[np.ndarray, Incident], tuple[np.ndarray, np.ndarray]]
"""(which points (m,), the rule there) -> its sum and what rounding makes of it, (m, channels) each."""


def received(x: np.ndarray, rule: Rule, total: Received, channels: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over all directions at points x (m, 3), and its error, (m, channels) each."""
    value, error = np.zeros((2, len(x), channels))
    left = np.arange(len(x))
    for level, nodes in enumerate(NODES):
        if not len(left):
            break
        size = rule(x[left[:1]], nodes).weight.shape[1]
        if level > 1 and size > LARGEST:
            break
        step = max(1, SIZE // size)
        found, noise = np.empty((2, len(left), channels))
        for i in range(0, len(left), step):
            some = left[i : i + step]
            found[i : i + step], noise[i : i + step] = total(some, rule(x[some], nodes))
        if level == 0:
            value[left], error[left] = found, np.inf
            continue
        off = 2 * np.abs(found - value[left])
        value[left], error[left] = found, off + noise + 64 * EPS * found
        left = left[(off > TOLERANCE * found).any(axis=1)]
    return value, error
