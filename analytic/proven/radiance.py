"""Optical thickness, transmittance, fog and emission with enclosures proven by ball arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.proven.balls import ProvenBall, flint, proven, rational, reference
from fogproof.analytic.proven.pieces import Piece, horner, pieces
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.media import medium_of_channel
from fogproof.validate import nonnegative_channels

SOURCE = "Johansson 2017, Arb; Johansson 2018, Numerical integration in arbitrary-precision ball arithmetic"


class Proven(NamedTuple):
    """Balls, one an element in C order, and the shape of their array."""

    balls: list[ProvenBall]
    shape: tuple[int, ...]

    def reference(self) -> Reference:
        """Return the balls rounded to float64, with bounds that contain them."""
        return reference(self.balls, self.shape, SOURCE)


def proven_thickness(medium: AnyMedium, ray: Ray) -> Proven:
    """Return tau as `optical_thickness` does."""
    return _over_rays(medium, ray, channels_of(medium), lambda parts, _: _total(parts))


def proven_transmittance(medium: AnyMedium, ray: Ray) -> Proven:
    """Return exp(-tau) as `transmittance` does."""
    return _over_rays(medium, ray, channels_of(medium), lambda parts, _: (-_total(parts)).exp())


def proven_radiance(
    medium: AnyMedium, ray: Ray, ambient: Any = 0.0, background: Any = 0.0, times_sigma_a: bool = True
) -> Proven:
    """Return the radiance at the camera as `ambient_fog` and `emitted_radiance` do."""
    ambient = nonnegative_channels("ambient", ambient, "W/(m^2 sr)")
    background = nonnegative_channels("background", background, "W/(m^2 sr)")

    def radiance(parts: list[Piece], c: int) -> ProvenBall:
        L_i, L_bg = (rational(x[c] if isinstance(x, tuple) else x) for x in (ambient, background))
        return _composed(parts, L_i, L_bg, times_sigma_a)

    return _over_rays(medium, ray, channels_of(medium, ambient=ambient, background=background), radiance)


def _composed(parts: list[Piece], ambient: Any, background: Any, times_sigma_a: bool) -> ProvenBall:
    """Return the radiance of pieces composed from the camera on, at the current precision."""
    total, survived = flint().arb(0), flint().arb(1)
    for part in parts:
        total += survived * _gain(part, ambient, times_sigma_a)
        survived *= (-part.tau).exp()
    return total + survived * background


def _total(parts: list[Piece]) -> ProvenBall:
    return sum((part.tau for part in parts), flint().arb(0))


def _over_rays(
    medium: AnyMedium, ray: Ray, channels: int | None, compute: Callable[[list[Piece], int], ProvenBall]
) -> Proven:
    """Enclose `compute(pieces, channel)` for every ray and channel."""
    if not isinstance(ray, Ray):
        raise InvalidValueError("ray", "must be a Ray", ray)
    media = [medium] if medium.channels is None else [medium_of_channel(medium, c) for c in range(medium.channels)]
    rows = zip(ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1), strict=True)

    def ball(row: tuple[np.ndarray, np.ndarray, float], c: int) -> ProvenBall:
        return proven(lambda: compute(pieces(media[c % len(media)], *row), c))

    balls = [ball(row, c) for row in rows for c in range(channels or 1)]
    return Proven(balls, ray.shape if channels is None else (*ray.shape, channels))


def _gain(part: Piece, ambient: Any, times_sigma_a: bool) -> ProvenBall:
    """Return the radiance that a piece sends to its start."""
    if part.extinction is not None:
        return _inside_a_voxel(part, ambient, times_sigma_a)
    gone = -(-part.tau).expm1()
    gain = gone * (part.albedo * ambient)
    if times_sigma_a:
        return gain + gone * ((1 - part.albedo) * part.emission)
    return gain + part.emission * _reach(part, gone) if part.emission else gain


def _reach(part: Piece, gone: ProvenBall) -> ProvenBall:
    """Return the integral of exp(-tau(z)) over a piece [m]."""
    if part.sigma is not None:
        if part.sigma:
            return gone / part.sigma
        return flint().arb.pos_inf() if part.length is None else flint().arb(part.length)
    survived = part.survived
    assert survived is not None
    return _integral(survived, part.length)


def _inside_a_voxel(part: Piece, ambient: Any, times_sigma_a: bool) -> ProvenBall:
    """Return the gain where every field is a polynomial: so is the source, exactly."""
    scattering = part.albedo * part.extinction
    emitted = (part.extinction - scattering) * part.emission if times_sigma_a else part.emission
    source = scattering * ambient + emitted
    if not source:
        return flint().arb(0)
    gained, survived = horner(source), part.survived
    assert survived is not None
    return _integral(lambda z: survived(z) * gained(z), part.length)


def _integral(function: Any, length: Any) -> ProvenBall:
    """Return the integral of an entire function over [0, length]."""
    acb = flint().acb
    if length is None:
        raise UnsupportedError("an infinite ray through a medium without end: give the ray a length", "ray")
    return acb.integral(lambda z, _: function(z), 0, acb(flint().arb(length)), abs_tol=flint().arb(0)).real
