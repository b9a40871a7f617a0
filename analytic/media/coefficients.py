"""The local coefficients of any medium at any point: what quadrature and the differential equation work from.

Written pointwise and without knowledge of rays, so that a closed form along a ray can be checked against them.
"""

from __future__ import annotations

from itertools import product
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene import (
    AnisotropicMedium,
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    VoxelGrid,
)
from fogproof.scene.arrays import PointArray
from fogproof.scene.media import AnyMediumField
from fogproof.validate import as_float_array, points, require, unit_vectors

Corners = list[tuple[tuple[np.ndarray, ...], np.ndarray]]
"""What a value in a grid is made of: (index arrays of a cell, its weight at each point)."""


class Coefficients(NamedTuple):
    """Coefficients at points of shape X, each X or X + (channels,).

    sigma_t   extinction coefficient [1/m]
    albedo    sigma_s / sigma_t
    emission  L_e [W/(m^2 sr)]
    """

    sigma_t: np.ndarray
    albedo: np.ndarray
    emission: np.ndarray

    @property
    def sigma_s(self) -> np.ndarray:
        """Scattering coefficient [1/m]."""
        return self.albedo * self.sigma_t

    @property
    def sigma_a(self) -> np.ndarray:
        """Absorption coefficient [1/m]."""
        return (1 - self.albedo) * self.sigma_t

    @property
    def mean_free_path(self) -> np.ndarray:
        """1 / sigma_t [m], inf in vacuum."""
        return np.divide(1.0, self.sigma_t, out=np.full_like(self.sigma_t, np.inf), where=self.sigma_t > 0)


def _as_reference(medium: AnyMedium, x: Any, w: Any, channels: int | None = None) -> Reference:
    """Return sigma_t, albedo and emission in a last axis of three.

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
    unit="1/m, 1, W/(m^2 sr)",
    convention="sigma_t, albedo and emission L_e at the point x for light along w, in the last axis",
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
    x, w = np.broadcast_arrays(np.asarray(x, float), np.asarray(w, float))
    channels = medium.channels if channels is None else channels
    place = x if channels is None else x[..., None, :]
    shape = x.shape[:-1] if channels is None else (*x.shape[:-1], channels)
    albedo: Any = medium.albedo
    emission: Any = medium.emission
    match medium:
        case Medium():
            sigma_t = medium.sigma_t
        case LinearMedium():
            sigma_t = np.maximum(0.0, medium.sigma_0 + np.sum(medium.gradient * place, axis=-1))
            emission = np.where(sigma_t > 0, emission, 0.0)
        case ExponentialMedium():
            sigma_t = medium.sigma_0 * np.exp(np.sum(medium.rate * place, axis=-1))
        case AnisotropicMedium():
            area = np.sqrt(np.maximum(0.0, np.einsum("...i,ij,...j", w, medium.S, w)))
            sigma_t = np.multiply(medium.sigma, area if channels is None else area[..., None])
        case OpenGLFog():
            t = np.sqrt(np.sum((place - medium.eye) ** 2, axis=-1))
            sigma_t = _fog(medium, t)
        case PiecewiseConstantMedium():
            cell, last = np.searchsorted(medium.boundaries, x @ medium.axis, side="right") - 1, len(medium.sigma_t) - 1
            corners: Corners = [((np.clip(cell, 0, last),), ((cell >= 0) & (cell <= last)).astype(float))]
            sigma_t, albedo, emission = (_gather(a, corners, shape) for a in (medium.sigma_t, albedo, emission))
        case VoxelGrid():
            corners = _corners(medium, x)
            sigma_t, albedo, emission = (_gather(a, corners, shape) for a in (medium.sigma_t, albedo, emission))
            albedo = np.minimum(albedo, medium.albedo.max())
        case Procedural():
            return _procedural(medium, x, w, shape)
    return Coefficients(*(np.broadcast_to(np.asarray(v, float), shape) for v in (sigma_t, albedo, emission)))


def _fog(medium: OpenGLFog, t: np.ndarray) -> np.ndarray:
    if medium.mode == "exp":
        return np.full_like(t, medium.density)
    if medium.mode == "exp2":
        return 2 * medium.density**2 * t
    with np.errstate(divide="ignore"):
        return np.where(t < medium.start, 0.0, np.where(t < medium.end, 1 / (medium.end - t), np.inf))


def _corners(grid: VoxelGrid, x: np.ndarray) -> Corners:
    """Return (index arrays, weights) of the voxels that make up the value at each point; no weight outside."""
    n = np.array(grid.sigma_t.shape[:3])
    c = (x - grid.lower) * (n / (grid.upper - grid.lower))
    inside = ((x >= grid.lower) & (x < grid.upper)).all(axis=-1)
    if grid.interpolation == "nearest":
        cell = np.clip(np.floor(c), 0, n - 1).astype(int)
        return [(tuple(np.moveaxis(cell, -1, 0)), inside.astype(float))]
    low = np.floor(np.clip(c, 0, n) - 0.5)
    u = np.clip(c - 0.5 - low, 0, 1)
    found: Corners = []
    for corner in product((0, 1), repeat=3):
        cell = np.clip(low + corner, 0, n - 1).astype(int)
        weight = np.prod(np.where(corner, u, 1 - u), axis=-1)
        found.append((tuple(np.moveaxis(cell, -1, 0)), inside * weight))
    return found


def _gather(array: np.ndarray, corners: Corners, shape: tuple[int, ...]) -> np.ndarray:
    """Return the weighted sum of an array's cells at the points, channels last; a constant counts inside only."""
    total = np.zeros(shape)
    for cells, weight in corners:
        found = array[cells] if array.ndim else np.broadcast_to(array, weight.shape)
        if weight.ndim < len(shape):
            weight = weight[..., None]
            found = found if found.ndim == len(shape) else found[..., None]
        total = total + found * weight
    return total


def _procedural(medium: Procedural, x: np.ndarray, w: np.ndarray, shape: tuple[int, ...]) -> Coefficients:
    inside = ((x >= medium.lower) & (x <= medium.upper)).all(axis=-1)
    sigma_t = medium.sigma_t(x, w) if medium.directional else medium.sigma_t(x)
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
    return Coefficients(*(np.broadcast_to(array, shape) for array in found))


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
