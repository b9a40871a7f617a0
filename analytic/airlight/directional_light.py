"""Airlight of parallel light in a homogeneous medium that fills a convex shape.

    L = sigma_s E f_p(mu) int exp(-sigma_t (t - t_enter)) exp(-sigma_t d(t)) dt        [W/(m^2 sr)]

d is the way from the point at t back to where the light came in. In a polyhedron it is linear between the places where
the face it comes in by changes, and the integral is in closed form; in a ball it is linear plus the square root of a
quadratic, which t = middle + radius sin(x) makes an entire function of x for Gauss-Legendre quadrature.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.arithmetic.gauss_legendre import NODES, WEIGHTS
from fogproof.analytic.geometry.convex_shapes import Chord, chord, faces
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.geometry.shadows import Shadow, shadow_of_direction
from fogproof.analytic.phase.functions import phase_pdf
from fogproof.errors import UnsupportedError
from fogproof.scene import Medium
from fogproof.scene.lights import DirectionalLight
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Ball, Shape, Unbounded

SOURCE = "Beer's law along both ways, integrated"

LARGEST_DEPTH = 2e4
"""Optical radius of a ball beyond which its quadrature would take too many panels."""


def directional_light(
    medium: Medium, ray: FlatRays, light: DirectionalLight, shape: Shape, occluders: Sequence[Occluder]
) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Return the radiance (n, channels) along the flattened rays, its error, method and source."""
    sigma = np.atleast_1d(medium.sigma_t)
    count = ray.length.size
    if isinstance(shape, Unbounded):
        zero = np.zeros((count, len(sigma)))
        return zero, zero, "no light arrives from infinitely far", SOURCE
    inside = chord(shape, ray)
    shadows = [shadow_of_direction(occluder, ray, light.direction) for occluder in occluders]
    with np.errstate(all="ignore"):
        start, end, owner, weight = _pieces(shape, ray, light, inside, shadows)
        method = _ball if isinstance(shape, Ball) else _polyhedron
        parts, errors = method(shape, ray, light, sigma, start, end, owner, inside.start)

        def gather(x: np.ndarray) -> np.ndarray:
            out = np.zeros((count, len(sigma)))
            np.add.at(out, owner, x)
            return out

        value = gather(parts * weight[:, None])
        error = gather(errors + parts * (1 - weight[:, None])) + (4 + len(occluders)) * EPS * value
        error = error + value * np.expm1(sigma * (inside.sure_start - inside.start)[:, None])

        mu = np.clip(-(ray.direction @ np.array(light.direction)), -1, 1)
        f = phase_pdf(medium.phase, mu)
        slope, steep = airlight_phase(medium.phase).slope(mu - 4 * EPS, mu + 4 * EPS)
        f_error = f.error + 4 * EPS * (slope * f.value + steep)
        scale = np.atleast_1d(np.multiply(medium.sigma_s, light.irradiance))
        total = np.where(scale > 0, value * scale * f.value[:, None], 0.0)
        error = scale * (error * f.value[:, None] + value * f_error[:, None]) + 4 * EPS * total + TINY
    name = "Gauss-Legendre 28" if isinstance(shape, Ball) else "closed form"
    return total, np.where(scale > 0, error, 0.0), f"{name} along the ray", SOURCE


def _pieces(
    shape: Shape, ray: FlatRays, light: DirectionalLight, inside: Chord, shadows: list[Shadow]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return start and end [m], ray, and the weight (1, or 1/2 where unsure) of the lit pieces between all breaks."""
    start, end = inside.start[:, None], inside.end[:, None]
    places = [np.stack([inside.sure_start, inside.sure_end], axis=1), _changes_of_face(shape, ray, light)]
    places += [np.stack(shadow, axis=1) for shadow in shadows]
    every = np.concatenate(places, axis=1)
    every = np.where((every > start) & (every < end), every, start)
    edges = np.concatenate([start, np.sort(every, axis=1), end], axis=1)
    owner, k = np.nonzero(edges[:, 1:] > edges[:, :-1])
    low, high = edges[owner, k], edges[owner, k + 1]
    middle = np.where(high < np.inf, 0.5 * (low + high), low + 1.0 + np.abs(low))
    sure = (middle > inside.sure_start[owner]) & (middle < inside.sure_end[owner])
    weight = np.where(sure, 1.0, 0.5)
    for shadow in shadows:
        outer, dark, undark, over = (x[owner] for x in shadow)
        weight = np.where((middle > outer) & (middle < over), 0.5, weight)
        weight = np.where((middle > dark) & (middle < undark), 0.0, weight)
    lit = weight > 0
    return low[lit], high[lit], owner[lit], weight[lit]


def _ways_back(shape: Shape, ray: FlatRays, light: DirectionalLight) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (n, k) offsets and slopes of the linear ways back to each face the light can come in by, and their scale.

    The way back from the point at t is the least of offset + slope t; none means that no light comes in at all.
    """
    normals, offsets = faces(shape)
    facing = -(normals @ np.array(light.direction))
    entered = facing > 1e-150  # a face edge-on is infinitely far
    normals, offsets, facing = normals[entered], offsets[entered], facing[entered]
    origin, d = ray.origin, ray.direction
    size = np.abs(origin).sum(axis=1)[:, None] + np.abs(offsets)
    return (offsets - origin @ normals.T) / facing, -(d @ normals.T) / facing, size / facing


def _changes_of_face(shape: Shape, ray: FlatRays, light: DirectionalLight) -> np.ndarray:
    """Return (n, m) places where two faces are equally far."""
    offset, slope, _ = _ways_back(shape, ray, light)
    i, j = np.triu_indices(offset.shape[1], 1)
    return -(offset[:, i] - offset[:, j]) / (slope[:, i] - slope[:, j])


def _polyhedron(
    shape: Shape,
    ray: FlatRays,
    light: DirectionalLight,
    sigma: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    owner: np.ndarray,
    enter: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return int exp(-sigma path) dt over each piece, (p, channels), and its error: len exp(-sigma nearer) phi_1."""
    offset, slope, size = (x[owner] for x in _ways_back(shape, ray, light))
    if not offset.shape[1]:
        return np.zeros((len(owner), len(sigma))), np.zeros((len(owner), len(sigma)))
    middle = np.where(end < np.inf, 0.5 * (start + end), start + 1.0 + np.abs(start))
    face = np.argmin(offset + slope * middle[:, None], axis=1)
    offset, slope, size = (x[np.arange(len(owner)), face] for x in (offset, slope, size))
    growth = 1 + slope  # of the path, per metre
    nearer = np.where(growth >= 0, start, end)
    path = np.maximum(nearer - enter[owner], 0) + np.maximum(offset + slope * nearer, 0)
    length = end - start
    x = sigma * np.abs(growth * length)[:, None]
    mean = np.where(x > 0, -np.expm1(-x) / x, 1.0)
    reach = np.where(length[:, None] < np.inf, length[:, None] * mean, 1 / (sigma * np.abs(growth)[:, None]))
    value = np.exp(-sigma * path[:, None]) * reach
    uncertain = 16 * EPS * (size + np.abs(slope * nearer) + np.abs(nearer))
    # The way may be shorter by that, which is a lot only where the light grazes a face.
    at_most = np.exp(-sigma * np.maximum(path - uncertain, 0.0)[:, None]) * reach
    return value, (at_most - value) + (np.minimum(sigma * uncertain[:, None], 1.0) + 16 * EPS) * value + TINY


def _ball(
    shape: Shape,
    ray: FlatRays,
    light: DirectionalLight,
    sigma: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    owner: np.ndarray,
    enter: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return int exp(-sigma path) dt over each piece, (p, channels), and its error."""
    assert isinstance(shape, Ball)
    R, v = shape.radius, np.array(light.direction)
    if R * sigma.max() > LARGEST_DEPTH:
        raise UnsupportedError(
            f"parallel light in a ball of optical radius {R * sigma.max():g} > {LARGEST_DEPTH:g}", "shape"
        )
    origin, d = ray.origin[owner] - np.array(shape.center), ray.direction[owner]
    Q0, Q1 = np.cross(origin, v), np.cross(d, v)
    bend = np.sum(Q1 * Q1, axis=1)
    middle = np.where(bend > 0, -np.sum(Q0 * Q1, axis=1) / bend, 0.0)
    nearest = Q0 + middle[:, None] * Q1
    radius = np.sqrt(np.maximum(R * R - np.sum(nearest * nearest, axis=1), 0.0) / bend)
    # For a larger radius the root is nearly straight over the ball, and smooth; for a tiny one the ray just touches it.
    bent = (radius < 4 * R) & (radius > EPS * R)
    first, last = (np.clip((t - middle) / np.where(bent, radius, 1.0), -1, 1) for t in (start, end))
    low, high = np.where(bent, np.arcsin(first), start), np.where(bent, np.arcsin(last), end)
    lost = np.where(bent, np.maximum((end - start) - radius * (last - first), 0.0), 0.0)  # at the margins
    panels = np.ceil(2 + sigma.max() * (end - start) / 4).astype(int)
    value, error = np.zeros((2, len(owner), len(sigma)))
    for i in range(len(owner)):
        edges = np.linspace(low[i], high[i], panels[i] + 1)
        x = edges[:-1] + NODES[:, None] * np.diff(edges)
        weights = WEIGHTS[:, None] * np.diff(edges)
        t = np.clip(middle[i] + radius[i] * np.sin(x), start[i], end[i]) if bent[i] else x
        weights = weights * radius[i] * np.cos(x) if bent[i] else weights
        Q = Q0[i] + t[..., None] * Q1[i]
        half = np.sqrt(np.maximum(R * R - np.sum(Q * Q, axis=-1), 0.0))
        way = np.maximum(origin[i] @ v + t * (d[i] @ v) + half, 0.0)
        path = np.maximum(t - enter[owner[i]], 0.0) + way
        # The root of a rounded difference: eps R^2 / half, and never more than sqrt(eps) R.
        blur = 16 * EPS * (np.abs(origin[i]).max() + R) * (2 + np.minimum(R / half, EPS**-0.5))
        f = np.exp(-sigma[:, None, None] * path) * weights
        value[i] = f.sum(axis=(1, 2))
        error[i] = (f * np.expm1(sigma[:, None, None] * blur)).sum(axis=(1, 2)) + 64 * EPS * value[i] + lost[i]
    return value, error + TINY
