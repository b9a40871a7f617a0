"""A medium given by the user's own function: everything by quadrature, and nothing can be proven."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.analytic.geometry.rays import Thickness
from fogproof.analytic.media.adaptive import thickness_by_quadrature
from fogproof.analytic.media.breakpoints import extent
from fogproof.analytic.media.coefficients import Coefficients, Points, by_albedo
from fogproof.analytic.proven.pieces import Piece
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import Procedural, Ray
from fogproof.validate import as_float_array, require


def coefficients(medium: Procedural, at: Points) -> Coefficients:
    """Return what the user's functions say, held to their promises."""
    x, shape = at.x, at.shape
    inside = ((x >= medium.lower) & (x <= medium.upper)).all(axis=-1)
    sigma_t = medium.sigma_t(x, at.w) if medium.directional else medium.sigma_t(x)
    own = x.shape[:-1] if medium.channels is None else (*x.shape[:-1], medium.channels)
    rule = f"must return numbers in [0, majorant = {medium.majorant:g}]"
    sigma_t = _checked("sigma_t", sigma_t, own, medium.majorant * (1 + 1e-12), rule, inside)
    albedo: Any = medium.albedo
    emission: Any = medium.emission
    if callable(albedo):
        albedo = _checked("albedo", albedo(x), own, 1.0, "must return numbers in [0, 1]", inside)
    if callable(emission):
        emission = _checked("emission", emission(x), own, np.inf, "must return numbers >= 0", inside)
    found = []
    for value in (sigma_t, albedo, emission):
        array = np.asarray(value, float)
        if len(shape) > len(own) and array.ndim == len(own):
            array = array[..., None]
        found.append(np.where(inside if len(shape) == inside.ndim else inside[..., None], array, 0.0))
    return by_albedo(*found)


def _checked(
    name: str, value: Any, shape: tuple[int, ...], high: float, rule: str, inside: np.ndarray | None = None
) -> np.ndarray:
    """Return what a user's function gave at points that are inside, or say what is wrong with it."""
    array = as_float_array(name, value)
    if array.shape != shape:
        raise InvalidValueError(name, f"must return an array of shape {list(shape)}", list(array.shape))
    good = np.isfinite(array) & (array >= 0) & (array <= high)
    if inside is not None:
        good |= ~inside if len(shape) == inside.ndim else ~inside[..., None]
    require(name, array, good, rule)
    return array


def thickness(medium: Procedural, ray: Ray, channels: int | None) -> Thickness:
    """Return tau by quadrature.

    Without a `detail` nobody knows what lies between the nodes. If all of them saw vacuum, that says nothing: the error is then
    what the majorant allows.
    """
    found = thickness_by_quadrature(medium, ray, channels)
    if np.isfinite(medium.detail):
        return found
    enter, leave, _ = extent(medium, ray)
    most = medium.majorant * (leave - enter).reshape(ray.shape)
    most = np.broadcast_to(most if channels is None else most[..., None], found.value.shape)
    return found._replace(error=np.where(found.value == 0, most + found.error, found.error))


def squared(medium: Procedural) -> Procedural:
    """Return the medium with the extinction sigma_t^2."""
    given = medium.sigma_t
    return replace(
        medium, sigma_t=lambda *x: np.square(given(*x)), majorant=medium.majorant**2, albedo=0.0, emission=0.0
    )


def pieces(medium: Procedural, origin: np.ndarray, direction: np.ndarray, length: Any) -> list[Piece]:
    """Say that a function from outside can be anything between the points at which it is asked."""
    raise UnsupportedError("nothing can be proven about a user's function: ask without rigorous=True", "medium")
