"""A sum of Gaussian puffs: along a ray each is a Gaussian of the distance, and its optical thickness a difference of erfs.

With t counted from the place nearest to a centre, at distance p from it,

    tau = density exp(-p^2/(2 w^2)) w sqrt(pi/2) (erf(b/(w sqrt 2)) - erf(a/(w sqrt 2))).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS
from fogproof.analytic.geometry.rays import Thickness
from fogproof.analytic.media.breakpoints import Breaks
from fogproof.analytic.media.coefficients import Coefficients, Points, by_albedo
from fogproof.analytic.proven.balls import ProvenBall, flint, rational, vector
from fogproof.analytic.proven.pieces import Piece, dot
from fogproof.scene import Ray
from fogproof.scene.media.gaussian_puffs import GaussianPuffs

SOURCE = "elementary: the integral of a Gaussian (Abramowitz & Stegun 1964, eq. 7.1.1)"

VANISHES = 39.0
"""Widths from a centre beyond which exp(-x^2/2) underflows to 0."""

NEAR = 0.5
"""An interval of erf shorter than this is integrated by quadrature, a longer one subtracted without loss."""


def coefficients(medium: GaussianPuffs, at: Points) -> Coefficients:
    """Return the sum at points and what belongs to it."""
    offset = at.x[..., None, :] - medium.centers
    with np.errstate(under="ignore"):
        exponent = np.sum(offset**2, axis=-1) / (2 * medium.widths**2)
        sigma_t = np.sum(medium.densities * np.exp(-exponent), axis=-1)
    return by_albedo(sigma_t if len(at.shape) == sigma_t.ndim else sigma_t[..., None], medium.albedo, medium.emission)


class Passed(NamedTuple):
    """How rays pass puffs, (rays, puffs) each: distance of the nearest point from the camera and from the centre, and slack [m]."""

    nearest: np.ndarray
    p: np.ndarray
    slack: np.ndarray


def _passed(medium: GaussianPuffs, origin: np.ndarray, direction: np.ndarray) -> Passed:
    offset = medium.centers - origin[:, None, :]
    nearest = np.sum(offset * direction[:, None, :], axis=-1)
    p = np.linalg.norm(offset - nearest[..., None] * direction[:, None, :], axis=-1)
    size = np.abs(origin).max(axis=-1)[:, None] + np.abs(medium.centers).max(axis=-1)
    return Passed(nearest, p, 16 * EPS * (size + np.abs(nearest)))


def breakpoints(medium: GaussianPuffs, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> Breaks:
    """Return the widths that a quadrature should know of, and where every puff has vanished."""
    nearest, p, _ = _passed(medium, origin, direction)
    reach = np.sqrt(np.maximum((VANISHES * medium.widths) ** 2 - p**2, 0.0))
    enter = np.clip((nearest - reach).min(axis=-1), 0.0, length)
    leave = np.clip((nearest + reach).max(axis=-1), 0.0, length)
    found = [nearest + step * medium.widths for step in (-8, -4, -2, 0, 2, 4, 8)]
    return Breaks(np.where(leave > enter, enter, 0.0), np.where(leave > enter, leave, 0.0), found)


def thickness(medium: GaussianPuffs, ray: Ray, channels: int | None) -> Thickness:
    """Return tau of the sum.

    Error: 24 EPS relative of each puff, and what the rounding of the coordinates means for the distance p and both ends.
    """
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)
    nearest, p, slack = _passed(medium, origin, direction)
    w = medium.widths
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        low, high = -nearest / (np.sqrt(2) * w), (length[:, None] - nearest) / (np.sqrt(2) * w)
        exponent = p * p / (2 * w * w)
        peak = medium.densities * np.exp(-exponent) * w * np.sqrt(np.pi / 2)
        width = length[:, None] / (np.sqrt(2) * w)
        share = _between(low, high, width)
        value = peak * share
        moved = slack / w
        bend = np.expm1(moved * (p / w + moved) + 4 * EPS * exponent)
        # Both ends are moved alike: each by what is there, and a short way by no more than its slope.
        ends = 2 * moved * sum(np.exp(-(np.maximum(np.abs(u) - moved, 0.0) ** 2)) for u in (low, high))
        slope = share * np.expm1(2 * moved * (np.maximum(np.abs(low), np.abs(high)) + moved))
        error = value * (4 * ELEMENTARY + 8 * EPS + bend) + peak * (1 + bend) * np.fmin(np.fmin(ends, slope), 2.0)
        tau, error = value.sum(axis=-1), error.sum(axis=-1) + len(w) * (EPS * value.sum(axis=-1) + 4 * TINY)
    shape = ray.shape if channels is None else (*ray.shape, 1)
    tau, error = tau.reshape(shape), error.reshape(shape)
    return Thickness(tau, np.zeros(shape), error, "erf of each puff", SOURCE)


def _between(low: np.ndarray, high: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Return erf(high) - erf(low) for high = low + width without cancellation."""
    from scipy.special import erf, erfc

    one_side = (low > 0) | (high < 0)
    near, far = np.where(low > 0, low, -high), np.where(low > 0, high, -low)  # both > 0 on one side
    apart = np.where(one_side, erfc(near) - erfc(far), erf(np.maximum(high, 0.0)) + erf(np.maximum(-low, 0.0)))
    close = width < NEAR
    narrow = np.where(close, width, 0.0)
    nodes = np.where(close, low, 0.0)[..., None] + narrow[..., None] * NODES
    return np.where(close, 2 / np.sqrt(np.pi) * narrow * (np.exp(-(nodes**2)) @ WEIGHTS), apart)


def pieces(medium: GaussianPuffs, origin: np.ndarray, direction: np.ndarray, length: Any) -> list[Piece]:
    """Return the one piece of the ray; the direction counts as stored, not as a unit vector."""
    arb, o, d = flint().arb, [rational(x) for x in origin], vector(direction)
    square, puffs = dot(d, d), []
    for center, w, density in zip(medium.centers, medium.widths, medium.densities, strict=True):
        offset = [rational(c) - x for c, x in zip(center, o, strict=True)]
        along = dot(offset, d) / square
        p2, w2 = dot(offset, offset) - along * along * square, rational(w) ** 2
        puffs.append((along, p2 / (2 * w2), square / (2 * w2), rational(density)))

    def tau(z: Any) -> ProvenBall:
        total = z * 0
        for along, exponent, steep, density in puffs:
            root = arb(steep).sqrt()
            peak = arb(-exponent).exp() * arb(density) * arb.pi().sqrt() / 2 / root
            total += peak * (((z - arb(along)) * root).erf() + (arb(along) * root).erf())
        return total

    def endless() -> ProvenBall:
        total = arb(0)
        for along, exponent, steep, density in puffs:
            root = arb(steep).sqrt()
            peak = arb(-exponent).exp() * arb(density) * arb.pi().sqrt() / 2 / root
            total += peak * (1 + (arb(along) * root).erf())
        return total

    source = rational(medium.albedo), rational(medium.emission)
    return [
        Piece(
            length, tau(arb(length)) if length is not None else endless(), *source, survived=lambda z: (-tau(z)).exp()
        )
    ]
