"""Several media in one: coefficients add up, or the first counts; everything else by quadrature between all their breaks."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.geometry.convex_shapes import contains, through
from fogproof.analytic.media.breakpoints import Breaks, extent
from fogproof.analytic.media.coefficients import Coefficients, Points
from fogproof.analytic.media.coefficients import coefficients as coefficients_of
from fogproof.scene import Ray
from fogproof.scene.media import CompositeMedium, box


def coefficients(medium: CompositeMedium, at: Points) -> Coefficients:
    """Return the sums; L_e is the mean weighted by what absorbs, so that sigma_a L_e adds up."""
    channels = None if len(at.shape) < at.x.ndim else at.shape[-1]
    sigma_t, sigma_a, sigma_s, glow = (np.zeros(at.shape) for _ in range(4))
    for here, part in zip(_counted(medium, at.x), medium.media, strict=True):
        found = coefficients_of(part, at.x, at.w, channels)
        inside = here if channels is None else here[..., None]
        sigma_t, sigma_a, sigma_s = (
            total + np.where(inside, new, 0.0)
            for total, new in zip((sigma_t, sigma_a, sigma_s), found[:3], strict=True)
        )
        glow = glow + np.where(inside, found.sigma_a * found.emission, 0.0)
    emission = np.divide(glow, sigma_a, out=np.zeros(at.shape), where=sigma_a > 0)
    return Coefficients(sigma_t, sigma_a, sigma_s, emission)


def scattering(medium: CompositeMedium, points: np.ndarray) -> list[np.ndarray]:
    """Return sigma_s of each of the media at points (..., 3), for light along +z [1/m]; grey."""
    along = np.array([0.0, 0.0, 1.0])
    return [
        np.where(here, coefficients_of(part, points, along).sigma_s, 0.0)
        for here, part in zip(_counted(medium, points), medium.media, strict=True)
    ]


def _counted(medium: CompositeMedium, x: np.ndarray) -> list[np.ndarray]:
    """Return at which points (..., 3) each of the media counts."""
    counted, taken = [], np.zeros(x.shape[:-1], bool)
    for part, shape in zip(medium.media, medium.shapes, strict=True):
        lower, upper = box(part)
        inside = contains(shape, x) & np.all((x >= lower) & (x <= upper), axis=-1)
        counted.append(inside & ~taken)
        if medium.overlap == "first":
            taken = taken | inside
    return counted


def breakpoints(medium: CompositeMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray) -> Breaks:
    """Return where any medium or shape begins or ends, and the breaks of each medium."""
    first, last, found = np.full(len(length), np.inf), np.full(len(length), -np.inf), []
    ray = Ray(origin, direction, length)
    for part, shape in zip(medium.media, medium.shapes, strict=True):
        own = extent(part, ray)
        enter, leave = through(shape, origin, direction)  # NaN where a ray misses the shape
        there = np.maximum(own.enter, enter) < np.minimum(own.leave, leave)
        enter, leave = np.fmax(own.enter, enter), np.fmin(own.leave, leave)
        first, last = np.where(there, np.minimum(first, enter), first), np.where(there, np.maximum(last, leave), last)
        found += [np.where(there, t, 0.0)[:, None] for t in (enter, leave)]
        found += [np.nan_to_num(t, nan=0.0, posinf=np.inf, neginf=-np.inf) for t in own.found]
    nowhere = ~(first < last)
    return Breaks(np.where(nowhere, 0.0, first), np.where(nowhere, 0.0, last), found)
