"""Several media in one for trackers and path tracers."""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.free_paths import extinction as closed_forms
from fogproof.estimators.kernels.path_data import BOX, Region
from fogproof.estimators.media import ROOM
from fogproof.estimators.media.sources import sources_at
from fogproof.estimators.tracking.medium_data import look_ups, medium_data
from fogproof.scene import Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import CompositeMedium, box
from fogproof.scene.shapes import EVERYWHERE, Box, Shape

SHAPES = "fogproof.estimators.shapes"


def kernel_data(medium: CompositeMedium) -> Any:
    """Return the media for kernels as a chain of pairs; None if one of them is an array function or its sources vary."""
    from fogproof.estimators.kernels.composites import PairData, PartData

    channels, parts = medium.channels or 1, []
    for one, shape in zip(medium.media, medium.shapes, strict=True):
        data = medium_data(one)
        if data is None or getattr(one, "sources_vary", False):
            return None
        if one.channels is None and channels > 1:
            raise UnsupportedError("media in kernels must have channels all of them, or none", "medium.media")
        albedo, emission = (np.array(np.broadcast_to(x, channels), float) for x in (one.albedo, one.emission))
        region = given(shape, SHAPES, "region")(shape)
        parts.append(
            PartData(data, region, Region(BOX, *(float(x) for pair in _corners(one) for x in pair)), albedo, emission)
        )
    exclusive = medium.overlap == "first"
    return reduce(lambda rest, part: PairData(part, rest, exclusive), reversed(parts))


kernel_sources = kernel_data
"""Kernels know albedo and emission at a place."""


Corner = tuple[float, float, float]


def _corners(medium: Any) -> tuple[Corner, Corner]:
    (a, b, c), (d, e, f) = (corner.tolist() for corner in box(medium))
    return (a, b, c), (d, e, f)


def extinction(medium: CompositeMedium, x: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return the sum at points x along w, (k, channels) [1/m]."""
    total = np.zeros((len(x), medium.channels or 1))
    for here, one in zip(_counted(medium, x), medium.media, strict=True):
        total[here] += look_ups(one)(x[here], w[here])
    return total


def _counted(medium: CompositeMedium, x: np.ndarray) -> list[np.ndarray]:
    """Return at which points (n, 3) each of the media counts."""
    counted, taken = [], np.zeros(len(x), bool)
    up = np.tile(np.array([[0.0], [0.0], [1.0]]), len(x))
    for one, shape in zip(medium.media, medium.shapes, strict=True):
        enter, leave = given(shape, SHAPES, "through")(shape, x.T, up)
        lower, upper = box(one)
        inside = (enter <= 0) & (leave > 0) & ((x >= lower) & (x < upper)).all(axis=1)
        counted.append(inside & ~taken)
        if medium.overlap == "first":
            taken |= inside
    return counted


def scattering(medium: CompositeMedium, x: np.ndarray) -> list[np.ndarray]:
    """Return sigma_s of each of the media at points x (n, 3), (n,) each [1/m]; grey."""
    found = []
    w = np.tile([0.0, 0.0, 1.0], (len(x), 1))
    for here, one in zip(_counted(medium, x), medium.media, strict=True):
        sigma_s = np.zeros(len(x))
        sigma_s[here] = look_ups(one)(x[here], w[here])[:, 0] * sources_at(one, x[here])[0]
        found.append(sigma_s)
    return found


def depth(medium: CompositeMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the optical depth to the distances t, (n, channels), piece by piece between the ends of shapes and media."""
    ends = [np.zeros(1)]
    x, w = ray.origin[:, None], ray.direction[:, None]
    for one, shape in zip(medium.media, medium.shapes, strict=True):
        lower, upper = _corners(one)
        limits = Box(lower, upper) if np.isfinite([lower, upper]).all() else EVERYWHERE
        for solid in (shape, limits):
            ends += [np.ravel(part) for part in given(solid, SHAPES, "through")(solid, x, w)]
    cuts = np.unique(np.concatenate(ends))
    cuts = cuts[(cuts >= 0) & np.isfinite(cuts)]
    total = np.zeros((len(t), medium.channels or 1))
    for start, stop in zip(cuts, np.append(cuts[1:], np.inf), strict=True):
        middle = start + 0.5 * min(stop - start, 1.0)
        here = ray.origin + middle * ray.direction
        low, high = np.clip(t, None, start), np.clip(t, None, stop)
        for inside, one in zip(_counted(medium, here[None]), medium.media, strict=True):
            if inside[0]:
                whole = _depth(one, ray, np.maximum(high, low)) - _depth(one, ray, low)
                total += np.where((high > low)[:, None], whole, 0.0)
    return total


def _depth(medium: Any, ray: Ray, t: np.ndarray) -> np.ndarray:
    own = given(medium, ROOM, "depth")
    found: np.ndarray = own(medium, ray, t) if own is not None else closed_forms.along(medium, ray).depth(t)[:, None]
    return found


def sources(medium: CompositeMedium, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo and emission at points x (n, 3) of a grey medium."""
    sigma_t, sigma_s, sigma_a, glow = np.zeros((4, len(x)))
    w = np.tile([0.0, 0.0, 1.0], (len(x), 1))
    for here, one in zip(_counted(medium, x), medium.media, strict=True):
        sigma = look_ups(one)(x[here], w[here])[:, 0]
        albedo, emission = sources_at(one, x[here])
        sigma_t[here] += sigma
        sigma_s[here] += albedo * sigma
        sigma_a[here] += (1 - albedo) * sigma
        glow[here] += (1 - albedo) * sigma * emission
    nothing = np.zeros(len(x))
    return (
        np.divide(sigma_s, sigma_t, out=nothing.copy(), where=sigma_t > 0),
        np.divide(glow, sigma_a, out=nothing.copy(), where=sigma_a > 0),
    )


def bounds(
    medium: CompositeMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return 0 and the sum of what each may be anywhere on the rays, or the greatest of them where one counts alone."""
    each = [np.broadcast_to(_bound(one)(one, origin, direction, length)[1], length.shape) for one in medium.media]
    together: np.ndarray = np.max(each, axis=0) if medium.overlap == "first" else np.sum(each, axis=0)
    return np.zeros(length.shape), together


def _bound(medium: Any) -> Any:
    found = given(medium, ROOM, "bounds")
    if found is None:
        raise UnsupportedError(f"no bound of the extinction of a {type(medium).__name__} is known", "majorant")
    return found


def greatest(medium: CompositeMedium, shape: Shape) -> float:
    """Return the sum of what each may be in its own shape, or in the given one where it has none."""
    each = []
    for one, own in zip(medium.media, medium.shapes, strict=True):
        found = given(one, ROOM, "greatest")
        sigma = given(one, ROOM, "uniform")
        if found is None and sigma is None:
            raise UnsupportedError(
                f"no bound of the extinction of a {type(one).__name__} is known: give a majorant", "majorant"
            )
        each.append(float(np.max(sigma(one))) if found is None else found(one, shape if own == EVERYWHERE else own))
    return max(each) if medium.overlap == "first" else float(np.sum(each))
