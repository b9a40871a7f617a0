"""Phase functions that vary in space, at a place."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.error_free import EPS, two_sum
from fogproof.analytic.declaration import FORWARD, quantity
from fogproof.analytic.phase.functions import phase_pdf, phase_values
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import Ramp, VaryingPhase
from fogproof.scene.arrays import FloatArray, PointArray
from fogproof.scene.kinds import given
from fogproof.scene.phase import AnyPhase, AnyPhaseField, PhaseFunction, PhaseOfMedia
from fogproof.validate import as_float_array, points, require


@quantity(
    unit="1/sr",
    convention="at the point x of a phase function that may vary in space; " + FORWARD,
    source="elementary: scattering coefficients of two populations of particles add",
    example={
        "phase": {
            "kind": "varying",
            "first": {"kind": "henyey-greenstein", "g": 0.6},
            "second": {"kind": "rayleigh"},
            "share": {"start": [0, 0, 0], "end": [0, 0, 4]},
        },
        "x": [[0, 0, 1], [0, 0, 2]],
        "mu": 0.5,
    },
)
def phase_pdf_at(phase: AnyPhaseField, x: PointArray, mu: FloatArray) -> Reference:
    """Return f_p(x, mu) [1/sr] of a phase function that may vary in space.

    phase  a phase function of the scene description, constant or varying
    x      (..., 3) points [m]
    mu     (...) forward cosines, broadcast against the points

    The value is (1 - q(x)) first(mu) + q(x) second(mu), normalised at every x because q lies in [0, 1].
    Error: that of the two phase functions, plus 4 EPS relative; what a user's function returns for q counts as exact.
    Source: elementary; scattering coefficients of two populations of particles add.
    """
    x, mu = points("x", x), as_float_array("mu", mu)
    shape = np.broadcast_shapes(x.shape[:-1], mu.shape)
    if isinstance(phase, PhaseOfMedia):
        value, error = phase_values_at(
            phase, np.broadcast_to(x, (*shape, 3)), *_either_side(np.broadcast_to(mu, shape))
        )
        return Reference(value, error, "mean by sigma_s", "elementary: scattering coefficients add")
    if not isinstance(phase, VaryingPhase):
        same = phase_pdf(phase, mu)
        value, error = np.broadcast_to(same.value, shape), np.broadcast_to(same.error, shape)
        return Reference(value, error, same.method, same.source)
    share = share_at(phase, x)
    first, second = phase_pdf(phase.first, mu), phase_pdf(phase.second, mu)
    value = (1 - share) * first.value + share * second.value
    error = (1 - share) * first.error + share * second.error + 4 * EPS * value
    if isinstance(phase.share, Ramp):
        error = error + EPS * share * np.abs(first.value - second.value)
    return Reference(value, error, f"blend of {first.method} and {second.method}", f"{first.source}; {second.source}")


def phase_components(phase: AnyPhase) -> list[PhaseFunction]:
    """Return the phase functions that a medium scatters by, in whatever proportion."""
    if isinstance(phase, PhaseOfMedia):
        return [medium.phase for medium in phase.medium.media]
    return [phase.first, phase.second] if isinstance(phase, VaryingPhase) else [phase]


def phase_values_at(
    phase: AnyPhase, points: np.ndarray, mu: np.ndarray, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return f_p and its error at points (m, 3), see `phase_values`."""
    if isinstance(phase, PhaseOfMedia):
        return _of_media(phase, points, mu, x, y)
    if not isinstance(phase, VaryingPhase):
        return phase_values(phase, mu, x, y)
    (first, first_error), (second, second_error) = (phase_values(f, mu, x, y) for f in phase_components(phase))
    q = share_at(phase, points)
    return (1 - q) * first + q * second, first_error + second_error


def _either_side(mu: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return mu, (1 - mu) / 2, (1 + mu) / 2


def _of_media(
    phase: PhaseOfMedia, points: np.ndarray, mu: np.ndarray, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean by what scatters, 0 where nothing does."""
    if phase.medium.channels is not None:
        what = "a phase function of several media that differs from channel to channel"
        raise UnsupportedError(f"{what}; ask for one channel at a time", "medium")
    scattering = np.asarray(given(phase.medium, "fogproof.analytic.media", "scattering")(phase.medium, points))
    total = scattering.sum(axis=0)
    value, error = np.zeros(total.shape), np.zeros(total.shape)
    for part, sigma_s in zip(phase_components(phase), scattering, strict=True):
        share = np.divide(sigma_s, total, out=np.zeros_like(total), where=total > 0)
        density, its_error = phase_values(part, mu, x, y)
        value, error = value + share * density, error + share * (its_error + 8 * EPS * density)
    return value, error


def share_at(phase: VaryingPhase, x: Any) -> np.ndarray:
    """Return the share q(x) in [0, 1] of the second phase function at points (..., 3) -> (...).

    A `Ramp` has (x - start) . (end - start) / |end - start|^2, cut to [0, 1], within 1 EPS relative.
    """
    x = points("x", x)
    if not isinstance(phase.share, Ramp):
        share = as_float_array("share", phase.share(x))
        if share.shape != x.shape[:-1]:
            raise InvalidValueError("share", f"must return an array of shape {list(x.shape[:-1])}", list(share.shape))
        require("share", share, (share >= 0) & (share <= 1), "must return numbers in [0, 1]")
        return share
    start, end = phase.share.start, phase.share.end
    above, whole = dd.pair(np.zeros(x.shape[:-1])), dd.pair(0.0)
    for i in range(3):
        way = two_sum(end[i], -start[i])
        above = dd.add(above, dd.times(two_sum(x[..., i], -start[i]), way))
        whole = dd.add(whole, dd.times(way, way))
    return np.clip(dd.divide(above, whole)[0], 0.0, 1.0)
