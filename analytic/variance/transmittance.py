"""Exact variance and cost of the estimators of transmittance and ambient fog.

A tracker walks along the ray in steps of an exponential distribution of rate majorant and looks sigma_t up at each
tentative collision. Delta tracking stops with probability sigma_t/majorant and scores 1 if it never does; ratio
tracking multiplies its weight by 1 - sigma_t/majorant; residual-ratio tracking by 1 - (sigma_t - control)/majorant, and
by exp(-control s) at the end. The collisions are a Poisson process, so the moments of the weight are

    E[w^p] = exp(-p int control dt - int majorant (1 - (1 - (sigma_t - control)/majorant)^p) dt).
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY, two_sum
from fogproof.analytic.arithmetic.panel_rule import NODES
from fogproof.analytic.declaration import FOG, RAY, quantity
from fogproof.analytic.geometry.rays import Thickness, channels_of, rays_with_channels
from fogproof.analytic.media.adaptive import integrate_along
from fogproof.analytic.media.breakpoints import breakpoints
from fogproof.analytic.media.coefficients import coefficients
from fogproof.analytic.rays.compositing import phi1
from fogproof.analytic.rays.transmittance import survival, thickness
from fogproof.analytic.variance.squared_extinction import squared_extinction
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, Medium, PiecewiseConstantMedium, Ray, VoxelGrid
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.media import AnyMediumField
from fogproof.validate import Channels, nonnegative_channels, require

Tracking = Literal["delta", "ratio", "residual-ratio"]
"""Trackers of transmittance. "delta" has the variance of every estimator that scores 0 or 1."""

SOURCE = "Novak, Selle & Jarosz 2014, Residual ratio tracking; moments of a Poisson process (Campbell 1909)"


@quantity(
    unit="1",
    convention="mean square of one realisation of a tracker's estimate",
    source="Novak, Selle & Jarosz 2014, Residual ratio tracking; Campbell 1909",
    example={
        "medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9},
        "ray": {**RAY, "length": 5},
        "tracking": "residual-ratio",
        "majorant": 2,
        "control": 0.5,
    },
)
def transmittance_second_moment(
    medium: AnyMediumField, ray: Ray, tracking: Tracking, majorant: ChannelArray = None, control: ChannelArray = 0.0
) -> Reference:
    """Return E[w^2] of a tracker's estimate w of the transmittance, shape R or R + (channels,).

    tracking  "delta", "ratio" or "residual-ratio"
    majorant  rate of the tentative collisions [1/m], grey or one value a channel; with delta tracking it must not lie
              below sigma_t and has no influence; ratio tracking is unbiased for every majorant > 0
    control   control extinction of residual-ratio tracking [1/m], which holds along the whole ray, vacuum included

    Error: a few EPS relative and what the integrals of sigma_t and sigma_t^2 inherit; estimated for a user's function.
    """
    return _second(_moments(medium, ray, tracking, majorant, control))


@quantity(
    unit="1",
    convention="variance of one realisation of a tracker's estimate",
    source="Novak, Selle & Jarosz 2014, Residual ratio tracking; Campbell 1909",
    example={
        "medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9},
        "ray": {**RAY, "length": 5},
        "tracking": "ratio",
        "majorant": 2,
    },
)
def transmittance_variance(
    medium: AnyMediumField, ray: Ray, tracking: Tracking, majorant: ChannelArray = None, control: ChannelArray = 0.0
) -> Reference:
    """Return Var[w] = E[w^2] - T^2 of one realisation.

    Arguments, shape and error as in `transmittance_second_moment`.

    Nothing cancels: delta T (1 - T), ratio T^2 (exp(V) - 1) with V = int (sigma_t - control)^2/majorant dt.
    """
    m = _moments(medium, ray, tracking, majorant, control)
    with np.errstate(all="ignore"):
        if m.V is None:
            value, rounding, inherited = survival(m.tau)
            lost = -np.expm1(-m.tau.value)
            error = (2 * ELEMENTARY + 4 * EPS) * value * lost + (rounding + 2 * inherited) * lost + value * m.tau.error
            return Reference(value * lost, error + TINY, f"T (1 - T), {m.tau.method}", SOURCE)
        second = _second(m)
        share = -np.expm1(-m.V)
        value = np.where(share > 0, second.value * share, 0.0)
        error = second.error * share + second.value * (np.exp(-m.V) * m.V_error + (ELEMENTARY + EPS) * share) + TINY
    return Reference(value, np.where(np.isfinite(value), error, 0.0), f"T^2 (exp(V) - 1), {m.method}", SOURCE)


@quantity(
    unit="1",
    convention="expected look-ups of the medium in one realisation",
    source="Novak, Selle & Jarosz 2014, Residual ratio tracking; Campbell 1909",
    example={"medium": FOG, "ray": RAY, "tracking": "delta", "majorant": 2},
)
def transmittance_lookups(
    medium: AnyMediumField, ray: Ray, tracking: Tracking, majorant: ChannelArray, control: ChannelArray = 0.0
) -> Reference:
    """Return the expected number of look-ups of sigma_t of one realisation, shape R or R + (channels,).

    Delta tracking stops at its first real collision: int majorant T dt. The others go on to the end: int majorant dt.
    Arguments as for `transmittance_second_moment`. Error: a few EPS relative; delta in a heterogeneous medium, estimated.
    """
    channels = channels_of(medium, majorant=_majorant(majorant))
    _moments(medium, ray, tracking, majorant, control)  # checks the arguments
    rate = np.asarray(_majorant(majorant), float)
    length = rays_with_channels(ray, channels).length
    shape = ray.shape if channels is None else (*ray.shape, channels)
    with np.errstate(all="ignore"):
        if tracking != "delta":
            value, error, method = rate * length, EPS * rate * length, "majorant times length"
        elif isinstance(medium, Medium):
            tau, sigma = thickness(medium, ray, channels), np.asarray(medium.sigma_t)
            value = np.where(tau.value < 1, rate * length * phi1(tau.value), -np.expm1(-tau.value) * rate / sigma)
            error, method = (2 * ELEMENTARY + 6 * EPS) * value, "majorant (1 - T)/sigma_t"
        else:
            along = integrate_along(medium, ray, lambda local: np.broadcast_to(rate, local.sigma_t.shape), channels)
            value, error = along.gain.reshape(shape), along.gain_error.reshape(shape)
            method = "adaptive Gauss-Legendre 16 of the transmittance"
        error = np.where(np.isfinite(value), error, 0.0) + TINY
    return Reference(np.broadcast_to(value, shape), np.broadcast_to(error, shape), method, SOURCE)


@quantity(
    unit="(W/(m^2 sr))^2",
    convention="variance of one analog free path",
    source="elementary: a sample of two values",
    example={"medium": FOG, "ray": RAY, "ambient": 1, "background": 3},
)
def ambient_fog_variance(
    medium: AnyMediumField, ray: Ray, ambient: ChannelArray = 0.0, background: ChannelArray = 0.0
) -> Reference:
    """Return the variance of ambient fog by analog free paths [(W/(m^2 sr))^2], shape R or R + (channels,).

        (albedo L_i + (1 - albedo) L_e - L_bg)^2 T (1 - T)

    ambient, background  as for `ambient_fog`. A path that collides scores the source, one that does not the background:
    two values, if albedo and emission are the same everywhere; other media are refused.
    """
    ambient = nonnegative_channels("ambient", ambient, "W/(m^2 sr)")
    background = nonnegative_channels("background", background, "W/(m^2 sr)")
    channels = channels_of(medium, ambient=ambient, background=background)
    if isinstance(medium, PiecewiseConstantMedium | VoxelGrid):
        varies = medium.albedo.ndim + medium.emission.ndim > 0
    else:
        varies = callable(medium.albedo) or callable(medium.emission)
    if varies:
        raise UnsupportedError(
            "the variance of fog needs an albedo and an emission that are constant in space", "medium"
        )
    tau = thickness(medium, ray, channels)
    with np.errstate(all="ignore"):
        survived, rounding, inherited = survival(tau)
        lost = -np.expm1(-tau.value)
        albedo = np.asarray(medium.albedo)
        absorbed = np.divide(medium.sigma_a, medium.sigma_t) if isinstance(medium, Medium) else 1 - albedo
        source = np.where(tau.value > 0, albedo * ambient + absorbed * medium.emission, 0.0)
        contrast = source - background
        off = 4 * EPS * source + EPS * np.abs(contrast)
        value = contrast * contrast * survived * lost
        spread = (2 * ELEMENTARY + 6 * EPS) * survived * lost + (rounding + 2 * inherited) * lost + survived * tau.error
        error = contrast * contrast * spread + (2 * np.abs(contrast) + off) * off * survived * lost + TINY
    return Reference(value, error, f"two values with probabilities T and 1 - T, {tau.method}", SOURCE)


class _Moments(NamedTuple):
    """tau and V = int (sigma_t - control)^2/majorant dt, which is None for delta tracking."""

    tau: Thickness
    V: np.ndarray | None
    V_error: Any
    growth: Any
    method: str


def _second(m: _Moments) -> Reference:
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


def _moments(medium: AnyMedium, ray: Ray, tracking: Tracking, majorant: Any, control: Any) -> _Moments:
    if tracking not in get_args(Tracking):
        raise InvalidValueError("tracking", f"must be one of {', '.join(get_args(Tracking))}", tracking)
    control = nonnegative_channels("control", control, "1/m")
    if tracking != "residual-ratio" and np.any(control):
        raise InvalidValueError("control", f"must be 0 for {tracking} tracking", control, "use 'residual-ratio'")
    if majorant is None and tracking == "delta":
        return _Moments(thickness(medium, ray, channels_of(medium)), None, 0.0, 0.0, "")
    majorant = _majorant(majorant)
    channels = channels_of(medium, majorant=majorant, control=control)
    tau = thickness(medium, ray, channels)
    mu, c = np.asarray(majorant, float), np.asarray(control, float)
    if tracking == "delta":
        _require_bound(medium, ray, mu, channels)
        return _Moments(tau, None, 0.0, 0.0, "")
    length = rays_with_channels(ray, channels).length
    with np.errstate(all="ignore"):
        if isinstance(medium, Medium):
            sigma, sigma_low = two_sum(medium.sigma_a, medium.sigma_s)
            off = (sigma - c) + sigma_low
            V = np.broadcast_to(np.where(off == 0, 0.0, off * (off * length) / mu), tau.value.shape)
            # On an infinite ray both V and tau are infinite; what counts is the sign of the rate of V - 2 tau.
            rate = off * off / mu - 2 * sigma
            growth = np.where(rate == 0, 0.0, rate * np.inf)
            return _Moments(tau, V, np.where(np.isfinite(V), 4 * EPS * V, 0.0), growth, "closed form")
        square = squared_extinction(medium, ray, channels)
        if not (np.isfinite(square.value) & np.isfinite(tau.value)).all():
            raise UnsupportedError("the integral of sigma_t^2 along the ray is infinite: shorten the ray", "ray")
        V = np.maximum(square.value - 2 * c * tau.value + np.where(c > 0, c * c * length, 0.0), 0.0) / mu
        size = square.value + 2 * c * tau.value + np.where(c > 0, c * c * length, 0.0)
        V_error = (square.error + 2 * c * tau.error + 6 * EPS * size) / mu
        return _Moments(tau, V, V_error, np.nan, square.method)


def _majorant(majorant: Any) -> Channels:
    majorant = nonnegative_channels("majorant", majorant, "1/m")
    require(
        "majorant", np.asarray(majorant), np.asarray(majorant) > 0, "must be > 0 [1/m]", "no collision ever happens"
    )
    return majorant


def _require_bound(medium: AnyMedium, ray: Ray, majorant: np.ndarray, channels: int | None) -> None:
    """Refuse a majorant below sigma_t, wherever 16 nodes between the medium's breaks along the rays see it."""
    if isinstance(medium, Medium):
        highest = np.asarray(medium.sigma_t)
    else:
        edges = breakpoints(medium, ray)
        t = edges[:, :-1, None] + np.diff(edges, axis=-1)[..., None] * NODES
        origin, w = ray.origin.reshape(-1, 1, 1, 3), ray.direction.reshape(-1, 1, 1, 3)
        highest = coefficients(medium, origin + t[..., None] * w, w, channels).sigma_t.max(axis=(0, 1, 2), initial=0.0)
    if not (highest <= majorant * (1 + 1e-12)).all():
        rule = f"must not lie below sigma_t, which reaches {np.max(highest):g} [1/m]"
        raise InvalidValueError("majorant", rule, majorant, "delta tracking is biased there; ratio tracking is not")
