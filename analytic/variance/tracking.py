"""Moments of the estimators of transmittance by tracking.

A tracker walks along the ray in steps of an exponential distribution of rate majorant and looks sigma_t up at each
tentative collision. Delta tracking stops with probability sigma_t/majorant and scores 1 if it never does; ratio
tracking multiplies its weight by 1 - sigma_t/majorant; residual-ratio tracking by 1 - (sigma_t - control)/majorant, and
by exp(-control s) at the end, s being what lies in the medium's box. The collisions are a Poisson process, so the
moments of the weight are

    E[w^p] = exp(-p int control dt - int majorant (1 - (1 - (sigma_t - control)/majorant)^p) dt).
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY, two_sum
from fogproof.analytic.arithmetic.panel_rule import NODES
from fogproof.analytic.geometry.rays import Thickness, channels_of, rays_with_channels
from fogproof.analytic.media.breakpoints import between, breakpoints
from fogproof.analytic.media.coefficients import ROOM, coefficients
from fogproof.analytic.media.squared_extinction import squared_extinction
from fogproof.analytic.media.thickness import survival, thickness
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import box
from fogproof.validate import Channels, nonnegative_channels, require

Tracking = Literal["delta", "ratio", "residual-ratio"]
"""Trackers of transmittance. "delta" has the variance of every estimator that scores 0 or 1."""

SOURCE = "Novak, Selle & Jarosz 2014, Residual ratio tracking; moments of a Poisson process (Campbell 1909)"


class TrackerMoments(NamedTuple):
    """tau and V = int (sigma_t - control)^2/majorant dt, which is None for delta tracking."""

    tau: Thickness
    V: np.ndarray | None
    V_error: Any
    growth: Any
    method: str


def second_moment(m: TrackerMoments) -> Reference:
    """Return E[w^2] = T, or exp(V - 2 tau)."""
    with np.errstate(all="ignore"):
        if m.V is None:
            value, rounding, inherited = survival(m.tau)
            return Reference(value, rounding + inherited, f"E[w^2] = T, {m.tau.method}", SOURCE)
        power, low = two_sum(m.V, -2 * m.tau.value)
        low = low - 2 * m.tau.low
        power = np.where(np.isnan(power), m.growth, power)
        value = np.exp(power)
        value = np.where(np.isfinite(value), value + value * low, value)
        error = value * (ELEMENTARY + 2 * EPS + np.expm1(m.V_error + 2 * m.tau.error)) + 4 * TINY
    return Reference(value, np.where(np.isfinite(value), error, 0.0), f"exp(V - 2 tau), {m.method}", SOURCE)


def tracker_moments(medium: AnyMedium, ray: Ray, tracking: Tracking, majorant: Any, control: Any) -> TrackerMoments:
    """Return the moments of a tracker's estimate; its arguments are checked here."""
    if tracking not in get_args(Tracking):
        raise InvalidValueError("tracking", f"must be one of {', '.join(get_args(Tracking))}", tracking)
    control = nonnegative_channels("control", control, "1/m")
    if tracking != "residual-ratio" and np.any(control):
        raise InvalidValueError("control", f"must be 0 for {tracking} tracking", control, "use 'residual-ratio'")
    if majorant is None and tracking == "delta":
        return TrackerMoments(thickness(medium, ray, channels_of(medium)), None, 0.0, 0.0, "")
    majorant = checked_majorant(majorant)
    channels = channels_of(medium, majorant=majorant, control=control)
    tau = thickness(medium, ray, channels)
    mu, c = np.asarray(majorant, float), np.asarray(control, float)
    if tracking == "delta":
        _require_bound(medium, ray, mu, channels)
        return TrackerMoments(tau, None, 0.0, 0.0, "")
    uniform = given(medium, ROOM, "uniform")
    with np.errstate(all="ignore"):
        if uniform is not None:
            length = rays_with_channels(ray, channels).length
            sigma, sigma_low = uniform(medium)
            off = (sigma - c) + sigma_low
            V = np.broadcast_to(np.where(off == 0, 0.0, off * (off * length) / mu), tau.value.shape)
            # On an infinite ray both V and tau are infinite; what counts is the sign of the rate of V - 2 tau.
            rate = off * off / mu - 2 * sigma
            growth = np.where(rate == 0, 0.0, rate * np.inf)
            return TrackerMoments(tau, V, np.where(np.isfinite(V), 4 * EPS * V, 0.0), growth, "closed form")
        square = squared_extinction(medium, ray, channels)
        if not (np.isfinite(square.value) & np.isfinite(tau.value)).all():
            raise UnsupportedError("the integral of sigma_t^2 along the ray is infinite: shorten the ray", "ray")
        inside = tracked_stretch(medium, ray, channels)
        controlled = np.where(c > 0, c * c * inside.length, 0.0)
        V = np.maximum(square.value - 2 * c * tau.value + controlled, 0.0) / mu
        size = square.value + 2 * c * tau.value + controlled
        V_error = (square.error + 2 * c * tau.error + 6 * EPS * size + c * c * inside.error) / mu
        return TrackerMoments(tau, V, V_error, np.nan, square.method)


class Stretch(NamedTuple):
    """The part of each ray on which trackers collide, in the medium's box: ends, length and its error [m], R or R + (1,)."""

    enter: np.ndarray
    leave: np.ndarray
    length: np.ndarray
    error: np.ndarray


def tracked_stretch(medium: AnyMedium, ray: Ray, channels: int | None) -> Stretch:
    """Return where trackers walk: within the box of the medium."""
    lower, upper = box(medium)
    shape = ray.shape if channels is None else (*ray.shape, 1)
    origin, direction, length = ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), ray.length.reshape(-1)
    enter, leave = between(origin, direction, lower, upper, length)
    ends = np.where(np.isfinite(np.stack([enter, leave])), np.stack([enter, leave]), 0.0)
    cut = (enter > 0) | (leave < length)
    reach = np.max(np.abs(origin), axis=-1) + np.max(np.where(np.isfinite(lower), np.abs(lower), 0.0))
    slope = np.max(np.abs(direction), axis=-1)
    error = np.where(cut, 4 * EPS * (ends.max(axis=0) + reach / slope), 0.0)
    return Stretch(*(x.reshape(shape) for x in (enter, leave, leave - enter, error)))


def checked_majorant(majorant: Any) -> Channels:
    """Return the rate of the tentative collisions [1/m], > 0."""
    majorant = nonnegative_channels("majorant", majorant, "1/m")
    require(
        "majorant", np.asarray(majorant), np.asarray(majorant) > 0, "must be > 0 [1/m]", "no collision ever happens"
    )
    return majorant


def _require_bound(medium: AnyMedium, ray: Ray, majorant: np.ndarray, channels: int | None) -> None:
    """Refuse a majorant below sigma_t, wherever 16 nodes between the medium's breaks along the rays see it."""
    uniform = given(medium, ROOM, "uniform")
    if uniform is not None:
        highest = uniform(medium)[0]
    else:
        edges = breakpoints(medium, ray)
        t = edges[:, :-1, None] + np.diff(edges, axis=-1)[..., None] * NODES
        origin, w = ray.origin.reshape(-1, 1, 1, 3), ray.direction.reshape(-1, 1, 1, 3)
        highest = coefficients(medium, origin + t[..., None] * w, w, channels).sigma_t.max(axis=(0, 1, 2), initial=0.0)
    if not (highest <= majorant * (1 + 1e-12)).all():
        rule = f"must not lie below sigma_t, which reaches {np.max(highest):g} [1/m]"
        raise InvalidValueError("majorant", rule, majorant, "delta tracking is biased there; ratio tracking is not")
