"""Exact variance and cost of the estimators of transmittance and ambient fog.

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
from fogproof.analytic.declaration import FOG, RAY, quantity
from fogproof.analytic.geometry.rays import Thickness, channels_of, rays_with_channels
from fogproof.analytic.media.adaptive import integrate_along
from fogproof.analytic.media.breakpoints import between, breakpoints, extent
from fogproof.analytic.media.coefficients import ROOM, coefficients, shares
from fogproof.analytic.media.squared_extinction import squared_extinction
from fogproof.analytic.media.thickness import survival, thickness
from fogproof.analytic.rays.compositing import phi1
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.kinds import given
from fogproof.scene.media import AnyMediumField, box, sources_vary
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
    control   control extinction of residual-ratio tracking [1/m], which holds wherever the medium's box is, vacuum in it included

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

    A tracker looks at its tentative collisions, which happen wherever the medium's box is (`lower` to `upper`, everywhere for
    kinds without one), in the vacuum around layers too. Delta tracking stops at its first real collision: int majorant T dt
    over the part of the ray in the box. The others go on to the end: int majorant dt.
    Arguments as for `transmittance_second_moment`. Error: a few EPS relative; delta in a heterogeneous medium, estimated.
    """
    channels = channels_of(medium, majorant=_majorant(majorant))
    _moments(medium, ray, tracking, majorant, control)  # checks the arguments
    rate = np.asarray(_majorant(majorant), float)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    uniform = given(medium, ROOM, "uniform")
    with np.errstate(all="ignore"):
        inside = tracked_stretch(medium, ray, channels)
        if tracking != "delta":
            value = np.where(inside.length > 0, rate * inside.length, 0.0)
            error, method = EPS * value + rate * inside.error, "majorant times length"
        elif uniform is not None:
            tau, sigma = thickness(medium, ray, channels), uniform(medium)[0]
            length = rays_with_channels(ray, channels).length
            value = np.where(tau.value < 1, rate * length * phi1(tau.value), -np.expm1(-tau.value) * rate / sigma)
            error, method = (2 * ELEMENTARY + 6 * EPS) * value, "majorant (1 - T)/sigma_t"
        else:
            value, error = _delta_lookups(medium, ray, rate, channels, inside)
            method = "adaptive Gauss-Legendre 16 of the transmittance"
        error = np.where(np.isfinite(value), error, 0.0) + TINY
    return Reference(np.broadcast_to(value, shape), np.broadcast_to(error, shape), method, SOURCE)


def _delta_lookups(
    medium: AnyMedium, ray: Ray, rate: np.ndarray, channels: int | None, inside: Stretch
) -> tuple[np.ndarray, np.ndarray]:
    """Return int rate T dt over the stretch of each ray in the box, vacuum before and behind the medium included."""
    shape = ray.shape if channels is None else (*ray.shape, channels)
    along = integrate_along(medium, ray, lambda local: np.broadcast_to(rate, local.sigma_t.shape), channels)
    tau, tau_error, gain, gain_error = (x.reshape(shape) for x in along)
    enter, leave = (x.reshape(inside.enter.shape) for x in extent(medium, ray)[:2])
    met = leave > enter
    before = np.where(met, np.maximum(enter - inside.enter, 0.0), inside.length)
    behind = np.where(met, np.maximum(inside.leave - leave, 0.0), 0.0)
    after = np.where(behind > 0, np.exp(-tau) * behind, 0.0)
    value = gain + rate * (before + after)
    error = gain_error + rate * (after * np.expm1(tau_error) + 2 * inside.error) + 8 * EPS * value
    return value, error


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
    if sources_vary(medium):
        raise UnsupportedError(
            "the variance of fog needs an albedo and an emission that are constant in space", "medium"
        )
    tau = thickness(medium, ray, channels)
    with np.errstate(all="ignore"):
        survived, rounding, inherited = survival(tau)
        lost = -np.expm1(-tau.value)
        scattered, absorbed = shares(medium)
        source = np.multiply(scattered, ambient) + np.multiply(absorbed, medium.emission)
        source = np.where(tau.value > 0, source, 0.0)
        contrast = source - background
        off = 4 * EPS * source + EPS * np.abs(contrast)
        chance = survived * lost
        value = np.where(chance > 0, contrast * contrast * chance, 0.0)
        spread = (2 * ELEMENTARY + 6 * EPS) * survived * lost + (rounding + 2 * inherited) * lost + survived * tau.error
        error = np.where(spread > 0, contrast * contrast * spread, 0.0) + TINY
        error = error + np.where(chance > 0, (2 * np.abs(contrast) + off) * off * chance, 0.0)
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
            return _Moments(tau, V, np.where(np.isfinite(V), 4 * EPS * V, 0.0), growth, "closed form")
        square = squared_extinction(medium, ray, channels)
        if not (np.isfinite(square.value) & np.isfinite(tau.value)).all():
            raise UnsupportedError("the integral of sigma_t^2 along the ray is infinite: shorten the ray", "ray")
        inside = tracked_stretch(medium, ray, channels)
        controlled = np.where(c > 0, c * c * inside.length, 0.0)
        V = np.maximum(square.value - 2 * c * tau.value + controlled, 0.0) / mu
        size = square.value + 2 * c * tau.value + controlled
        V_error = (square.error + 2 * c * tau.error + 6 * EPS * size + c * c * inside.error) / mu
        return _Moments(tau, V, V_error, np.nan, square.method)


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


def _majorant(majorant: Any) -> Channels:
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
