"""Plane layers."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT
from fogproof.analytic.geometry.rays import Thickness
from fogproof.analytic.media.breakpoints import Breaks, between
from fogproof.analytic.media.cells import SOURCE, CellSegments, GridAxis, segments, settled, thickness_of, values
from fogproof.analytic.media.coefficients import Coefficients, Points, by_albedo
from fogproof.analytic.proven.balls import rational, vector
from fogproof.analytic.proven.cells import constant_cells
from fogproof.analytic.proven.pieces import Piece, dot
from fogproof.analytic.rays.compositing import composite
from fogproof.contracts import Reference
from fogproof.scene import PiecewiseConstantMedium, Ray

LINEAR_IN = ("sigma_t",)
"""What sigma_t is proportional to wherever it stands alone: sums of these with weights >= 0, at the same albedo."""


def coefficients(medium: PiecewiseConstantMedium, at: Points) -> Coefficients:
    """Return those of the layer that a point lies in."""
    layer, last = np.searchsorted(medium.boundaries, at.x @ medium.axis, side="right") - 1, len(medium.sigma_t) - 1
    inside, layer = (layer >= 0) & (layer <= last), np.clip(layer, 0, last)

    def found(array: np.ndarray) -> np.ndarray:
        value = array[layer] if array.ndim else np.broadcast_to(array, layer.shape)
        value = value[..., None] if value.ndim < len(at.shape) else value
        return np.where(inside if inside.ndim == len(at.shape) else inside[..., None], value, 0.0)

    return by_albedo(found(medium.sigma_t), found(medium.albedo), found(medium.emission))


def breakpoints(
    medium: PiecewiseConstantMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> Breaks:
    """Return where the boundaries are crossed."""
    height, rise = (origin @ medium.axis)[:, None], (direction @ medium.axis)[:, None]
    enter, leave = between(height, rise, medium.boundaries[:1], medium.boundaries[-1:], length)
    return Breaks(enter, leave, [(medium.boundaries - height) / rise])


def crossed(medium: PiecewiseConstantMedium, ray: Ray) -> Iterator[tuple[slice, CellSegments]]:
    """Yield what the flattened rays meet, in blocks; see `cells`."""
    return segments(ray, len(medium.sigma_t), partial(_axes, medium))


def _axes(medium: PiecewiseConstantMedium, origin: np.ndarray, direction: np.ndarray) -> list[GridAxis]:
    normal = [Fraction(x) for x in dd.flushed(medium.axis)]
    layers = GridAxis(dd.dot(medium.axis, origin), dd.dot(medium.axis, direction), medium.boundaries)

    def height(ray: int) -> Fraction:
        return sum((a * Fraction(x) for a, x in zip(normal, origin[ray], strict=True)), Fraction(0))

    return [settled(layers, height)]


def thickness(medium: PiecewiseConstantMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau. Error: 2^-100 relative, so that exp(-tau) sees an unrounded tau."""
    found = thickness_of(medium.sigma_t, crossed(medium, ray), values, UNIT)
    shape = ray.shape if medium.sigma_t.ndim == 1 else (*ray.shape, medium.sigma_t.shape[-1])
    value, low, error = (x.reshape(shape) for x in found)
    return Thickness(value, low, error, "sorted plane crossings", SOURCE)


def radiance(
    medium: PiecewiseConstantMedium, ray: Ray, ambient: Any, background: Any, *, times_sigma_a: bool = True
) -> Reference:
    """Return the radiance of sources that differ from layer to layer; arguments as for `radiance_by_quadrature`."""
    return composite(medium, crossed(medium, ray), ray, ambient, background, times_sigma_a=times_sigma_a)


def emission_per_volume(medium: PiecewiseConstantMedium, ray: Ray) -> Reference:
    """Return the radiance of layers that glow of themselves."""
    return radiance(medium, ray, 0.0, 0.0, times_sigma_a=False)


def squared(medium: PiecewiseConstantMedium) -> PiecewiseConstantMedium:
    """Return the medium with the extinction sigma_t^2."""
    return PiecewiseConstantMedium(medium.boundaries, medium.sigma_t**2, medium.axis)


def pieces(medium: PiecewiseConstantMedium, origin: np.ndarray, direction: np.ndarray, length: Any) -> list[Piece]:
    """Return the layers in order, their boundaries as exact fractions."""
    axis = vector(medium.axis)
    o, w = dot(axis, [rational(x) for x in origin]), dot(axis, vector(direction))
    planes = [None if np.isinf(b) else rational(b) for b in medium.boundaries]
    return constant_cells(medium, [o], [w], [planes], length)
