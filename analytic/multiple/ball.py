"""The ball that scatters isotropically, under a uniform sky of radiance 1: what it sends back and what a camera sees.

Lengths are in mean free paths: sigma_t times metres.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import MEAN_FREE_PATHS, quantity
from fogproof.analytic.multiple.ball_solution import (
    SOURCE,
    BallSolution,
    mean_transmittance,
    scattered_share,
    seen_along_chords,
    solve_ball,
    source_at,
)
from fogproof.analytic.multiple.isotropic_modes import isotropic_modes
from fogproof.analytic.multiple.legendre_modes import complex_legendre_modes
from fogproof.analytic.multiple.orders import taylor_coefficients
from fogproof.analytic.multiple.scattering_arguments import DEEPEST, checked_albedo, checked_count, checked_length
from fogproof.analytic.multiple.slab_modes import quadrature
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import Count, FloatArray
from fogproof.validate import require

METHOD = "discrete ordinates in the equivalent slab"

FINE, COARSE = 26, 20
"""Half the number of nodes in angle of a solution, and of the one it is compared with; chords have three times as many."""

COMPLEX = 14
"""The same for complex albedos, whose modes cost more."""

ROUNDING = 64 * EPS

FAINT = 1e-30
"""Albedo below which nothing scatters that could be seen."""

BLOCK = 4096
"""Places whose modes are in memory at the same time."""

Evaluate = Callable[[Any, BallSolution, np.ndarray, int], np.ndarray]
"""(albedo, solution, places (v,), n) -> values (v,)."""


@quantity(
    unit="1",
    convention="share of the light entering a ball that leaves it again, isotropic scattering; " + MEAN_FREE_PATHS,
    source="Davison & Sykes 1957, Neutron Transport Theory, section 7",
    example={"albedo": [0.5, 0.9, 1], "radius": 1},
)
def ball_albedo(albedo: FloatArray, radius: FloatArray) -> Reference:
    """Return the share of the light entering a ball that leaves it again, scattered or not.

    albedo  (...) single-scattering albedo in [0, 1]
    radius  (...) in mean free paths, >= 0; broadcast against the albedo

    The error is estimated from a coarser solution: about 2e-14.
    Source: Davison & Sykes 1957, Neutron Transport Theory, section 7.
    """
    c, R = np.broadcast_arrays(checked_albedo(albedo), checked_length("radius", radius))
    return _compare(c, R, np.zeros(c.shape), _albedo)


@quantity(
    unit="1",
    convention="albedo times the mean radiance under a uniform sky of radiance 1; " + MEAN_FREE_PATHS,
    source="Davison & Sykes 1957, Neutron Transport Theory, section 7",
    example={"albedo": 0.9, "radius": 1, "distance": [0, 0.5, 1]},
)
def ball_source(albedo: FloatArray, radius: FloatArray, distance: FloatArray) -> Reference:
    """Return the scattered radiance source S = albedo times the mean radiance, at a distance from the centre.

    albedo    (...) in [0, 1]
    radius    (...) in mean free paths, >= 0
    distance  (...) from the centre, in [0, radius]; all three broadcast

    Radiance grows along a ray by S per mean free path. Error: as `ball_albedo`.
    """
    c, R, r = np.broadcast_arrays(
        checked_albedo(albedo), checked_length("radius", radius), _inside("distance", distance, radius)
    )
    return _compare(c, R, r, _source)


@quantity(
    unit="1",
    convention="along a ray at that distance from the centre, under a uniform sky of radiance 1; " + MEAN_FREE_PATHS,
    source="Davison & Sykes 1957, Neutron Transport Theory, section 7",
    example={"albedo": 0.9, "radius": 1, "impact": [0, 0.5, 1]},
)
def ball_radiance(albedo: FloatArray, radius: FloatArray, impact: FloatArray) -> Reference:
    """Return the radiance along a ray that crosses the ball, background included.

    albedo  (...) in [0, 1]
    radius  (...) in mean free paths, >= 0
    impact  (...) distance of the ray's line from the centre, in [0, radius]; all three broadcast

    Error: as `ball_albedo`; the source is integrated along the chord by Gauss-Legendre quadrature.
    """
    c, R, p = np.broadcast_arrays(
        checked_albedo(albedo), checked_length("radius", radius), _inside("impact", impact, radius)
    )
    return _compare(c, R, p, _radiance)


@quantity(
    unit="1",
    convention="after n = 0 … count scatterings at albedo 1, in the last axis; " + MEAN_FREE_PATHS,
    source="Davison & Sykes 1957, Neutron Transport Theory, section 7",
    example={"radius": 1, "count": 3},
)
def ball_albedo_orders(radius: float, count: Count) -> Reference:
    """Return the share of the light that leaves a ball after n scatterings at albedo 1, n = 0 … count: (count + 1,).

    radius  in mean free paths, >= 0, one number
    count   the highest order, a whole number >= 0

    At albedo c the n-th order is c^n times that, and their sum over all n is `ball_albedo`.
    """
    R = float(_one_radius(radius))
    straight = mean_transmittance(R)
    collides = min(1 - straight + 4 * EPS, 4 * R / 3)  # 4 R / 3 is the mean chord
    return _orders(R, np.zeros(()), count, _albedo, ball_albedo, straight, collides)


@quantity(
    unit="1",
    convention="after n = 0 … count scatterings at albedo 1, in the last axis; " + MEAN_FREE_PATHS,
    source="Davison & Sykes 1957, Neutron Transport Theory, section 7",
    example={"radius": 1, "impact": [0, 0.5], "count": 3},
)
def ball_radiance_orders(radius: float, impact: FloatArray, count: Count) -> Reference:
    """Return `ball_radiance` order by order at albedo 1, n = 0 … count: (..., count + 1).

    radius  in mean free paths, >= 0, one number
    impact  (...) distance of the ray's line from the centre, in [0, radius]
    count   the highest order, a whole number >= 0
    """
    R, places = float(_one_radius(radius)), _inside("impact", impact, radius)
    chord = 2 * np.sqrt((R - places) * (R + places))
    with np.errstate(under="ignore"):
        straight, collides = np.exp(-chord), -np.expm1(-chord) * (1 + 8 * EPS)
    found = _orders(R, places, count, _radiance, lambda c, R: ball_radiance(c, R, places), straight, collides)
    error = found.error.copy()
    error[..., 0] += 4 * EPS * np.minimum(chord, 800.0) * straight + TINY
    return Reference(found.value, error, found.method, found.source)


def _inside(name: str, value: Any, radius: Any) -> np.ndarray:
    array, limit = checked_length(name, value), checked_length("radius", radius)
    try:
        array, limit = np.broadcast_arrays(array, limit)
    except ValueError:
        raise InvalidValueError(name, "must broadcast against the radius", array.shape) from None
    require(name, array, array <= limit, "must be at most the radius")
    return array


def _albedo(c: Any, ball: BallSolution, places: np.ndarray, n: int) -> np.ndarray:
    left = mean_transmittance(ball.radius) if abs(c) < FAINT else 1 - (1 - c) / c * scattered_share(ball)
    return np.full(len(places), left)


def _source(c: Any, ball: BallSolution, places: np.ndarray, n: int) -> np.ndarray:
    return in_blocks(lambda r: (source_at(ball, r, ball.radius - r),), BLOCK, places)[0]


def _radiance(c: Any, ball: BallSolution, places: np.ndarray, n: int) -> np.ndarray:
    chord = 2 * np.sqrt((ball.radius - places) * (ball.radius + places))
    return np.exp(-chord) + seen_along_chords(ball, places, 3 * n)


def _compare(c: np.ndarray, R: np.ndarray, places: np.ndarray, evaluate: Evaluate) -> Reference:
    """Return the values for every ball and place, and their errors from coarser solutions."""
    value, error = np.empty(c.shape), np.empty(c.shape)
    R, places = _at_most_deepest(R, places)
    for one_c, one_R in set(zip(c.ravel().tolist(), R.ravel().tolist(), strict=True)):
        here = (c == one_c) & (one_R == R)
        with np.errstate(under="ignore"):
            finest = _finest(one_R, places[here])
            fine, coarse = (evaluate(one_c, _solve(one_c, one_R, finest, n), places[here], n) for n in (FINE, COARSE))
        value[here], error[here] = fine, np.abs(fine - coarse) + ROUNDING
    return Reference(value, error, METHOD, SOURCE)


def _at_most_deepest(R: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return radii and places, scaled down where more of the same changes nothing."""
    scale = np.minimum(1.0, DEEPEST / np.maximum(R, 1.0))
    return np.minimum(R, DEEPEST), np.minimum(places * scale, np.minimum(R, DEEPEST))


def _solve(c: float, radius: float, finest: float, n: int) -> BallSolution:
    if c < FAINT or radius == 0:
        return BallSolution(np.ones(1), np.full(1, c), radius)
    return solve_ball(isotropic_modes(c, 1 - c, *quadrature(finest, n)), radius)


def _finest(radius: float, places: np.ndarray) -> float:
    """Return the smallest cosine that matters at these distances from the centre: of depths, and of rays grazing there."""
    depth = radius - places
    cosine = np.sqrt(depth * (radius + places)) / radius if radius > 0 else np.zeros_like(depth)
    scale = np.minimum(depth, cosine)
    return float(min(2 * radius, 10 * np.min(scale[scale > 0], initial=np.inf)))


def _one_radius(radius: Any) -> np.ndarray:
    R = checked_length("radius", radius)
    if R.ndim or R == 0:
        raise InvalidValueError("radius", "must be a single number > 0", radius)
    return R


def _orders(
    R: float, places: np.ndarray, count: int, evaluate: Evaluate, known: Any, straight: Any, collides: Any
) -> Reference:
    radius, places = _at_most_deepest(np.asarray(R), places)
    R = float(radius)
    nodes = quadrature(_finest(R, places.ravel()), COMPLEX)

    def solution(albedos: np.ndarray) -> np.ndarray:
        balls = [solve_ball(complex_legendre_modes(c, np.ones(1), *nodes), R) for c in albedos]
        found = [evaluate(c, ball, places.ravel(), COMPLEX) for c, ball in zip(albedos, balls, strict=True)]
        return np.stack(found, axis=-1).reshape(*places.shape, len(albedos))

    return taylor_coefficients(
        solution,
        checked_count("count", count),
        known=lambda c: known(c, R),
        source=SOURCE,
        first=np.asarray(straight),
        most=np.asarray(collides),
    )
