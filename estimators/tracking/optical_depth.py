"""The estimators' own optical depth along a ray, for the densities they claim: closed forms, cells, or fine quadrature."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.marching import feature_size
from fogproof.estimators.tracking.medium_data import look_ups
from fogproof.estimators.tracking.tracked import clip_to_box
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import box

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def path_density(medium: AnyMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return sigma_t(t) T(t) along one ray, (n, channels) [1/m]."""
    x = ray.origin + t[:, None] * ray.direction
    lower, upper = box(medium)
    inside = np.all((x >= lower) & (x <= upper), axis=-1)
    sigma = look_ups(medium)(x, np.broadcast_to(ray.direction, x.shape))
    return np.where(inside[:, None], sigma, 0.0) * np.exp(-optical_depth(medium, ray, t))


def optical_depth(medium: AnyMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the optical depth from the start of one ray to distances t (n,), (n, channels), dimensionless.

    Exact but for rounding where the kind has a closed form; elsewhere 12-point Gauss-Legendre quadrature in panels as long as the
    smallest feature of the medium.
    """
    own = given(medium, ROOM, "depth")
    found: np.ndarray = own(medium, ray, t) if own is not None else _quadrature(medium, ray, t)
    return found


def _quadrature(medium: AnyMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    lower, upper = box(medium)
    enter, leave = clip_to_box(ray.origin[None], ray.direction[None], ray.length[None], lower, upper)
    start, stop = float(enter[0]), float(leave[0])
    panels = max(1, int(np.ceil((stop - start) / feature_size(medium, ray))))
    edges = np.linspace(start, stop, panels + 1)
    inside = np.clip(t, start, stop)
    panel = np.clip(np.searchsorted(edges, inside, side="right") - 1, 0, panels - 1)
    whole = _gauss(medium, ray, edges[:-1], edges[1:])
    before = np.concatenate([np.zeros((1, whole.shape[1])), np.cumsum(whole, axis=0)])
    return before[panel] + _gauss(medium, ray, edges[panel], inside)


def _gauss(medium: AnyMedium, ray: Ray, start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Return the integrals of sigma_t from start to stop (n,) along one ray, (n, channels)."""
    half = 0.5 * (stop - start)
    t = (start + half)[:, None] + half[:, None] * NODES
    x = (ray.origin + t[..., None] * ray.direction).reshape(-1, 3)
    sigma = look_ups(medium)(x, np.broadcast_to(ray.direction, x.shape)).reshape(*t.shape, -1)
    return half[:, None] * np.einsum("nkc,k->nc", sigma, WEIGHTS)
