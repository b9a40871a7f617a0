"""The derivative of an analytic function from its values at a few nodes, with a bound.

Let p interpolate f at the nodes x_j, of which x_0 is one. With w(x) = prod (x - x_j) the remainder is w(x) f[x_0 … x_n, x],
so that f'(x_0) - p'(x_0) = w'(x_0) f[x_0 … x_n, x_0]. If f is analytic and |f| <= M in the disc of radius R about x_0, a
divided difference over k + 1 points within a of x_0 is at most M/(R - a)^k (Cauchy). So the remainder is bounded for every
function that keeps to M. The errors of the values are carried through the sum, and are what they are for the values: where
those are estimated, so is this. That nodes may be asked a few roundings aside is charged by twice the steepest chord.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.contracts import Reference

Function = Callable[[float], Reference]

NODES = 25
"""Odd, so that the middle is a node."""

SHARE = 0.25
"""Of the disc's radius that nodes take: wider ones carry less rounding, narrower ones leave less remainder."""


NARROW = 0.2
"""Share of the reach that must be free on both sides, or nodes stand on one side only."""


class Disc(NamedTuple):
    """Where a function is analytic about the place of the derivative, and what bounds it there.

    radius  > 0
    most    |f| <= most in the open disc, of the function's shape
    below, above  how far from the place of the derivative the function may be asked
    """

    radius: float
    most: np.ndarray
    below: float = np.inf
    above: float = np.inf


def derivative_from_values(f: Function, x: float, disc: Disc, order: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return the first or second derivative of f at x and a bound on its error, both of the function's shape.

    f      real x -> Reference; called at 25 places within a quarter of the disc's radius of x
    order  1 or 2
    """
    reach = SHARE * disc.radius
    nodes, place = _nodes(x, reach, disc.below, disc.above)
    value, noise, size = differentiated(f, nodes, place, order)
    away = np.delete(nodes - x, place)
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        slope = np.prod(np.abs(away) / (disc.radius - reach))  # |w'(x)| / (R - a)^(k - 1)
        once, twice = (slope / (disc.radius - reach) ** power for power in (1, 2))
        if order == 1:
            remainder = once * disc.most
        else:
            bend = 2 * np.sum(1 / np.abs(away)) * once  # |w''(x)|, without the cancellation of its two halves
            remainder = (bend + 2 * twice) * disc.most
    return value, noise + remainder + 64 * EPS * size


def _nodes(x: float, reach: float, below: float, above: float) -> tuple[np.ndarray, int]:
    """Return Chebyshev's extrema about x, or on the wider side of it if the other is narrow, and which of them is x."""
    if min(below, above) >= NARROW * reach:
        reach = min(reach, below, above)
        return x + reach * np.sin(np.pi * np.arange(-(NODES // 2), NODES // 2 + 1) / (NODES - 1)), NODES // 2
    away = np.sin(0.5 * np.pi * np.arange(NODES) / (NODES - 1)) ** 2
    return (x + min(reach, above) * away, 0) if above > below else (x - min(reach, below) * away, 0)


def differentiated(f: Function, nodes: np.ndarray, middle: int, order: int) -> tuple[np.ndarray, ...]:
    """Return the derivative at nodes[middle] of the polynomial through the values, its error by theirs, its terms' size."""
    values = [f(float(node)) for node in nodes]
    weights = _weights(nodes, middle, order)
    base = values[middle].value
    # Differences to the middle: weights sum to zero, and what all values share cancels before it is multiplied.
    terms = np.stack([w * (v.value - base) for w, v in zip(weights, values, strict=True)])
    noise = sum(abs(w) * v.error for w, v in zip(weights, values, strict=True))
    # Where a parameter is made of others, f is asked a few roundings beside the node: by as much as its chords are steep.
    others = [i for i in range(len(nodes)) if i != middle]
    steep = 2 * np.max([np.abs((values[i].value - base) / (nodes[i] - nodes[middle])) for i in others], axis=0)
    noise = noise + 4 * EPS * abs(nodes[middle]) * np.sum(np.abs(weights)) * steep
    return np.sum(terms, axis=0), np.asarray(noise), np.sum(np.abs(terms), axis=0)


def _weights(nodes: np.ndarray, middle: int, order: int) -> np.ndarray:
    """Return the weights of the values in the derivative of their polynomial at one node (Berrut & Trefethen 2004, 9.4)."""
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    scale = np.max(np.abs(apart))
    barycentric = 1 / np.prod(apart / scale, axis=1)
    first = barycentric / barycentric[:, None] / apart
    np.fill_diagonal(first, 0.0)
    np.fill_diagonal(first, -np.sum(first, axis=1))
    if order == 1:
        return np.asarray(first[middle])
    second = 2 * first * (np.diag(first)[:, None] - 1 / apart)
    np.fill_diagonal(second, 0.0)
    np.fill_diagonal(second, -np.sum(second, axis=1))
    return np.asarray(second[middle])
