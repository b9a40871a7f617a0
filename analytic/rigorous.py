"""Optical thickness, transmittance, fog and emission with enclosures proven by ball arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic.balls import Ball, flint, proven, rational, reference
from fogproof.analytic.rigorous_pieces import Piece, channel, pieces
from fogproof.analytic.thickness import channels_of
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Ray
from fogproof.validate import Channels

SOURCE = "Johansson 2017, Arb; Johansson 2018, Numerical integration in arbitrary-precision ball arithmetic"


def rigorous_thickness(medium: AnyMedium, ray: Ray) -> Reference:
    """Return tau as `optical_thickness` does, proven."""
    return _over_rays(medium, ray, channels_of(medium), lambda parts, _: _total(parts))


def rigorous_transmittance(medium: AnyMedium, ray: Ray) -> Reference:
    """Return exp(-tau) as `transmittance` does, proven."""
    return _over_rays(medium, ray, channels_of(medium), lambda parts, _: (-_total(parts)).exp())


def rigorous_radiance(
    medium: AnyMedium, ray: Ray, ambient: Channels = 0.0, background: Channels = 0.0, times_sigma_a: bool = True
) -> Reference:
    """Return the radiance at the camera as `ambient_fog` and `emitted_radiance` do, proven."""
    channels = channels_of(medium, ambient=ambient, background=background)

    def radiance(parts: list[Piece], c: int) -> Ball:
        L_i, L_bg = (rational(x[c] if isinstance(x, tuple) else x) for x in (ambient, background))
        return _composed(parts, L_i, L_bg, times_sigma_a)

    return _over_rays(medium, ray, channels, radiance)


def _composed(parts: list[Piece], ambient: Any, background: Any, times_sigma_a: bool) -> Ball:
    """Return the radiance of pieces composed from the camera on, at the current precision."""
    total, survived = flint().arb(0), flint().arb(1)
    for part in parts:
        total += survived * _gain(part, ambient, times_sigma_a)
        survived *= (-part.tau).exp()
    return total + survived * background


def _total(parts: list[Piece]) -> Ball:
    return sum((part.tau for part in parts), flint().arb(0))


def _over_rays(
    medium: AnyMedium, ray: Ray, channels: int | None, compute: Callable[[list[Piece], int], Ball]
) -> Reference:
    """Enclose `compute(pieces, channel)` for every ray and channel."""
    media = [medium] if medium.channels is None else [channel(medium, c) for c in range(medium.channels)]
    rows = zip(ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1), strict=True)

    def ball(row: tuple[np.ndarray, np.ndarray, float], c: int) -> Ball:
        return proven(lambda: compute(pieces(media[c % len(media)], *row), c))

    balls = [ball(row, c) for row in rows for c in range(channels or 1)]
    return reference(balls, ray.shape if channels is None else (*ray.shape, channels), SOURCE)


def _gain(part: Piece, ambient: Any, times_sigma_a: bool) -> Ball:
    """Return the radiance that a piece sends to its start."""
    if callable(part.albedo) or callable(part.emission):
        return _varying(part, ambient, times_sigma_a)
    gone = -(-part.tau).expm1()
    gain = gone * (part.albedo * ambient)
    if times_sigma_a:
        return gain + gone * ((1 - part.albedo) * part.emission)
    return gain + part.emission * _reach(part, gone) if part.emission else gain


def _reach(part: Piece, gone: Ball) -> Ball:
    """Return the integral of exp(-tau(z)) over a piece [m]."""
    if part.sigma is not None:
        if part.sigma:
            return gone / part.sigma
        return flint().arb.pos_inf() if part.length is None else flint().arb(part.length)
    survived = part.survived
    assert survived is not None
    return _integral(survived, part.length)


def _varying(part: Piece, ambient: Any, times_sigma_a: bool) -> Ball:
    albedo, emission = (f if callable(f) else (lambda _, f=f: f) for f in (part.albedo, part.emission))
    survived, extinction = part.survived, part.extinction
    assert survived is not None
    assert extinction is not None

    def gained(z: Any) -> Any:
        share, sigma = albedo(z), extinction(z)
        emitted = sigma * (1 - share) * emission(z) if times_sigma_a else emission(z)
        return survived(z) * (sigma * share * ambient + emitted)

    return _integral(gained, part.length)


def _integral(function: Any, length: Any) -> Ball:
    """Return the integral of an entire function over [0, length]."""
    acb = flint().acb
    if length is None:
        raise UnsupportedError("an infinite ray through a medium without end: give the ray a length", "ray")
    return acb.integral(lambda z, _: function(z), 0, acb(flint().arb(length)), abs_tol=flint().arb(0)).real
