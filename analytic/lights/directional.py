"""Airlight of parallel light in a homogeneous medium that fills a convex shape.

    L = sigma_s E f_p(mu) int exp(-sigma_t (t - t_enter)) exp(-sigma_t d(t)) dt        [W/(m^2 sr)]

d is the way from the point at t back to where the light came in. In a polyhedron it is linear between the places where
the face it comes in by changes, and the integral is in closed form; in a ball it is linear plus the square root of a
quadratic, which t = middle + radius sin(x) makes an entire function of x for Gauss-Legendre quadrature.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fogproof.analytic.airlight.beam import Beam
from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.airlight.result import Result
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.convex_shapes import Chord, chord, faces
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.geometry.shadows import Shadow, shadow_of_direction
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.analytic.phase.functions import phase_pdf
from fogproof.scene import AnyMedium
from fogproof.scene.kinds import given
from fogproof.scene.lights import DirectionalLight
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape

SOURCE = "Beer's law along both ways, integrated"


EDGE_ON = 1e-150
"""Cosine below which light meets a face edge-on."""


def beam(light: DirectionalLight, _ray: FlatRays, _exact: bool) -> Beam:
    """Return the light for quadrature along rays."""
    return Beam(travel=np.array(light.direction))


def single_scattering(
    medium: AnyMedium, ray: FlatRays, light: DirectionalLight, shape: Shape, occluders: Sequence[Occluder], **_how: Any
) -> Result | None:
    """Return the radiance (n, channels) along the flattened rays and a bound of its error; None for other media and shapes."""
    curved = given(shape, "fogproof.analytic.shapes", "parallel_light")
    if not is_uniform(medium) or (curved is None and faces(shape) is None):
        return None
    sigma = np.atleast_1d(medium.sigma_t)
    count = ray.length.size
    inside = chord(shape, ray)
    shadows = [shadow_of_direction(occluder, ray, light.direction) for occluder in occluders]
    with np.errstate(all="ignore"):
        start, end, owner, weight = _pieces(shape, ray, light, inside, shadows)
        method = curved or _polyhedron
        parts, errors = method(shape, ray, np.array(light.direction), sigma, start, end, owner, inside.start)

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
    name = "Gauss-Legendre 28" if curved else "closed form"
    return total, np.where(scale > 0, error, 0.0), f"{name} along the ray", SOURCE


def _pieces(
    shape: Shape, ray: FlatRays, light: DirectionalLight, inside: Chord, shadows: list[Shadow]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return start and end [m], ray, and the weight (1, or 1/2 where unsure) of the lit pieces between all breaks."""
    start, end = inside.start[:, None], inside.end[:, None]
    places = [
        np.stack([inside.sure_start, inside.sure_end], axis=1),
        _changes_of_face(shape, ray, np.array(light.direction)),
    ]
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


def _ways_back(shape: Shape, ray: FlatRays, travel: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (n, k) offsets and slopes of the linear ways back to each face the light can come in by, and their scale.

    The way back from the point at t is the least of offset + slope t; none means that no light comes in at all.
    """
    planes = faces(shape)
    if planes is None:  # curved: nothing changes suddenly
        return np.empty((len(ray.origin), 0)), np.empty((len(ray.origin), 0)), np.empty((len(ray.origin), 0))
    normals, offsets = planes
    facing = -(normals @ travel)
    entered = facing > EDGE_ON  # such a face is infinitely far, for all that is not on it
    normals, offsets, facing = normals[entered], offsets[entered], facing[entered]
    origin, d = ray.origin, ray.direction
    size = np.abs(origin).sum(axis=1)[:, None] + np.abs(offsets)
    return (offsets - origin @ normals.T) / facing, -(d @ normals.T) / facing, size / facing


def _changes_of_face(shape: Shape, ray: FlatRays, travel: np.ndarray) -> np.ndarray:
    """Return (n, m) places where two faces are equally far."""
    offset, slope, _ = _ways_back(shape, ray, travel)
    i, j = np.triu_indices(offset.shape[1], 1)
    return -(offset[:, i] - offset[:, j]) / (slope[:, i] - slope[:, j])


def _may_be_on_a_face_edge_on(
    shape: Shape, ray: FlatRays, travel: np.ndarray, start: np.ndarray, end: np.ndarray, owner: np.ndarray
) -> np.ndarray:
    """Return which pieces touch a face that the light meets all but edge-on: by rounding it may come in there, or not at all."""
    planes = faces(shape)
    assert planes is not None
    normals, offsets = planes
    facing = -(normals @ travel)
    grazed = (facing > 0) & (facing <= EDGE_ON)
    rooms = offsets[grazed] - ray.origin[owner] @ normals[grazed].T
    speed = ray.direction[owner] @ normals[grazed].T
    far = np.where(end < np.inf, end, start)
    least = np.minimum(rooms - start[:, None] * speed, rooms - far[:, None] * speed)
    size = np.abs(ray.origin[owner]).sum(axis=1)[:, None] + np.abs(offsets[grazed]) + np.abs(far)[:, None]
    touches: np.ndarray = (least <= 32 * EPS * size).any(axis=1)
    return touches


def _polyhedron(
    shape: Shape,
    ray: FlatRays,
    travel: np.ndarray,
    sigma: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    owner: np.ndarray,
    enter: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return int exp(-sigma path) dt over each piece, (p, channels), and its error: len exp(-sigma nearer) phi_1."""
    offset, slope, size = (x[owner] for x in _ways_back(shape, ray, travel))
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
    edge_on = _may_be_on_a_face_edge_on(shape, ray, travel, start, end, owner)
    near = np.exp(-sigma * np.maximum(start - enter[owner], 0.0)[:, None])
    at_most = np.where(edge_on[:, None], np.maximum(at_most, near * np.minimum(length[:, None], 1 / sigma)), at_most)
    return value, (at_most - value) + (np.minimum(sigma * uncertain[:, None], 1.0) + 16 * EPS) * value + TINY
