"""Lit pieces of rays without breaks inside, and the variable in which each is integrated."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.beam import Beam
from fogproof.analytic.airlight.incident import Extent
from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.airlight.ray_and_light import meets_light
from fogproof.analytic.arithmetic.adaptive_panels import PANELS
from fogproof.analytic.geometry.convex_shapes import chord
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.geometry.shadows import Shadow
from fogproof.analytic.media.breakpoints import breakpoints
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.analytic.phase.varying import phase_components
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Medium, Ray
from fogproof.scene.shapes import Shape

DARK = 746.0
"""Optical thickness beyond which exp(-tau) is 0 in float64: an endless ray through a homogeneous medium ends there."""


class Pieces(NamedTuple):
    """Lit pieces of rays without breaks inside, (p,) each.

    ray         which ray a piece belongs to
    start, end  distances from the camera [m]
    span        length in the variable of integration: asinh(t/h), or the distance for light from infinitely far
    weight      1, or 1/2 where it is unsure whether the light reaches it
    foot        distance from the camera to the foot of the perpendicular of a light with extent [m]
    reach       h for such a light, NaN for others [m]
    """

    ray: np.ndarray
    start: np.ndarray
    end: np.ndarray
    span: np.ndarray
    weight: np.ndarray
    foot: np.ndarray
    reach: np.ndarray


def lit_pieces(
    medium: AnyMedium, ray: FlatRays, shape: Shape, beam: Beam, extent: Extent | None, shadows: list[Shadow]
) -> Pieces:
    """Return the pieces of the rays between all breaks that a light may reach."""
    breaks, sure = _breaks(medium, ray, shape)
    start, end = breaks[:, :1], breaks[:, -1:]
    if extent is not None:
        end = np.clip(extent.end[:, None], start, end)
    places = [breaks, *_places_of_detail(medium, start, end), *(np.stack(shadow, axis=1) for shadow in shadows)]
    places += _places_of_the_light(medium, beam, extent)
    every = np.concatenate(places, axis=1)
    every = np.sort(np.where((every >= start) & (every <= end), every, start), axis=1)
    every = np.concatenate([every, end], axis=1)
    owner, k = np.nonzero(every[:, 1:] > every[:, :-1])
    low, high = every[owner, k], every[owner, k + 1]
    weight = _reached(owner, 0.5 * (low + high), sure, beam, shadows)
    lit = weight > 0
    if beam.where is not None:
        lit &= ~meets_light(beam.where)[owner]
    owner, low, high, weight = owner[lit], low[lit], high[lit], weight[lit]
    if extent is None:
        none = np.full(len(owner), np.nan)
        return Pieces(owner, low, high, _span(beam, owner, low, high), weight, none, none)
    foot, reach = extent.foot[owner], extent.reach[owner]
    span = np.arcsinh((high - foot) / reach) - np.arcsinh((low - foot) / reach)
    return Pieces(owner, low, high, span, weight, foot, reach)


def _breaks(medium: AnyMedium, ray: FlatRays, shape: Shape) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray] | None]:
    """Return the breaks of the medium along each ray, (n, breaks); of a uniform one also where the ray is in the shape for sure."""
    if is_uniform(medium):
        inside = chord(shape, ray)
        end = np.minimum(inside.end, inside.start + DARK / _thinnest(medium))
        sure = inside.sure_start, np.minimum(inside.sure_end, end)
        breaks = np.stack([inside.start, *sure, end], axis=1)
    else:
        sure, breaks = None, breakpoints(medium, Ray(*ray))
    if np.isinf(breaks).any():
        raise UnsupportedError("an endless ray through a medium without end: give the ray a length", "ray")
    return breaks, sure


def _places_of_detail(medium: AnyMedium, start: np.ndarray, end: np.ndarray) -> list[np.ndarray]:
    """Return where panels end that are no wider than what a user's function says it has in store."""
    detail = getattr(medium, "detail", np.inf)
    if detail == np.inf:
        return []
    steps = min(int(np.ceil(np.max(end - start, initial=0.0) / detail)), PANELS)
    return [start + detail * np.arange(1, steps)]


def _places_of_the_light(medium: AnyMedium, beam: Beam, extent: Extent | None) -> list[np.ndarray]:
    """Return where the light is seen at kinks of the phase function, where it has edges, and where it is nearest."""
    places, where = [], beam.where
    if where is not None:
        mu = np.concatenate([airlight_phase(phase).kinks for phase in phase_components(medium.phase)])
        kinks = -where.h[:, None] * (mu / np.sqrt((1 - mu) * (1 + mu)))
        edges = np.empty((len(where.h), 0)) if beam.edges is None else beam.edges
        nearest = np.zeros((len(where.h), 1))
        places.append(np.concatenate([kinks, edges, nearest], axis=1) - where.a[:, None])
    if extent is not None:
        places.append(np.concatenate([extent.places, extent.foot[:, None]], axis=1))
    return places


def _reached(
    owner: np.ndarray,
    middle: np.ndarray,
    sure: tuple[np.ndarray, np.ndarray] | None,
    beam: Beam,
    shadows: list[Shadow],
) -> np.ndarray:
    """Return whether the light reaches pieces of the rays `owner` with these middles, (p,): 0, 1, or 1/2 where that is unsure."""
    weight = np.ones(len(owner))
    if sure is not None:  # by rounding, the ray may not be in the shape there
        weight = np.where((middle >= sure[0][owner]) & (middle <= sure[1][owner]), 1.0, 0.5)
    if beam.where is not None and beam.weight is not None:
        weight = np.minimum(weight, beam.weight(owner, beam.where.a[owner] + middle))
    for shadow in shadows:
        outer, dark, undark, over = (x[owner] for x in shadow)
        weight = np.where((middle > outer) & (middle < over), np.minimum(weight, 0.5), weight)
        weight = np.where((middle > dark) & (middle < undark), 0.0, weight)
    return weight


def _span(beam: Beam, owner: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the length of pieces in asinh(t/h), (p,); in the distance for light from infinitely far."""
    span = high - low
    if beam.where is None:
        return span
    a, h = beam.where.a[owner], beam.where.h[owner]
    (r0, w0, wt0), (r1, w1, wt1) = from_light(a + low, h), from_light(a + high, h)
    span = np.log1p(span / (r0 + r1) * np.where(a + low >= 0, (w0 + w1) / w0, (wt0 + wt1) / wt1))
    return np.where(np.isfinite(span), span, 0.0)


def points_and_slope(pieces: Pieces, which: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return distances from the camera at places u (p, nodes) of pieces in their variable, and d distance / du."""
    start, end, foot, reach = (x[which, None] for x in (pieces.start, pieces.end, pieces.foot, pieces.reach))
    curved = np.isfinite(reach)
    s = np.arcsinh((start - foot) / reach) + u
    distance = np.where(curved, foot + reach * np.sinh(s), start + u)
    return np.clip(distance, start, end), np.where(curved, reach * np.cosh(s), 1.0)


def from_light(t: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return r, r + t and r - t without cancellation."""
    r = np.hypot(t, h)
    near = h * (h / (r + np.abs(t)))
    near = np.where(r > 0, near, 0.0)
    return r, np.where(t >= 0, r + t, near), np.where(t >= 0, near, r - t)


def _thinnest(medium: Medium) -> float:
    """Return the smallest extinction of the channels that scatter [1/m]; 1 if none does."""
    sigma_t, sigma_s = np.broadcast_arrays(np.atleast_1d(medium.sigma_t), np.atleast_1d(medium.sigma_s))
    return float(sigma_t[sigma_s > 0].min(initial=np.inf)) if (sigma_s > 0).any() else 1.0
