"""Estimators that look at equidistant places behind a random offset: the depth that they find takes a few values.

Of M looks behind the offset u those with (i + u)/M below the end of a voxel lie before it: their number is a step function of u,
whose steps are at the fractional parts of M times the ends of the voxels. Between steps everything is constant.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.variance.voxel_ray import EstimateMoments, VoxelRay
from fogproof.errors import UnsupportedError

AtomLaw = list[tuple[Fraction, Fraction]]
"""(probability, optical depth found)."""

LEVELS = 20
"""Halvings after which telescoping ends; the finest march is off by what is counted."""

STAYS, SURE = 0.9, 2
"""Probability of the order 0 of unbiased ray marching, and the order that all others reach (Kettunen et al. 2021, algorithm 2)."""

MOST_VALUES, MOST_TERMS = 4, 100_000
FEWEST = 1e-17
"""Probability of an order, times its largest square, that is left out and counted."""


def march(ray: VoxelRay, points: int) -> EstimateMoments:
    """Return the moments of exp(-depth) of one comb."""
    return _of_values([(float(p), math.exp(-x)) for p, x in _law(ray, points)], float(points))


def telescoping(ray: VoxelRay, points: int, ratio: float) -> EstimateMoments:
    """Return the moments of first + (fine - coarse)/probability, for the offset and the level together."""
    values, chances = [], [(1 - ratio) * ratio**j for j in range(LEVELS)] + [ratio**LEVELS]
    steps = sorted({Fraction(0), Fraction(1), *(s for j in range(LEVELS + 2) for s in _steps(ray, points << j))})
    for low, high in pairwise(steps):
        seen = [math.exp(-_depth(ray, points << j, (low + high) / 2)) for j in range(LEVELS + 2)]
        width = float(high - low)
        values += [(width * p, seen[0] + (seen[j + 1] - seen[j]) / p) for j, p in enumerate(chances)]
    cost = sum(p * points * ((1 << j) + (2 << j) + (j > 0)) for j, p in enumerate(chances))
    return _of_values(values, cost)


def unbiased_march(ray: VoxelRay, points: int) -> EstimateMoments:
    """Return the moments of the mean over pivots, by counting how many combs found each value."""
    law = _law(ray, points)
    if len(law) > MOST_VALUES:
        what = f"the combs of {points} looks find {len(law)} different optical depths, and at most {MOST_VALUES} are enumerated"
        raise UnsupportedError(f"{what}: take fewer voxels", "points")
    x, p = np.array([-float(depth) for _, depth in law]), [float(chance) for chance, _ in law]
    spread, most = float(x.max() - x.min()), math.exp(float(x.max()))
    last, lost = _last_order(spread, most, len(p), points)
    values = [(STAYS * q, math.exp(v)) for q, v in zip(p, x, strict=True)]
    reached, cost = 1 - STAYS, STAYS * points
    for order in range(SURE, last + 1):
        weights = _weights(order)
        after = reached * 2 / (order + 1)
        shares = weights / [math.comb(order, k) for k in range(order + 1)]
        powers = [
            [[(v - u) ** k * math.comb(n, k) for k in range(n + 1)] for n in range(order + 2)] for u in x for v in x
        ]
        factors = [[np.array(row) for row in rows] for rows in powers]
        for counts in _compositions(order + 1, len(p)):
            chance = math.factorial(order + 1) * math.prod(
                q**c / math.factorial(c) for q, c in zip(p, counts, strict=True)
            )
            values.append(((reached - after) * chance, _estimate(x, counts, shares, factors)))
        cost += points * (order + 1) * (reached - after)
        reached = after
    found = _of_values(values, cost + points * (last + 2) * reached)
    return found._replace(mean_error=found.mean_error + lost, variance_error=found.variance_error + 2 * lost)


def _last_order(spread: float, most: float, values: int, points: int) -> tuple[int, float]:
    """Return up to which order is enumerated, and a bound of what all orders beyond it bring to mean and mean square."""
    order, reached, terms = SURE, 1 - STAYS, 0
    while True:
        largest = most * float(_weights(order) @ spread ** np.arange(order + 1.0))
        lost = 2 * reached * max(largest, largest**2)  # each order brings less than half of the one before it
        if lost < FEWEST and spread**2 < order + 1:
            return order - 1, lost
        terms += math.comb(order + values, values - 1)
        if terms > MOST_TERMS:
            what = (
                f"the combs of {points} looks differ by an optical depth of up to {spread:.3g}, too much to enumerate"
            )
            raise UnsupportedError(f"{what}: take more points", "points")
        order, reached = order + 1, reached * 2 / (order + 1)


def _weights(order: int) -> np.ndarray:
    """Return 1/(k! P(order >= k)) for k = 0 … order."""
    reached, weights = 1.0, [1.0]
    for k in range(1, order + 1):
        reached = 1 - STAYS if k <= SURE else reached * 2 / k
        weights.append(1 / (math.factorial(k) * reached))
    return np.array(weights)


def _estimate(x: np.ndarray, counts: tuple[int, ...], shares: np.ndarray, factors: list[list[np.ndarray]]) -> float:
    """Return the estimate where so many of the N + 1 combs found each of the values -x.

    shares   what elementary symmetric polynomials of orders 0 … N are multiplied with
    factors  the coefficients of (1 + (x_j - x_i) z)^n, whose products over j are those polynomials, by i and j, and by n
    """
    total = 0.0
    for i, pivots in enumerate(counts):
        if pivots:
            product = np.ones(1)
            for j, count in enumerate(counts):
                if j != i and count:
                    product = np.convolve(product, factors[i * len(counts) + j][count])
            total += pivots * math.exp(x[i]) * float(shares[: len(product)] @ product)
    return total / sum(counts)


def _compositions(total: int, parts: int) -> list[tuple[int, ...]]:
    """Return all ways to write a number as an ordered sum of so many numbers >= 0."""
    if parts == 1:
        return [(total,)]
    return [(first, *rest) for first in range(total + 1) for rest in _compositions(total - first, parts - 1)]


def _of_values(values: list[tuple[float, float]], cost: float) -> EstimateMoments:
    """Return the moments of a discrete law given as (probability, value); the errors count rounding of all of it."""
    mean = math.fsum(p * v for p, v in values)
    variance = math.fsum(p * (v - mean) ** 2 for p, v in values)
    size, square = math.fsum(p * abs(v) for p, v in values), math.fsum(p * (v * v + mean * mean) for p, v in values)
    return EstimateMoments(mean, variance, cost, 64 * EPS * size, 128 * EPS * square)


def _ends(ray: VoxelRay) -> list[Fraction]:
    """Return where the voxels end, as shares of the way."""
    whole, ends, at = sum(ray.length, Fraction(0)), [], Fraction(0)
    for way in ray.length:
        at += way
        ends.append(at / whole)
    return ends


def _steps(ray: VoxelRay, points: int) -> list[Fraction]:
    """Return the offsets at which a look moves from one voxel to another."""
    return [end * points % 1 for end in _ends(ray)]


def _depth(ray: VoxelRay, points: int, offset: Fraction) -> Fraction:
    """Return the optical depth that the looks find."""
    before, total = 0, Fraction(0)
    for sigma, end in zip(ray.sigma, _ends(ray), strict=True):
        upto = min(max(math.ceil(end * points - offset), 0), points)
        total += (upto - before) * sigma
        before = upto
    return total * sum(ray.length, Fraction(0)) / points


def _law(ray: VoxelRay, points: int) -> AtomLaw:
    steps = sorted({Fraction(0), Fraction(1), *_steps(ray, points)})
    law: dict[Fraction, Fraction] = {}
    for low, high in pairwise(steps):
        depth = _depth(ray, points, (low + high) / 2)
        law[depth] = law.get(depth, Fraction(0)) + high - low
    return [(p, depth) for depth, p in law.items()]
