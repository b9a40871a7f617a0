"""Exact variance and cost of the estimators of transmittance: the quantities, by the moments of a Poisson process."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.declaration import FOG, RAY, quantity
from fogproof.analytic.geometry.rays import channels_of, rays_with_channels
from fogproof.analytic.media.adaptive import integrate_along
from fogproof.analytic.media.breakpoints import extent
from fogproof.analytic.media.coefficients import ROOM
from fogproof.analytic.media.thickness import survival, thickness
from fogproof.analytic.rays.compositing import phi1
from fogproof.analytic.variance.tracking import (
    SOURCE,
    Stretch,
    Tracking,
    checked_majorant,
    second_moment,
    tracked_stretch,
    tracker_moments,
)
from fogproof.contracts import Reference
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.kinds import given
from fogproof.scene.media import AnyMediumField


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
    return second_moment(tracker_moments(medium, ray, tracking, majorant, control))


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
    m = tracker_moments(medium, ray, tracking, majorant, control)
    with np.errstate(all="ignore"):
        if m.V is None:
            value, rounding, inherited = survival(m.tau)
            lost = -np.expm1(-m.tau.value)
            error = (2 * ELEMENTARY + 4 * EPS) * value * lost + (rounding + 2 * inherited) * lost + value * m.tau.error
            return Reference(value * lost, error + TINY, f"T (1 - T), {m.tau.method}", SOURCE)
        second = second_moment(m)
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
    channels = channels_of(medium, majorant=checked_majorant(majorant))
    tracker_moments(medium, ray, tracking, majorant, control)  # checks the arguments
    rate = np.asarray(checked_majorant(majorant), float)
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
