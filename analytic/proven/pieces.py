"""Any medium along one ray as exact pieces, in rational numbers and balls: what rigorous radiance is made of.

Nothing here is shared with the solvers that it judges: crossings are sorted as fractions, and a cell is found from the
exact middle of its piece.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Any

import numpy as np

from fogproof.analytic.proven.balls import Ball, flint, rational, vector
from fogproof.errors import UnsupportedError
from fogproof.scene import (
    AnisotropicMedium,
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    VoxelGrid,
)

Function = Callable[[Any], Any]
"""Analytic, from complex balls to complex balls; the argument is the distance from the start of the piece."""


@dataclass(frozen=True)
class Piece:
    """A stretch of a ray.

    length    [m], None if infinite
    tau       optical thickness of the whole piece
    sigma     extinction coefficient where it is constant, else None
    survived  z -> exp(-tau(z)), where the extinction is not constant
    albedo, emission  rational constants; polynomials (`flint.fmpq_poly`) in z inside trilinear voxels
    extinction  the polynomial sigma_t(z), inside trilinear voxels
    """

    length: Any
    tau: Ball
    albedo: Any
    emission: Any
    sigma: Any = None
    survived: Function | None = None
    extinction: Any = None


def pieces(medium: AnyMedium, origin: np.ndarray, direction: np.ndarray, length: float) -> list[Piece]:
    """Return the pieces of a ray through a grey medium, in order; vacuum that contributes nothing is left out."""
    fq = flint().fmpq
    s = None if np.isinf(length) else rational(length)
    if isinstance(medium, Medium):
        absorbed, scattered = rational(medium.sigma_a), rational(medium.sigma_s)
        sigma = absorbed + scattered
        return [_constant(sigma, s, scattered / sigma if sigma else fq(0), rational(medium.emission))]
    if isinstance(medium, Procedural):
        raise UnsupportedError("nothing can be proven about a user's function: ask without rigorous=True", "medium")
    o, w = vector(origin), vector(direction)
    if isinstance(medium, PiecewiseConstantMedium | VoxelGrid):
        return _cells(medium, [rational(x) for x in origin], w, s)
    source = rational(medium.albedo), rational(medium.emission)
    match medium:
        case LinearMedium():
            gradient = vector(medium.gradient)
            return _linear(rational(medium.sigma_0) + _dot(gradient, o), _dot(gradient, w), s, source)
        case ExponentialMedium():
            rate = vector(medium.rate)
            return _exponential(rational(medium.sigma_0), _dot(rate, o), _dot(rate, w), s, source)
        case AnisotropicMedium():
            S = [[rational(x) for x in row] for row in medium.S]
            square = sum((w[i] * S[i][j] * w[j] for i, j in product(range(3), repeat=2)), fq(0))
            area = flint().arb(max(square, fq(0))).sqrt()
            return [_constant(area * rational(medium.sigma) if square > 0 else fq(0), s, *source)]
    return _opengl(medium, origin, s, source)


def channel(medium: Any, c: int) -> Any:
    """Return one channel of a medium as a grey one."""
    axes = {VoxelGrid: 3, PiecewiseConstantMedium: 1}.get(type(medium), 0)
    fields: dict[str, Any] = {}
    for name in ("sigma_a", "sigma_s", "sigma_t", "sigma_0", "sigma", "albedo", "emission", "gradient", "rate"):
        value = medium.__dict__.get(name)
        if value is None or callable(value):
            continue
        own = axes if name not in ("gradient", "rate") else 1
        fields[name] = np.asarray(value)[..., c] if np.ndim(value) == own + 1 else value
        if name in ("gradient", "rate") and np.ndim(value) == 2:
            fields[name] = np.asarray(value)[c]
    return replace(medium, **fields)


def _dot(a: list[Any], b: list[Any]) -> Any:
    return sum((x * y for x, y in zip(a, b, strict=True)), flint().fmpq(0))


def _constant(sigma: Any, length: Any, albedo: Any, emission: Any) -> Piece:
    arb = flint().arb
    tau = arb(0) if not sigma else arb.pos_inf() if length is None else arb(sigma) * length
    return Piece(length, tau, albedo, emission, sigma=sigma)


def _linear(a: Any, b: Any, s: Any, source: tuple[Any, Any]) -> list[Piece]:
    arb, zero = flint().arb, flint().fmpq(0)
    start, end = zero, s
    if b == 0:
        return [_constant(a, s, *source)] if a > 0 else []
    if b > 0:
        start = max(start, -a / b)
    else:
        end = -a / b if end is None else min(end, -a / b)
    if end is None:
        return [Piece(None, arb.pos_inf(), *source, survived=lambda z: (-(a * z + z * z * b / 2)).exp())]
    if end <= start:
        return []
    height, length = a + b * start, end - start
    tau = height * length + b * length * length / 2
    return [Piece(length, arb(tau), *source, survived=lambda z: (-(z * height + z * z * b / 2)).exp())]


def _exponential(sigma_0: Any, e: Any, k: Any, s: Any, source: tuple[Any, Any]) -> list[Piece]:
    arb = flint().arb
    sigma = arb(e).exp() * sigma_0 if sigma_0 else flint().fmpq(0)
    if not sigma_0 or k == 0:
        return [_constant(sigma, s, *source)]
    if s is not None:
        tau = sigma * (arb(k * s).expm1() / k)
    elif k < 0:
        tau = sigma / -k
    else:
        tau = arb.pos_inf()
    return [Piece(s, tau, *source, survived=lambda z: (-(sigma * ((z * k).exp() - 1) / k)).exp())]


def _opengl(fog: OpenGLFog, origin: np.ndarray, s: Any, source: tuple[Any, Any]) -> list[Piece]:
    if not (np.asarray(origin) == fog.eye).all():
        raise UnsupportedError(f"OpenGL fog is seen from its eye {fog.eye.tolist()}: start the rays there", "ray")
    arb, density = flint().arb, rational(fog.density)
    if fog.mode == "exp" or (fog.mode == "exp2" and not density):
        return [_constant(density, s, *source)]
    if fog.mode == "exp2":
        tau = arb.pos_inf() if s is None else arb((density * s) ** 2)
        return [Piece(s, tau, *source, survived=lambda z: (-((density * z) ** 2)).exp())]
    start, end = rational(fog.start), rational(fog.end)
    if s is not None and s <= start:
        return [_constant(flint().fmpq(0), s, *source)]
    reach = end - start if s is None else min(s, end) - start
    tau = arb.pos_inf() if reach == end - start else -(1 - arb(reach) / (end - start)).log()
    foggy = Piece(reach, tau, *source, survived=lambda z: 1 - z / (end - start))
    return [_constant(flint().fmpq(0), start, *source), foggy]


def _cells(medium: Any, o: list[Any], w: list[Any], s: Any) -> list[Piece]:
    """Return what lies between consecutive crossings of all planes, each crossing an exact fraction."""
    fq = flint().fmpq
    trilinear = isinstance(medium, VoxelGrid) and medium.interpolation == "trilinear"
    if isinstance(medium, PiecewiseConstantMedium):
        axis = vector(medium.axis)
        o, w, shape = [_dot(axis, o)], [_dot(axis, w)], (len(medium.sigma_t),)
        planes = [[None if np.isinf(b) else rational(b) for b in medium.boundaries]]
    else:
        shape, lower, upper = medium.sigma_t.shape[:3], *([*map(rational, x)] for x in (medium.lower, medium.upper))
        size = [(b - a) / n for a, b, n in zip(lower, upper, shape, strict=True)]
        o, w = (
            [(x - a) / d for x, a, d in zip(o, lower, size, strict=True)],
            [x / d for x, d in zip(w, size, strict=True)],
        )
        half = fq(1, 2)
        inner = [[i + half for i in range(n)] if trilinear else [fq(i) for i in range(1, n)] for n in shape]
        planes = [[fq(0), *between, fq(n)] for between, n in zip(inner, shape, strict=True)]
    met = {fq(0)} | ({s} if s is not None else set())
    for x, d, places in zip(o, w, planes, strict=True):
        met |= {(p - x) / d for p in places if p is not None and d != 0}
    cuts: list[Any] = sorted(t for t in met if t >= 0 and (s is None or t <= s))
    ends = [*cuts[1:], None] if s is None else cuts[1:]
    found = []
    for start, end in zip(cuts, ends, strict=False):
        middle = start + 1 if end is None else (start + end) / 2
        place = [x + middle * d for x, d in zip(o, w, strict=True)]
        cell = [_cell(places, p) for places, p in zip(planes, place, strict=True)]
        if any(c is None for c in cell):
            continue
        length = None if end is None else end - start
        if trilinear:
            found.append(_trilinear(medium, [x + start * d for x, d in zip(o, w, strict=True)], w, length))
        else:
            at = [rational(a[tuple(cell)] if a.ndim else a) for a in (medium.albedo, medium.emission)]
            found.append(_constant(rational(medium.sigma_t[tuple(cell)]), length, *at))
    return found


def _cell(places: list[Any], p: Any) -> int | None:
    """Return which interval between the places holds p, closed below and open above; None stands for infinity."""
    for i, (low, high) in enumerate(pairwise(places)):
        if (low is None or low <= p) and (high is None or p < high):
            return i
    return None


def _trilinear(grid: VoxelGrid, start: list[Any], w: list[Any], length: Any) -> Piece:
    """Return the piece inside one cell between voxel centres, where every field is a cubic polynomial in z."""
    poly = flint().fmpq_poly
    sigma, albedo, emission = (
        _cubic(a, start, w, length) if a.ndim else poly([rational(a)])
        for a in (grid.sigma_t, grid.albedo, grid.emission)
    )
    integral = sigma.integral()
    tau = horner(integral)
    survived = lambda z: (-tau(z)).exp()  # noqa: E731
    return Piece(length, flint().arb(integral(length)), albedo, emission, survived=survived, extinction=sigma)


def _cubic(array: np.ndarray, start: list[Any], w: list[Any], length: Any) -> Any:
    """Return the polynomial through the exact interpolated values at four points of the piece (Newton's form)."""
    poly, fq = flint().fmpq_poly, flint().fmpq
    nodes = [length * fq(i, 3) for i in range(4)]
    table = [_interpolated(array, [x + z * d for x, d in zip(start, w, strict=True)]) for z in nodes]
    for level in range(1, 4):
        for i in range(3, level - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - level])
    result = poly([table[3]])
    for i in (2, 1, 0):
        result = result * poly([-nodes[i], 1]) + poly([table[i]])
    return result


def _interpolated(array: np.ndarray, place: list[Any]) -> Any:
    fq, axes = flint().fmpq, []
    for n, p in zip(array.shape, place, strict=True):
        above = min(max(p - fq(1, 2), fq(0)), fq(n - 1))
        low = min(int(above.floor()), max(n - 2, 0))
        axes.append([(low, 1 - (above - low)), (min(low + 1, n - 1), above - low)])
    return sum((a[1] * b[1] * c[1] * rational(array[a[0], b[0], c[0]]) for a, b, c in product(*axes)), fq(0))


def horner(poly: Any) -> Function:
    """Return a polynomial with rational coefficients as a function of balls."""
    coefficients = poly.coeffs()[::-1]

    def value(z: Any) -> Any:
        total = z * 0
        for c in coefficients:
            total = total * z + c
        return total

    return value
