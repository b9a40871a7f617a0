"""What the tests of media compare with: slow, literal and independent of the package; exact fractions and mpmath."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import mpmath as mp
import numpy as np

DIGITS = 60


def within(reference, truth, at=()):
    """Assert that element `at` of a Reference keeps its promise |value - truth| <= error; return the relative error."""
    with mp.workdps(DIGITS):
        value, error = exact(reference.value[at]), exact(reference.error[at])
        if truth == mp.inf or value == mp.inf:
            assert truth == value or error == mp.inf, f"value {value}, truth {truth}"
            return 0.0
        off = abs(value - truth)
        assert off <= error, (
            f"value {value} is off by {mp.nstr(off, 5)}, it promised {mp.nstr(error, 5)}; truth {truth}"
        )
        return float(off / truth) if truth else float(off)


def exact(x):
    """Return the exact number that a float or a fraction stands for."""
    if isinstance(x, Fraction):
        return mp.mpf(x.numerator) / x.denominator
    return x if isinstance(x, mp.mpf) else mp.mpf(float(x))


def fog(sigma_a, sigma_s, emission, s, ambient, background):
    """The lerp with ambient light and emission, straight from the integral of the source along the ray."""
    with mp.workdps(DIGITS + 700):  # 1 - exp(-tau) is taken literally, with tau down to 1e-600
        sigma_a, sigma_s, emission, s, ambient, background = map(
            exact, (sigma_a, sigma_s, emission, s, ambient, background)
        )
        sigma_t = sigma_a + sigma_s
        if not sigma_t:
            return background
        survived = mp.exp(-sigma_t * s) if s != mp.inf else mp.mpf(0)
        return survived * background + (sigma_s * ambient + sigma_a * emission) * (1 - survived) / sigma_t


def fractions(values):
    return [Fraction(float(v)) for v in values]


def dot(a, b):
    return sum(x * y for x, y in zip(fractions(a), fractions(b), strict=True))


def linear_tau(sigma_0, gradient, origin, direction, s):
    """The area under max(0, a + b t) on [0, s], from its corners; s may be inf."""
    a, b = Fraction(sigma_0) + dot(gradient, origin), dot(gradient, direction)
    if s == np.inf:
        if b > 0 or (b == 0 and a > 0):
            return mp.inf
        return Fraction(0) if a <= 0 else -a * a / b / 2
    corners = {Fraction(0), Fraction(float(s))} | ({-a / b} if b else set())
    corners = sorted(t for t in corners if 0 <= t <= Fraction(float(s)))
    heights = [max(Fraction(0), a + b * t) for t in corners]
    return sum((corners[i + 1] - corners[i]) * (heights[i] + heights[i + 1]) / 2 for i in range(len(corners) - 1))


def exponential_tau(sigma_0, rate, origin, direction, s):
    """sigma_0 e^{e} (e^{k s} - 1)/k taken literally, with digits to spare."""
    with mp.workdps(900):
        e, k = exact(dot(rate, origin)), exact(dot(rate, direction))
        sigma = exact(sigma_0) * mp.exp(e)
        if s == np.inf:
            return mp.inf if k >= 0 and sigma else -sigma / k if k else mp.mpf(0)
        return sigma * (mp.exp(k * exact(s)) - 1) / k if k else sigma * exact(s)


def overlap(low, high, origin, direction, s):
    """The part of [0, s] in which low <= origin + t direction < high, by exact clipping, or None."""
    start, end = Fraction(0), Fraction(float(s)) if s != np.inf else None
    for a, b, o, d in zip(low, high, origin, direction, strict=True):
        if d == 0:
            if (a is not None and o < a) or (b is not None and o >= b):
                return None
            continue
        near, far = (a, b) if d > 0 else (b, a)
        if near is not None:
            start = max(start, (near - o) / d)
        if far is not None:
            end = (far - o) / d if end is None else min(end, (far - o) / d)
    if end is not None and end <= start:
        return None
    return start, end


def cells_met(shape, lower, upper, origin, direction, s, shifted=False):
    """Yield (index, start, end) of every cell of a box that the ray crosses, in no order: each cell is clipped alone.

    shifted  cells between the centres of voxels, with half cells at the border, instead of the voxels
    """
    lower, upper, origin, direction = (fractions(v) for v in (lower, upper, origin, direction))
    planes = []
    for n, a, b in zip(shape, lower, upper, strict=True):
        places = [Fraction(0), *(Fraction(2 * i + 1, 2) for i in range(n)), Fraction(n)] if shifted else range(n + 1)
        planes.append([a + (b - a) * Fraction(p) / n for p in places])
    for index in product(*(range(len(p) - 1) for p in planes)):
        low, high = ([p[i + end] for p, i in zip(planes, index, strict=True)] for end in (0, 1))
        found = overlap(low, high, origin, direction, s)
        if found:
            yield index, *found


def nearest_tau(sigma_t, lower, upper, origin, direction, s):
    met = cells_met(sigma_t.shape, lower, upper, origin, direction, s)
    return sum((Fraction(float(sigma_t[index])) * (end - start) for index, start, end in met), Fraction(0))


def trilinear(array, lower, upper, x):
    """The interpolated value at an exact point."""
    total, axes = Fraction(0), []
    for n, a, b, c in zip(array.shape, fractions(lower), fractions(upper), x, strict=True):
        place = (c - a) * n / (b - a) - Fraction(1, 2)
        place = min(max(place, Fraction(0)), Fraction(n - 1))
        low = min(int(place), max(n - 2, 0))
        axes.append([(low, 1 - (place - low)), (min(low + 1, n - 1), place - low)])
    for corner in product(*axes):
        weight = corner[0][1] * corner[1][1] * corner[2][1]
        total += weight * Fraction(float(array[tuple(i for i, _ in corner)]))
    return total


def trilinear_tau(sigma_t, lower, upper, origin, direction, s):
    """Simpson's rule in each cell between voxel centres, exact for the cubic there, in fractions."""
    total = Fraction(0)
    for _, start, end in cells_met(sigma_t.shape, lower, upper, origin, direction, s, shifted=True):
        at = []
        for t in (start, (start + end) / 2, end):
            x = [o + t * d for o, d in zip(fractions(origin), fractions(direction), strict=True)]
            at.append(trilinear(sigma_t, lower, upper, x))
        total += (end - start) * (at[0] + 4 * at[1] + at[2]) / 6
    return total
