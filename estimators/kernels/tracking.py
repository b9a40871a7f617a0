"""Delta (Woodcock), ratio and residual ratio tracking: tentative collisions at the rate of a majorant, some of them fictitious.

Along a piece with majorant m tentative collisions are a Poisson process of rate m; the optical depth left over at its end is
carried into the next piece. Every kernel returns (sigma, limit, t) of a look-up that broke the bound, NaN if none did, and
stops there: from then on its results would be biased.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.estimators.kernels.bounds import begin, onward, piece
from fogproof.estimators.kernels.compiling import inlined, kernel
from fogproof.estimators.kernels.lattice import line_of
from fogproof.estimators.kernels.media import sigma_t

TOLERANCE = 1e-9
"""Relative excess over a bound that rounding may cause."""


@inlined
def breaks(sigma: float, control: float, majorant: float) -> bool:
    """Return whether an extinction is no number >= 0, or further from the control than the majorant allows."""
    return not (sigma >= 0.0 and abs(sigma - control) <= majorant + TOLERANCE * (majorant + control))


@kernel
def delta_tracking(
    rng: np.random.Generator,
    medium: Any,
    bound: Any,
    origin: np.ndarray,
    direction: np.ndarray,
    length: np.ndarray,
    distance: np.ndarray,
    event: np.ndarray,
    cost: np.ndarray,
) -> tuple[float, float, float]:
    """Track to the first real collision (Woodcock et al. 1965).

    origin, direction      (rays, 3); length (rays,): rays is 1, or as many as there are results
    distance, event, cost  (n,) results: where the path ends; 0 at a collision, 1 at the end of the ray; look-ups
    """
    for i in range(len(distance)):
        j = i if len(length) > 1 else 0
        line = line_of(origin, direction, j)
        at = begin(bound, line, length[j])
        depth, lookups, end, missed = rng.standard_exponential(), 0, length[j], 1
        while at.t < at.stop:
            stop, _, majorant = piece(bound, j, at)
            t = at.t
            room = majorant * (stop - t)
            while depth < room:
                t += depth / majorant
                lookups += 1
                sigma = sigma_t(medium, 0, line.ox + t * line.dx, line.oy + t * line.dy, line.oz + t * line.dz)
                if breaks(sigma, 0.0, majorant):
                    return sigma, majorant, t
                if majorant * rng.random() < sigma:
                    end, missed = min(t, stop), 0
                    break
                depth = rng.standard_exponential()
                room = majorant * (stop - t)
            if missed == 0:
                break
            depth -= room
            at = onward(bound, line, at)
        distance[i], event[i], cost[i] = end, missed, lookups
    return np.nan, np.nan, np.nan


@kernel
def ratio_tracking(
    rng: np.random.Generator,
    medium: Any,
    bound: Any,
    origin: np.ndarray,
    direction: np.ndarray,
    length: np.ndarray,
    value: np.ndarray,
    cost: np.ndarray,
) -> tuple[float, float, float]:
    """Track to the end of the ray, weighted at each tentative collision (Novák et al. 2014, eqs. 8 and 14).

    value  (n, channels) results: unbiased estimates of the transmittance
    cost   (n,) results: look-ups, of all channels at once

    The transmittance of the control is a factor known in closed form; with a control of 0 this is ratio tracking.
    """
    channels = value.shape[1]
    for i in range(len(value)):
        j = i if len(length) > 1 else 0
        line = line_of(origin, direction, j)
        at = begin(bound, line, length[j])
        depth, lookups, thickness = rng.standard_exponential(), 0, 0.0
        for c in range(channels):
            value[i, c] = 1.0
        while at.t < at.stop:
            stop, control, majorant = piece(bound, j, at)
            t = at.t
            thickness += control * (stop - t)
            room = majorant * (stop - t)
            while depth < room:
                t += depth / majorant
                lookups += 1
                for c in range(channels):
                    sigma = sigma_t(medium, c, line.ox + t * line.dx, line.oy + t * line.dy, line.oz + t * line.dz)
                    if breaks(sigma, control, majorant):
                        return sigma, control + majorant, t
                    value[i, c] *= 1.0 - (sigma - control) / majorant
                depth = rng.standard_exponential()
                room = majorant * (stop - t)
            depth -= room
            at = onward(bound, line, at)
        through = np.exp(-thickness)
        for c in range(channels):
            value[i, c] *= through
        cost[i] = lookups
    return np.nan, np.nan, np.nan


@kernel
def spectral_tracking(
    rng: np.random.Generator,
    medium: Any,
    bound: Any,
    origin: np.ndarray,
    direction: np.ndarray,
    length: np.ndarray,
    distance: np.ndarray,
    event: np.ndarray,
    weight: np.ndarray,
    cost: np.ndarray,
) -> tuple[float, float, float]:
    """Delta tracking of one channel, drawn at random, with the weights of all of them (Miller et al. 2019, section 5).

    weight  (n, channels) results: density of this path, null collisions included, in each channel, over the mean density of
            all channels: the balance heuristic, never above the number of channels
    others as in `delta_tracking`; cost counts look-ups of all channels at once
    """
    channels = weight.shape[1]
    for i in range(len(distance)):
        j = i if len(length) > 1 else 0
        line = line_of(origin, direction, j)
        at = begin(bound, line, length[j])
        depth, lookups, end, missed = rng.standard_exponential(), 0, length[j], 1
        hero = int(rng.random() * channels)
        for c in range(channels):
            weight[i, c] = 1.0
        while at.t < at.stop:
            stop, _, majorant = piece(bound, j, at)
            t = at.t
            room = majorant * (stop - t)
            while depth < room:
                t += depth / majorant
                lookups += 1
                x, y, z = line.ox + t * line.dx, line.oy + t * line.dy, line.oz + t * line.dz
                real = majorant * rng.random() < sigma_t(medium, hero, x, y, z)
                largest = 0.0
                for c in range(channels):
                    sigma = sigma_t(medium, c, x, y, z)
                    if breaks(sigma, 0.0, majorant):
                        return sigma, majorant, t
                    weight[i, c] *= sigma if real else max(0.0, majorant - sigma)
                    largest = max(largest, weight[i, c])
                for c in range(channels):
                    weight[i, c] /= largest  # only ratios matter; this keeps them from underflow
                if real:
                    end, missed = min(t, stop), 0
                    break
                depth = rng.standard_exponential()
                room = majorant * (stop - t)
            if missed == 0:
                break
            depth -= room
            at = onward(bound, line, at)
        total = 0.0
        for c in range(channels):
            total += weight[i, c]
        for c in range(channels):
            weight[i, c] *= channels / total
        distance[i], event[i], cost[i] = end, missed, lookups
    return np.nan, np.nan, np.nan


@kernel
def look_up(medium: Any, points: np.ndarray, sigma: np.ndarray) -> None:
    """Write the extinction at points (n, 3) into sigma (n, channels) [1/m]."""
    for i in range(len(points)):
        for c in range(sigma.shape[1]):
            sigma[i, c] = sigma_t(medium, c, points[i, 0], points[i, 1], points[i, 2])
