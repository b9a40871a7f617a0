"""Estimators that look at tentative collisions or at uniform places, on a ray through voxels: moments in closed form.

Tentative collisions are a Poisson process of rate m. If at each a walker goes on with a probability and a factor whose mean square
is q, the mean square of what it has at the end is exp(-int m (1 - q) dt) (Campbell 1909).
"""

from __future__ import annotations

import math

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.variance.voxel_ray import EstimateMoments, VoxelRay
from fogproof.errors import UnsupportedError

ROUNDING = 256 * EPS
"""Of a sum of exponentials of sums over 64 voxels, relative to its terms and multiplied with the optical depth below."""

LARGEST = 300.0
"""Exponent of the greatest mean square that is answered."""

UNDERFLOWS = 750.0
"""Exponent beyond which an exponential is 0."""


def _allowed(exponent: float) -> float:
    """Return the exponent of a mean square, or say why it is out of range."""
    if exponent > LARGEST:
        what = f"the mean square of the estimate has the size exp({exponent:.3g})"
        raise UnsupportedError(f"{what}: take a larger majorant", "majorant")
    return exponent


def _voxels(ray: VoxelRay) -> list[tuple[float, float]]:
    return [(float(s), float(way)) for s, way in zip(ray.sigma, ray.length, strict=True)]


def _share(x: float) -> float:
    """Return (1 - exp(-x))/x."""
    return -math.expm1(-x) / x if x != 0 else 1.0


def _moments(depth: float, second: float, cost: float, size: float) -> EstimateMoments:
    """Return the moments of an unbiased estimate with that mean square, whose terms add up to `size`."""
    T = math.exp(-depth)
    error = ROUNDING * (1 + depth) * T
    return EstimateMoments(T, second - T * T, cost, error, ROUNDING * (1 + depth) * (size + T * T))


def weighted(ray: VoxelRay, m: float) -> EstimateMoments:
    """Return the moments of weighted tracking: a null collision has the weight (sigma + |m - sigma|)/m, real ones end the walk."""
    exponent, cost, alive = 0.0, 0.0, 1.0
    for sigma, way in _voxels(ray):
        null = abs(m - sigma)
        exponent -= way * (m - null * (sigma + null) / m)
        ends = m * sigma / (sigma + null)
        cost += m * alive * way * _share(ends * way)
        alive *= math.exp(-ends * way)
    second = math.exp(_allowed(exponent))
    grown = 1 + abs(exponent) / (1 + ray.depth)
    return _moments(ray.depth, second, cost, second * grown)


def decomposition(ray: VoxelRay, m: float, control: float) -> EstimateMoments:
    """Return the moments of exp(-control s) times 0 or 1."""
    whole = float(sum(ray.length))
    cost, alive = 0.0, 1.0
    for sigma, way in _voxels(ray):
        cost += (m - control) * alive * way * _share((sigma - control) * way)
        alive *= math.exp(-(sigma - control) * way)
    second = math.exp(-ray.depth - control * whole)
    return _moments(ray.depth, second, cost, second)


def next_flight(ray: VoxelRay, m: float) -> EstimateMoments:
    """Return the moments of the sum of next flights.

    With a walker's value Z(y) from y on, a(y) = exp(-m (S - y)) the first flight and T(y) what is left of the transmittance,
    E[Z^2](0) = A(0) + int m (1 - sigma/m)^2 exp(-int_0^y (2 sigma - sigma^2/m)) A(y) dy, A = 2 a T - a^2.
    """
    voxels = _voxels(ray)
    far, depth = sum(way for _, way in voxels), ray.depth
    a, T, lost = math.exp(-m * far), math.exp(-depth), 0.0
    second, size = 2 * a * T - a * a, 2 * a * T + a * a
    left, behind = depth, far
    for sigma, way in voxels:
        left, behind = left - sigma * way, behind - way
        a, T = math.exp(-m * max(behind, 0.0)), math.exp(-max(left, 0.0))
        rate = 2 * sigma - sigma * sigma / m
        scale = m * (1 - sigma / m) ** 2 * math.exp(_allowed(-lost - rate * way)) * way
        # From the end of the voxel backwards both terms decay: by m + sigma - rate > 0 and 2 m - rate > 0.
        first = 2 * a * T * _share((m + sigma - rate) * way)
        other = a * a * _share((2 * m - rate) * way)
        second += scale * (first - other)
        size += scale * (first + other)
        lost += rate * way
    return _moments(depth, second, m * far, size * (1 + min(m * far, UNDERFLOWS)))


def power_series(ray: VoxelRay, pivot: float, reach: float) -> EstimateMoments:
    """Return the moments of exp(-c) sum_k Y_1 … Y_k/(k! P_k), Y = c - S sigma(uniform), P_k = prod min(1, reach/i).

    Two terms k <= l share k factors, and the longer one is there with probability P_l: their product has the mean
    E[Y^2]^k E[Y]^(l - k)/(k! l! P_k).
    """
    whole = sum(ray.length)
    first = float(
        sum(way * (pivot - float(whole) * float(s)) for s, way in zip(ray.sigma, ray.length, strict=True)) / whole
    )
    second = sum(
        float(way / whole) * (pivot - float(whole * s)) ** 2 for s, way in zip(ray.sigma, ray.length, strict=True)
    )
    if 4 * second > LARGEST**2 or second > LARGEST * reach:
        what = f"looks are off the pivot by {math.sqrt(second):.3g} (root mean square), which makes the variance of the series huge"
        raise UnsupportedError(f"{what}: take a pivot nearer to the optical depth, or a larger reach", "pivot")
    total, size, k, together = 0.0, 0.0, 0, 1.0
    while True:
        # Sum over l >= k of E[Y]^(l - k) k!/l!, the part of the exponential series that follows; all but the first stand twice.
        tail, bound, part, l = 0.0, 0.0, 1.0, k  # noqa: E741
        while abs(part) > 1e-20 * max(abs(tail), 1e-300) or l < k + abs(first):
            tail, bound = tail + part * (1 if l == k else 2), bound + abs(part) * 2
            l += 1  # noqa: E741
            part *= first / l
        total, size = total + together * tail, size + together * bound
        k += 1
        goes_on = min(1.0, reach / k)
        together *= second / (k * k * goes_on)
        if k * k * goes_on > 4 * second and together * math.exp(abs(first)) < 1e-20 * size:
            break
    cost, reached, order = 0.0, 1.0, 0
    while reached > 1e-18 * max(cost, 1e-300):
        order += 1
        reached *= min(1.0, reach / order)
        cost += reached
    scale = math.exp(-2 * pivot)
    return _moments(ray.depth, scale * total, cost, scale * size * (1 + k / 64 + pivot))
