"""Airlight of any light in any medium, by adaptive quadrature along the ray with the optical thickness of both ways at each node.

    L = int T(camera, x) sigma_s(x) int f_p(x, mu) L_light(x, w) T(x, light) dw dt

A light at a point or from infinitely far has one direction w a point (`beam`), and the inner integral is f_p E T; light with extent
has many (`incident`). For a light somewhere, t = h sinh(s) about it takes its 1/r^2 away as in the airlight integral. The ray is
cut where the medium, the light, a shadow or the phase function breaks, and integrated by `adaptive_panels`. The error of each
optical thickness is carried along. Features smaller than the panels that no node meets cannot be seen.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.analytic.airlight.attenuation import attenuation
from fogproof.analytic.airlight.beam import Beam
from fogproof.analytic.airlight.incident import Extent, Incident, Rule, received
from fogproof.analytic.airlight.lit_pieces import Pieces, from_light, lit_pieces, points_and_slope
from fogproof.analytic.airlight.ray_and_light import meets_light
from fogproof.analytic.airlight.result import Result
from fogproof.analytic.arithmetic.adaptive_panels import Look, integrate_panels
from fogproof.analytic.arithmetic.budget import budget
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.convex_shapes import changes_of_face, contains
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.geometry.shadows import Shadow, shadow_of_direction, shadow_of_point
from fogproof.analytic.media.coefficients import coefficients, is_uniform
from fogproof.analytic.phase.varying import phase_values_at
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium
from fogproof.scene.kinds import given
from fogproof.scene.lights import Light, strength
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape

METHOD = "adaptive Gauss-Legendre 16 along the ray, optical thickness at each node"
OVER_DIRECTIONS = METHOD + ", rules over the directions of the light"
SOURCE = "nested quadrature of the rendering equation, one order of scattering"
ROOM = "fogproof.analytic.lights"

Attenuated = tuple[np.ndarray, np.ndarray]
"""A value and its error, (m, channels) each."""


def single_scattering_by_quadrature(
    medium: AnyMedium, ray: FlatRays, light: Light, shape: Shape, occluders: Sequence[Occluder], exact: bool = False
) -> Result:
    """Return the radiance (n, channels) along the flattened rays, its estimated error, method and source."""
    beam_of, rule = given(light, ROOM, "beam"), given(light, ROOM, "incident")
    if beam_of is None and rule is None:
        raise UnsupportedError(f"single scattering of a {type(light).__name__} is not known", "light")
    with np.errstate(all="ignore"), budget(len(ray.length)):
        if beam_of is not None:
            beam: Beam = beam_of(light, ray, exact)
            if is_uniform(medium) and beam.where is not None:
                beam = beam._replace(edges=_with_changes(beam, changes_of_face(shape, ray, _position(light))))
            pieces = lit_pieces(medium, ray, shape, beam, None, _shadows(beam, light, ray, occluders))
            look = _from_one_direction(medium, ray, shape, beam, light, pieces)
        else:
            if occluders:
                what = "half shadows have edges that no rule over directions knows"
                raise UnsupportedError(f"occluders before a {type(light).__name__}: {what}", "occluders")
            extent_of = given(light, ROOM, "extent")
            extent: Extent | None = extent_of and extent_of(light, ray)
            pieces = lit_pieces(medium, ray, shape, Beam(), extent, [])
            look = _from_many(medium, ray, shape, lambda x, nodes: rule(light, x, nodes), pieces)
        foreign = hasattr(medium, "detail")  # only a user's function jumps where nobody says so
        value, error = integrate_panels(pieces.span, look, pieces.ray, pieces.weight, len(ray.length), foreign)
        scale = np.atleast_1d(strength(light))
        error = np.where(scale > 0, scale * error + 4 * EPS * scale * value + TINY, 0.0)
        value = np.where(scale > 0, scale * value, 0.0)
        if beam_of is not None and beam.where is not None:
            on_light = meets_light(beam.where) & (ray.length > 0)
            value[on_light], error[on_light] = _at_the_light(medium, ray, light, beam, shape, occluders, on_light)
    return value, error, METHOD if beam_of else OVER_DIRECTIONS, SOURCE


def _shadows(beam: Beam, light: Light, ray: FlatRays, occluders: Sequence[Occluder]) -> list[Shadow]:
    if beam.travel is not None:
        return [shadow_of_direction(occluder, ray, tuple(beam.travel)) for occluder in occluders]
    return [shadow_of_point(occluder, ray, _position(light)) for occluder in occluders]


def _position(light: Light) -> tuple[float, float, float]:
    position: tuple[float, float, float] = light.position  # type: ignore[union-attr]  # a beam from a point has one
    return position


def _with_changes(beam: Beam, distances: np.ndarray) -> np.ndarray:
    """Return the edges of the beam and places at distances (n, m) from the cameras, from the foot of the perpendicular all."""
    assert beam.where is not None
    places = distances + beam.where.a[:, None]
    return places if beam.edges is None else np.concatenate([beam.edges, places], axis=1)


def _scattering(medium: AnyMedium, x: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return sigma_s (m, channels) at points x (m, 3) for light along w (m, 3)."""
    channels = medium.channels or 1
    return np.broadcast_to(
        coefficients(medium, x, w, medium.channels).sigma_s.reshape(-1, channels), (len(x), channels)
    )


def _seen(medium: AnyMedium, shape: Shape, ray: FlatRays, i: np.ndarray, distance: np.ndarray) -> Attenuated:
    """Return the optical thickness from the cameras of rays i (m,) to distances (m,), and its error."""
    return attenuation(medium, shape, ray.origin[i], ray.direction[i], np.maximum(distance, TINY))


def _from_one_direction(
    medium: AnyMedium, ray: FlatRays, shape: Shape, beam: Beam, light: Light, pieces: Pieces
) -> Look:
    """Return the integrand of each piece in its variable, for a light of unit strength and one direction a point."""
    channels = medium.channels or 1
    where = beam.where

    def look(which: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        i = np.repeat(pieces.ray[which], u.shape[1])
        uncertain = np.zeros((1, 1))  # of the intensity, where that varies with the angle
        if where is None:
            distance, jacobian = (pieces.start[which, None] + u).ravel(), np.ones(u.size)
            x = ray.origin[i] + distance[:, None] * ray.direction[i]
            assert beam.travel is not None
            back, way = np.broadcast_to(-beam.travel, x.shape), np.full(len(x), np.inf)
            mu = np.clip(np.sum(back * ray.direction[i], axis=1), -1, 1)
            behind, before = (1 - mu) / 2, (1 + mu) / 2
        else:
            own = pieces.ray[which]
            _, w0, wt0 = from_light(where.a[own] + pieces.start[which], where.h[own])
            w, wt = w0[:, None] * np.exp(u), wt0[:, None] * np.exp(-u)
            r, t = 0.5 * (w + wt), 0.5 * (w - wt)
            distance = np.clip(t - where.a[own][:, None], pieces.start[which, None], pieces.end[which, None]).ravel()
            x = ray.origin[i] + distance[:, None] * ray.direction[i]
            inverse, mu = 1 / r, np.clip((wt - w) / (w + wt), -1, 1).ravel()
            behind, before = (w / (w + wt)).ravel(), (wt / (w + wt)).ravel()
            if beam.profile is not None:
                aim, blur = beam.profile(own, t)
                uncertain = (inverse * blur).reshape(-1, 1)
                inverse = inverse * aim
            jacobian = inverse.ravel()
            back = np.array(_position(light)) - x
            way = np.linalg.norm(back, axis=1)
            back = back / way[:, None]
        near, near_error = _seen(medium, shape, ray, i, distance)
        far, far_error = attenuation(medium, shape, x, back, way)
        f, f_error = phase_values_at(medium.phase, x, mu, behind, before)
        through = _scattering(medium, x, ray.direction[i]) * np.exp(-near - far)
        value = through * (f * jacobian)[:, None]
        error = through * ((f_error + 8 * EPS * f) * jacobian)[:, None] + through * f[:, None] * uncertain
        error = error + value * np.expm1(near_error + far_error + 32 * EPS)
        return value.reshape(*u.shape, channels), error.reshape(*u.shape, channels)

    return look


def _from_many(medium: AnyMedium, ray: FlatRays, shape: Shape, rule: Rule, pieces: Pieces) -> Look:
    """Return the integrand of each piece in its variable, for light of radiance 1 from many directions."""
    channels = medium.channels or 1

    def look(which: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        i = np.repeat(pieces.ray[which], u.shape[1])
        distance, slope = (part.ravel() for part in points_and_slope(pieces, which, u))
        x, ahead = ray.origin[i] + distance[:, None] * ray.direction[i], ray.direction[i]

        def total(some: np.ndarray, incident: Incident) -> Attenuated:
            w = incident.direction.reshape(-1, 3)
            points = np.repeat(x[some], incident.weight.shape[1], axis=0)
            mu = np.clip(np.einsum("mkc,mc->mk", incident.direction, ahead[some]), -1, 1).ravel()
            f, f_error = phase_values_at(medium.phase, points, mu, (1 - mu) / 2, (1 + mu) / 2)
            far, far_error = attenuation(medium, shape, points, w, incident.distance.ravel())
            arrives = np.exp(-far) * incident.weight.reshape(-1, 1)
            noise = arrives * (f_error + 8 * EPS * f)[:, None] + arrives * f[:, None] * np.expm1(far_error + 16 * EPS)
            size = (len(some), -1, channels)
            return (arrives * f[:, None]).reshape(size).sum(axis=1), noise.reshape(size).sum(axis=1)

        lit, off = received(x, rule, total, channels)
        near, near_error = _seen(medium, shape, ray, i, distance)
        scattered = _scattering(medium, x, ahead) * np.exp(-near) * slope[:, None]
        value = scattered * lit
        error = scattered * off + value * np.expm1(near_error + 32 * EPS)
        return value.reshape(*u.shape, channels), error.reshape(*u.shape, channels)

    return look


def _at_the_light(
    medium: AnyMedium,
    ray: FlatRays,
    light: Light,
    beam: Beam,
    shape: Shape,
    occluders: Sequence[Occluder],
    which: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return inf for rays that meet the light where the medium scatters; elsewhere no method here knows the answer."""
    if not which.any():
        return np.empty((0, 1)), np.empty((0, 1))
    position = np.array(_position(light))[None]
    sigma_s = coefficients(medium, position, ray.direction[which][:1], medium.channels).sigma_s.reshape(-1)
    if beam.weight or occluders or not (sigma_s > 0).all() or not contains(shape, position).all():
        raise UnsupportedError("a ray that meets the light itself, where it is not sure to be infinitely bright", "ray")
    return np.full((which.sum(), 1), np.inf), np.zeros((which.sum(), 1))
