"""The integral of sigma_t^2 along rays, which is what the variance of ratio tracking knows of a medium.

Where the square of an extinction is an extinction of the same kind (homogeneous, exponential, layers, nearest voxels,
the user's own function) it is the optical thickness of that medium. Where sigma_t is a polynomial between known breaks,
one Gauss-Legendre panel is exact; everything else is integrated adaptively.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS
from fogproof.analytic.media.adaptive import integrate_along
from fogproof.analytic.media.breakpoints import breakpoints
from fogproof.analytic.media.coefficients import ROOM, Coefficients, coefficients
from fogproof.analytic.media.thickness import thickness
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given


class Integral(NamedTuple):
    """An integral along each ray in the full shape of the result, its error, and how it was found."""

    value: np.ndarray
    error: np.ndarray
    method: str


def squared_extinction(medium: AnyMedium, ray: Ray, channels: int | None) -> Integral:
    """Return int sigma_t^2 dt along the rays [1/m], with that many channels.

    Error: a few EPS relative, plus what rounded positions mean; estimated by quadrature where a kind has no closed form.
    """
    own = given(medium, ROOM, "squared_extinction")
    if own is not None:
        found: Integral = own(medium, ray, channels)
        return found
    squared = given(medium, ROOM, "squared")
    return of_squared(squared(medium), ray, channels) if squared else _by_quadrature(medium, ray, channels)


def of_squared(squared: AnyMedium, ray: Ray, channels: int | None) -> Integral:
    """Return the thickness of a medium whose extinction is the square."""
    tau = thickness(squared, ray, channels)
    with np.errstate(invalid="ignore"):
        error = np.where(np.isfinite(tau.value), tau.error + 4 * EPS * tau.value, 0.0)
    return Integral(tau.value, error + TINY, f"thickness of the squared medium: {tau.method}")


def _by_quadrature(medium: AnyMedium, ray: Ray, channels: int | None) -> Integral:
    def square(local: Coefficients) -> np.ndarray:
        return local.sigma_t**2

    along = integrate_along(medium, ray, lambda local: np.zeros_like(local.sigma_t), channels, extinction=square)
    shape: Any = ray.shape if channels is None else (*ray.shape, channels)
    return Integral(along.tau.reshape(shape), along.tau_error.reshape(shape), "adaptive Gauss-Legendre 16")


def by_panels(medium: AnyMedium, ray: Ray, channels: int | None) -> Integral:
    """Return the integral over panels between breaks, where sigma_t is a polynomial of degree 3 at most.

    A rounded position moves sigma_t by at most what it changes between neighbouring nodes; see `adaptive`.
    """
    edges = breakpoints(medium, ray)
    width = np.diff(edges, axis=-1)[..., None]
    t = edges[:, :-1, None] + width * NODES
    origin, w = ray.origin.reshape(-1, 1, 1, 3), ray.direction.reshape(-1, 1, 1, 3)
    sigma = coefficients(medium, origin + t[..., None] * w, w, channels).sigma_t
    if channels is not None:
        width, t = width[..., None], t[..., None]
    weights = WEIGHTS if channels is None else WEIGHTS[:, None]
    terms = width * weights * sigma**2
    place = 4 * EPS * (np.abs(origin).max(initial=0.0) + np.abs(t).max(initial=0.0))
    axes = (1, 2)
    moved = np.abs(np.diff(np.square(sigma), axis=2)).sum(axis=axes) + np.square(sigma).max(axis=axes, initial=0.0)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    value = terms.sum(axis=axes)
    error = 16 * EPS * value + 2 * place * moved + TINY
    return Integral(value.reshape(shape), error.reshape(shape), "Gauss-Legendre 16 between breaks, exact")
