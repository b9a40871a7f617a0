"""The local coefficients of any medium at any point: what quadrature and the differential equation work from.

Written pointwise and without knowledge of rays, so that a closed form along a ray can be checked against them.
"""

from __future__ import annotations

from itertools import product
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from fogproof.analytic.arithmetic.budget import spend
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, Medium
from fogproof.scene.arrays import PointArray
from fogproof.scene.kinds import given
from fogproof.scene.media import AnyMediumField
from fogproof.validate import as_float_array, points, unit_vectors

ROOM = "fogproof.analytic.media"


class Coefficients(NamedTuple):
    """Coefficients at points of shape X, each X or X + (channels,).

    sigma_t   extinction coefficient [1/m]
    sigma_a   absorption coefficient [1/m], as the medium has it and not as what scattering leaves of sigma_t
    sigma_s   scattering coefficient [1/m]
    emission  L_e [W/(m^2 sr)]
    """

    sigma_t: np.ndarray
    sigma_a: np.ndarray
    sigma_s: np.ndarray
    emission: np.ndarray

    @property
    def albedo(self) -> np.ndarray:
        """sigma_s / sigma_t, 0 in vacuum."""
        return np.divide(self.sigma_s, self.sigma_t, out=np.zeros_like(self.sigma_t), where=self.sigma_t > 0)

    @property
    def mean_free_path(self) -> np.ndarray:
        """1 / sigma_t [m], inf in vacuum."""
        return np.divide(1.0, self.sigma_t, out=np.full_like(self.sigma_t, np.inf), where=self.sigma_t > 0)


class Points(NamedTuple):
    """Where coefficients are wanted, as the modules of the kinds get it.

    x, w   points and directions, X + (3,) each
    place  x with an axis for the channels, unless the result is grey
    shape  of the result, X or X + (channels,)
    """

    x: np.ndarray
    w: np.ndarray
    place: np.ndarray
    shape: tuple[int, ...]


def _as_reference(medium: AnyMedium, x: Any, w: Any, channels: int | None = None) -> Reference:
    """Return sigma_t, sigma_a, sigma_s and emission in a last axis of four.

    Error: estimated, by how much they change where x moves by 8 EPS; beside a boundary that is the step across it.
    """
    x, w = points("x", x), unit_vectors("w", w)

    def at(x: np.ndarray) -> np.ndarray:
        return np.stack(coefficients(medium, x, w, channels), axis=-1)

    value = at(x)
    error = 32 * EPS * np.where(np.isfinite(value), np.abs(value), 0.0) + TINY
    for axis, sign in product(np.eye(3), (-8, 8)):
        moved = at(x + sign * EPS * np.abs(x) * axis)
        with np.errstate(invalid="ignore"):
            error = error + np.where(moved == value, 0.0, np.abs(moved - value))
    return Reference(value, error, "the definition, pointwise", "the definition of the medium")


@quantity(
    unit="1/m, 1/m, 1/m, W/(m^2 sr)",
    convention="sigma_t, sigma_a, sigma_s and emission L_e at the point x for light along w, in the last axis",
    source="the definition of the medium",
    example={
        "medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9, "emission": 2},
        "x": [[0, 0, 0], [0, 0, 1]],
        "w": [0, 0, 1],
    },
    answer=_as_reference,
)
def coefficients(medium: AnyMediumField, x: PointArray, w: PointArray, channels: int | None = None) -> Coefficients:
    """Return the coefficients of the medium at the points x (..., 3) for light along w (..., 3), which broadcast.

    medium    what the ray crosses
    x         (..., 3) points [m]
    w         (..., 3) unit vectors along the light's way
    channels  how many channels the result has, the medium's own unless given

    Plain float64 without an error bound: a few EPS relative, plus what the rounding of x means. In vacuum around a
    medium the emission is 0.
    """
    if not isinstance(medium, AnyMedium):
        raise InvalidValueError("medium", "must be a medium", medium, "for example Medium(sigma_a, sigma_s)")
    own = given(medium, ROOM, "coefficients")
    if own is None:
        raise UnsupportedError(f"the oracle does not know the coefficients of a {type(medium).__name__}", "medium")
    x, w = np.broadcast_arrays(_vectors("x", x), _vectors("w", w))
    spend(x.size // 3)
    channels = medium.channels if channels is None else channels
    place = x if channels is None else x[..., None, :]
    shape = x.shape[:-1] if channels is None else (*x.shape[:-1], channels)
    found = own(medium, Points(x, w, place, shape))
    return Coefficients(*(np.broadcast_to(np.asarray(v, float), shape) for v in found))


def _vectors(name: str, value: Any) -> np.ndarray:
    array = as_float_array(name, value)
    if array.ndim == 0 or array.shape[-1] != 3:
        rule = "must have three coordinates in its last axis"
        raise InvalidValueError(name, rule, list(array.shape), "pass [x, y, z]")
    return array


def by_albedo(sigma_t: Any, albedo: Any, emission: Any) -> Coefficients:
    """Return the coefficients of a medium given by sigma_t and an albedo, which is exact: 1 - albedo loses nothing."""
    sigma_t = np.asarray(sigma_t, float)
    return Coefficients(sigma_t, np.subtract(1.0, albedo) * sigma_t, np.multiply(albedo, sigma_t), emission)


def shares(medium: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return sigma_s / sigma_t and sigma_a / sigma_t of a medium in which they are the same everywhere, 0 in an empty one."""
    own = given(medium, ROOM, "shares")
    if own is not None:
        found: tuple[np.ndarray, np.ndarray] = own(medium)
        return found
    return np.asarray(medium.albedo, float), np.subtract(1.0, medium.albedo)


def is_uniform(medium: Any) -> TypeGuard[Medium]:
    """Return whether all coefficients are the same everywhere, so that a shape may hold the medium and closed forms serve it."""
    return given(medium, ROOM, "uniform") is not None
