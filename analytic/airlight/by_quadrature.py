"""Airlight in any medium, by adaptive quadrature along the ray with the optical thickness of both ways at each node.

    L = int T(camera, x) sigma_s(x) f_p(x, mu) E(x) dt,    E = I T(x, light) / r^2, or E_0 T(x, outside) for parallel light

For a light with a position, t = h sinh(s) takes the 1/r^2 away as in the airlight integral. The ray is cut where the
medium, a cone, a shadow or the phase function breaks, and integrated by `adaptive_panels`. The error of each optical
thickness is carried along. Features smaller than the panels that no node meets cannot be seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.light_cone import edges, intensity_at, lit_by_cone
from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.airlight.ray_and_light import Placement, meets_light, place
from fogproof.analytic.arithmetic.adaptive_panels import PANELS, Look, integrate_panels
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.convex_shapes import chord, contains, through
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.geometry.shadows import shadow_of_direction, shadow_of_point
from fogproof.analytic.media.breakpoints import breakpoints
from fogproof.analytic.media.coefficients import coefficients
from fogproof.analytic.media.thickness import thickness
from fogproof.analytic.phase.functions import phase_pdf
from fogproof.analytic.phase.varying import share_at
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Medium, Ray, VaryingPhase
from fogproof.scene.lights import DirectionalLight, PointLight, SpotLight, strength
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape, Unbounded

METHOD = "adaptive Gauss-Legendre 16 along the ray, optical thickness at each node"
SOURCE = "nested quadrature of the rendering equation, one order of scattering"

Aimed = PointLight | SpotLight | DirectionalLight


class Pieces(NamedTuple):
    """Lit pieces of rays without breaks inside, (p,) each.

    ray         which ray a piece belongs to
    start, end  distances from the camera [m]
    span        length in the variable of integration: asinh(t/h), or the distance for parallel light
    weight      1, or 1/2 where it is unsure whether the light reaches it
    """

    ray: np.ndarray
    start: np.ndarray
    end: np.ndarray
    span: np.ndarray
    weight: np.ndarray


def single_scattering_by_quadrature(
    medium: AnyMedium, ray: FlatRays, light: Aimed, shape: Shape, occluders: Sequence[Occluder]
) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Return the radiance (n, channels) along the flattened rays, its estimated error, method and source."""
    where = None if isinstance(light, DirectionalLight) else place(ray, light.position)
    with np.errstate(all="ignore"):
        pieces = _pieces(medium, ray, light, shape, occluders, where)
        look = _integrand(medium, ray, light, shape, where, pieces)
        value, error = integrate_panels(pieces.span, look, pieces.ray, pieces.weight, len(ray.length))
        scale = np.atleast_1d(strength(light))
        error = np.where(scale > 0, scale * error + 4 * EPS * scale * value + TINY, 0.0)
        value = np.where(scale > 0, scale * value, 0.0)
        if where is not None and not isinstance(light, DirectionalLight):
            on_light = meets_light(where)
            value[on_light], error[on_light] = _at_the_light(medium, ray, light, shape, occluders, on_light)
    return value, error, METHOD, SOURCE


def _pieces(
    medium: AnyMedium, ray: FlatRays, light: Aimed, shape: Shape, occluders: Sequence[Occluder], where: Placement | None
) -> Pieces:
    if isinstance(medium, Medium):
        inside = chord(shape, ray)
        breaks = np.stack([inside.start, inside.end], axis=1)
    else:
        breaks = breakpoints(medium, Ray(*ray))
    if np.isinf(breaks).any():
        raise UnsupportedError("an endless ray through a medium without end: give the ray a length", "ray")
    start, end = breaks[:, :1], breaks[:, -1:]
    places, shadows = [breaks], []
    detail = getattr(medium, "detail", np.inf)
    if detail < np.inf:  # panels no wider than what a user's function says it has in store
        steps = min(int(np.ceil(np.max(end - start, initial=0.0) / detail)), PANELS)
        places.append(start + detail * np.arange(1, steps))
    for occluder in occluders:
        if isinstance(light, DirectionalLight):
            shadows.append(shadow_of_direction(occluder, ray, light.direction))
        else:
            shadows.append(shadow_of_point(occluder, ray, light.position))
    places += [np.stack(shadow, axis=1) for shadow in shadows]
    if where is not None:
        phases = [medium.phase.first, medium.phase.second] if isinstance(medium.phase, VaryingPhase) else [medium.phase]
        mu = np.concatenate([airlight_phase(phase).kinks for phase in phases])
        kinks = -where.h[:, None] * (mu / np.sqrt((1 - mu) * (1 + mu)))
        cone = edges(where, light) if isinstance(light, SpotLight) else np.empty((len(where.h), 0))
        nearest = np.zeros((len(where.h), 1))
        places.append(np.concatenate([kinks, cone, nearest], axis=1) - where.a[:, None])
    every = np.concatenate(places, axis=1)
    every = np.sort(np.where((every >= start) & (every <= end), every, start), axis=1)
    owner, k = np.nonzero(every[:, 1:] > every[:, :-1])
    low, high = every[owner, k], every[owner, k + 1]
    middle = 0.5 * (low + high)
    weight = np.ones(len(owner))
    if where is not None and isinstance(light, SpotLight):
        weight = lit_by_cone(where, light, owner, where.a[owner] + middle)
    for shadow in shadows:
        outer, dark, undark, over = (x[owner] for x in shadow)
        weight = np.where((middle > outer) & (middle < over), np.minimum(weight, 0.5), weight)
        weight = np.where((middle > dark) & (middle < undark), 0.0, weight)
    lit = weight > 0
    if where is not None:
        lit &= ~meets_light(where)[owner]
    owner, low, high, weight = owner[lit], low[lit], high[lit], weight[lit]
    span = high - low
    if where is not None:
        a, h = where.a[owner], where.h[owner]
        (r0, w0, wt0), (r1, w1, wt1) = _from_light(a + low, h), _from_light(a + high, h)
        ratio = span / (r0 + r1) * np.where(a + low >= 0, (w0 + w1) / w0, (wt0 + wt1) / wt1)
        span = np.log1p(ratio)
        span = np.where(np.isfinite(span), span, 0.0)
    return Pieces(owner, low, high, span, weight)


def _from_light(t: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return r, r + t and r - t without cancellation."""
    r = np.hypot(t, h)
    near = h * (h / (r + np.abs(t)))
    near = np.where(r > 0, near, 0.0)
    return r, np.where(t >= 0, r + t, near), np.where(t >= 0, near, r - t)


def _integrand(
    medium: AnyMedium, ray: FlatRays, light: Aimed, shape: Shape, where: Placement | None, pieces: Pieces
) -> Look:
    """Return the integrand of each piece in its variable, for a light of unit strength."""
    own = pieces.ray
    channels = medium.channels or 1
    travel = np.array(light.direction) if isinstance(light, DirectionalLight) else np.zeros(3)
    phase = medium.phase

    def survival(x: np.ndarray, direction: np.ndarray, length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Optical thickness (m, channels) of the ways, and its error."""
        if isinstance(medium, Medium) and not isinstance(shape, Unbounded):
            enter, leave = through(shape, x, direction)
            way = np.maximum(np.minimum(leave, length) - np.maximum(enter, 0.0), 0.0)
            tau = np.nan_to_num(way)[:, None] * np.atleast_1d(medium.sigma_t)
            return tau, 64 * EPS * (tau + np.atleast_1d(medium.sigma_t) * np.abs(x).max(axis=1, initial=0.0)[:, None])
        tau = thickness(medium, Ray(x, direction, length), medium.channels)
        return tau.value.reshape(-1, channels), tau.error.reshape(-1, channels) + 4 * EPS * tau.value.reshape(
            -1, channels
        )

    def scattering(x: np.ndarray, w: np.ndarray, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """sigma_s f_p (m, channels), and its error."""
        local = coefficients(medium, x, w, medium.channels).sigma_s.reshape(-1, channels)
        if isinstance(medium, Medium) and not isinstance(shape, Unbounded):
            local = np.broadcast_to(local, (len(x), channels))
        if isinstance(phase, VaryingPhase):
            first, second, q = phase_pdf(phase.first, mu), phase_pdf(phase.second, mu), share_at(phase, x)
            f, f_error = (1 - q) * first.value + q * second.value, first.error + second.error
        else:
            f, f_error = (reference := phase_pdf(phase, mu)).value, reference.error
        return local * f[:, None], local * (f_error + 8 * EPS * f)[:, None]

    def look(which: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        i = own[which]
        uncertain = np.zeros((1, 1))  # of the intensity, where that varies with the angle
        d = ray.direction[i][:, None, :]
        if where is None or isinstance(light, DirectionalLight):
            distance, jacobian = pieces.start[which, None] + u, np.ones(u.shape)
            x = ray.origin[i][:, None, :] + distance[..., None] * d
            back = np.broadcast_to(-travel, x.shape)
            way, mu = np.full(u.shape, np.inf), np.broadcast_to(np.sum(back * d, axis=-1), u.shape)
        else:
            _, w0, wt0 = _from_light(where.a[i] + pieces.start[which], where.h[i])
            w, wt = w0[:, None] * np.exp(u), wt0[:, None] * np.exp(-u)
            r, t = 0.5 * (w + wt), 0.5 * (w - wt)
            distance = np.clip(t - where.a[i][:, None], pieces.start[which, None], pieces.end[which, None])
            x = ray.origin[i][:, None, :] + distance[..., None] * d
            jacobian, mu = 1 / r, (wt - w) / (w + wt)
            if isinstance(light, SpotLight):
                aim, blur = intensity_at(where, light, i, t)
                uncertain = (jacobian * blur).reshape(-1, 1)
                jacobian = jacobian * aim
            back = np.array(light.position) - x
            length = np.linalg.norm(back, axis=-1)
            back, way = back / length[..., None], length
        flat, mu = x.reshape(-1, 3), np.clip(mu, -1, 1).ravel()
        ahead = np.broadcast_to(d, x.shape).reshape(-1, 3)
        origins = np.broadcast_to(ray.origin[i][:, None, :], x.shape).reshape(-1, 3)
        near, near_error = survival(origins, ahead, np.maximum(distance.ravel(), TINY))
        far, far_error = survival(flat, back.reshape(-1, 3), way.ravel())
        source, source_error = scattering(flat, ahead, mu)
        arrives = np.exp(-near - far) * jacobian.reshape(-1, 1)
        value, error = source * arrives, source_error * arrives
        error = error + source * np.exp(-near - far) * uncertain
        error = error + value * np.expm1(near_error + far_error + 32 * EPS)
        return value.reshape(*u.shape, channels), error.reshape(*u.shape, channels)

    return look


def _at_the_light(
    medium: AnyMedium,
    ray: FlatRays,
    light: PointLight | SpotLight,
    shape: Shape,
    occluders: Sequence[Occluder],
    which: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return inf for rays that meet the light where the medium scatters; elsewhere no method here knows the answer."""
    position = np.array(light.position)[None]
    sigma_s = coefficients(medium, position, ray.direction[which][:1], medium.channels).sigma_s.reshape(-1)
    if not which.any():
        return np.empty((0, 1)), np.empty((0, 1))
    if isinstance(light, SpotLight) or occluders or not (sigma_s > 0).all() or not contains(shape, position).all():
        raise UnsupportedError("a ray that meets the light itself, where it is not sure to be infinitely bright", "ray")
    return np.full((which.sum(), 1), np.inf), np.zeros((which.sum(), 1))
