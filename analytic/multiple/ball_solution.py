"""The scattered source in a ball under a uniform sky, as a sum of modes, and what follows from it.

The mean radiance J of a ball times r solves the transport equation of a slab of thickness 2 R, with an odd solution and
with the radiance R + mu entering at x = R: the ball without its curvature. Lengths are in mean free paths.
Source: Davison & Sykes 1957, Neutron Transport Theory, section 7.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.blocks import in_blocks
from fogproof.analytic.arithmetic.error_free import TINY
from fogproof.analytic.arithmetic.gauss_legendre import unit_rule
from fogproof.analytic.multiple.slab_modes import Modes, amplitudes

SOURCE = "Davison & Sykes 1957, Neutron Transport Theory, section 7"

FAR = 45.0
"""Mean free paths beyond which nothing is seen: exp(-45) = 3e-20."""

GRADING = 4
"""Power of the substitution at the surface, where the source goes like d ln(d) with the depth d."""

BLOCK = 64


class BallSolution(NamedTuple):
    """k (m,) and strength (m,) of S(r) = sum_j strength_j sinh(k_j r)/(k_j r cosh(k_j R)) in a ball of that radius."""

    k: np.ndarray
    strength: np.ndarray
    radius: float


def solve_ball(modes: Modes, radius: float) -> BallSolution:
    """Return the source for modes of isotropic scattering, real or complex."""
    return BallSolution(modes.k, amplitudes(modes, radius, "odd", radius + modes.mu) * modes.source[0], radius)


def source_at(ball: BallSolution, r: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return S at distances r (...) from the centre, `depth` = R - r below the surface."""
    k, r, depth = ball.k, r[..., None], depth[..., None]
    decay = np.exp(-k * depth) / (1 + np.exp(-2 * k * ball.radius))
    x = 2 * k * r
    small = np.abs(x) < 1e-5
    ratio = np.where(small, 1 - x / 2 + x * x / 6, -np.expm1(-x) / np.where(small, 1.0, x))
    return (2 * decay * ratio) @ ball.strength


def scattered_share(ball: BallSolution) -> np.ndarray:
    """Return the integral of S over the ball, in units of the power that enters it: 4/R^2 int_0^R S r^2 dr."""
    x = ball.k * ball.radius
    return 4 * ball.radius * (_x_minus_tanh(x) @ ball.strength)


def _x_minus_tanh(x: np.ndarray) -> np.ndarray:
    """Return (x - tanh x)/x^3, by a continued fraction of x coth x - 1 where it would cancel."""
    small = np.abs(x) < 2
    square = np.where(small, x * x, 1.0)
    denominator = 27.0 + 0 * square
    for odd in range(25, 1, -2):
        denominator = odd + square / denominator
    far = np.where(small, 1.0, x)
    return np.where(small, 1 / (denominator + square), (far - np.tanh(far)) / far**3)


def seen_along_chords(ball: BallSolution, impact: np.ndarray, n: int) -> np.ndarray:
    """Return what the source sends along chords at distances `impact` (v,) from the centre, (v,).

    n  nodes of a Gauss-Legendre rule on each half of the visible part of a chord
    """
    return in_blocks(lambda some: (_seen(ball, some, n),), BLOCK, impact)[0]


def _seen(ball: BallSolution, impact: np.ndarray, n: int) -> np.ndarray:
    R = ball.radius
    chord = 2 * np.sqrt((R - impact) * (R + impact))[:, None]
    reach = np.minimum(chord, FAR)
    y, w = unit_rule(n)
    graded, slope = y**GRADING, GRADING * y ** (GRADING - 1) * w
    near = reach / 2 * graded  # distance from where the ray leaves
    from_end = reach / 2 * graded  # distance from the far end of what is seen
    u = np.concatenate([near, reach - from_end], axis=1)
    left = np.concatenate([chord - near, (chord - reach) + from_end], axis=1)
    weight = np.concatenate([reach / 2 * slope, reach / 2 * slope], axis=1)
    r = np.sqrt(impact[:, None] ** 2 + ((left - u) / 2) ** 2)
    return np.sum(weight * np.exp(-u) * source_at(ball, r, u * left / np.maximum(R + r, TINY)), axis=1)


def mean_transmittance(radius: float) -> float:
    """Return the share of the light entering a ball that crosses it without collision: 2 (1 - (1 + x) e^-x)/x^2, x = 2 R."""
    x = 2 * min(radius, 1e200)  # beyond, it underflows to 0 all the same
    if x < 0.5:
        terms = [2 * (-x) ** n / (math.factorial(n) * (n + 2)) for n in range(20)]
        return math.fsum(terms)
    return -2 * (math.expm1(-x) + x * math.exp(-x)) / (x * x)
