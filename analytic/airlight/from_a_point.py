"""Airlight of a light at a point in a homogeneous medium: the airlight integral over the lit pieces of each ray.

    L = sigma_s I / (4 pi) int exp(-sigma_t (s + r)) 4 pi f_p(mu) / r^2 dt        [W/(m^2 sr)]

Cones and shadows cut a ray into pieces. A piece that may be lit or dark, because an edge is uncertain by rounding, counts
half, and the other half is error.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.analytic.airlight import asinh as airlight_asinh
from fogproof.analytic.airlight.beam import Beam
from fogproof.analytic.airlight.integral import Method, integrate, refuse_beyond
from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.airlight.ray_and_light import Placement, moved
from fogproof.analytic.airlight.result import Result
from fogproof.analytic.airlight.segments import Segments, cut
from fogproof.analytic.arithmetic.error_free import EPS, TINY, two_sum
from fogproof.analytic.arithmetic.vectors import norm
from fogproof.analytic.geometry.convex_shapes import Chord, chord, contains
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.geometry.shadows import Shadow, shadow_of_point
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium, Isotropic
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape
from fogproof.validate import Channels


def from_a_point(
    medium: AnyMedium,
    ray: FlatRays,
    position: tuple[float, float, float],
    intensity: Channels,
    beam: Beam,
    shape: Shape,
    occluders: Sequence[Occluder],
    method: Method,
) -> Result | None:
    """Return the radiance (n, channels) along the flattened rays, its error, method and source.

    None if the medium is not homogeneous, the light is outside of it, or its intensity varies in another way than `Gain` knows.
    """
    where = beam.where
    if not is_uniform(medium) or where is None or not contains(shape, np.array(position)):
        return None
    if beam.profile is not None and (beam.gain is None or airlight_phase(medium.phase).peak == np.inf):
        return None
    sigma, sigma_low = (np.atleast_1d(x) for x in two_sum(medium.sigma_a, medium.sigma_s))
    with np.errstate(all="ignore"):
        inside = chord(shape, ray)
        shadows = [shadow_of_point(occluder, ray, position) for occluder in occluders]
        segments, owner, weight = _lit(where, inside, beam, shadows)
        pieces = _with_channels(segments, sigma, sigma_low)
        share = np.repeat(weight, len(sigma))

        def gather(x: np.ndarray) -> np.ndarray:
            """Sum over the pieces of each ray."""
            if segments.h is where.h:  # nothing is cut
                return x.reshape(-1, len(sigma))
            total = np.zeros((len(where.h), len(sigma)))
            np.add.at(total, owner, (x * share).reshape(-1, len(sigma)))
            return total

        phase = airlight_phase(medium.phase)
        gain, gain_error = (None, np.zeros(len(where.h)))
        if beam.gain is not None:
            gain, gain_error = beam.gain(np.repeat(owner, len(sigma)))
        if gain is None:
            value, error, name, source = integrate(pieces, medium.phase, method)
        elif method == "asinh":
            value, error = airlight_asinh.integrate(pieces, phase, gain)
            name, source = airlight_asinh.METHOD, airlight_asinh.SOURCE
        else:
            raise UnsupportedError(f"method {method!r} knows no spot light with a fall-off; use 'asinh'", "method")
        maybe = value * (1 - share) / share  # what the other half may be
        integral, error = gather(value), gather(error + maybe) + len(occluders) * EPS * gather(value)
        refuse_beyond(method, integral, error)

        relative, steep = moved(where, sigma, phase)
        relative = relative + np.expm1(sigma * (inside.sure_start - inside.start)[:, None])
        error = error + np.where(integral > 0, integral * relative, 0.0)
        absolute = steep + np.where(gain_error > 0, phase.peak * gain_error, 0.0)[:, None]
        if absolute.any():
            plain = gather(airlight_asinh.integrate(pieces, airlight_phase(Isotropic()))[0])
            error = error + np.where(plain > 0, plain * absolute, 0.0)
        scale = np.multiply(medium.sigma_s, intensity) / (4 * np.pi)
        value = np.where(scale > 0, integral * scale, 0.0)
        error = np.where((scale > 0) & (value < np.inf), error * scale + 3 * EPS * value + TINY, 0.0)
    return value, error, name, source


def _lit(where: Placement, inside: Chord, beam: Beam, shadows: list[Shadow]) -> tuple[Segments, np.ndarray, np.ndarray]:
    """Return the lit pieces, the rays they belong to, and 1, or 1/2 for those that may be dark or outside.

    The attenuation starts where the ray enters the medium.
    """
    none = np.zeros(where.h.shape)
    start, end = where.a + (where.a_low + inside.start), where.a + (where.a_low + inside.end)
    start, end = np.where(inside.start == 0, where.a, start), np.where(inside.end == where.length, where.b, end)
    camera_low = np.where(inside.start == 0, where.a_low, 0.0)
    near, near_low = where.near, where.near_low
    if inside.start.any():
        near, near_low = norm((start, where.h), (camera_low, where.h_low))
    length = inside.end - inside.start
    whole = Segments(none, none, where.h, where.h_low, start, camera_low, start, end, length, near, near_low)
    unsure = (inside.sure_start > inside.start) | (inside.sure_end < inside.end)
    if not (shadows or beam.weight or unsure.any()):
        return whole, np.arange(len(where.h)), np.ones(len(where.h))

    places = [where.a[:, None] + np.stack(shadow, axis=1) for shadow in shadows]
    places.append(where.a[:, None] + np.stack([inside.sure_start, inside.sure_end], axis=1))
    if beam.edges is not None:
        places += [beam.edges, np.where(where.h == 0, 0.0, np.nan)[:, None]]
    pieces, owner = cut(whole, np.concatenate(places, axis=1))
    middle = _middle(pieces)
    distance = middle - where.a[owner]
    sure = (distance > inside.sure_start[owner]) & (distance < inside.sure_end[owner]) | ~unsure[owner]
    weight = np.where(sure, 1.0, 0.5)
    if beam.weight is not None:
        weight = np.minimum(weight, beam.weight(owner, middle))
    for shadow in shadows:
        outer, dark, undark, over = (x[owner] for x in shadow)
        weight = np.where((distance > outer) & (distance < over), np.minimum(weight, 0.5), weight)
        weight = np.where((distance > dark) & (distance < undark), 0.0, weight)
    lit = weight > 0
    return Segments(*(x[lit] for x in pieces)), owner[lit], weight[lit]


def _middle(pieces: Segments) -> np.ndarray:
    """Return a place inside each piece: halfway in asinh(t/h), which is finite for an endless one too, or halfway."""
    h, start, end = pieces.h, pieces.start, pieces.end
    far = np.where(end < np.inf, end, np.maximum(1.0, 4 * np.abs(start)) + 4 * h)
    middle = h * np.sinh(0.5 * (np.arcsinh(start / h) + np.arcsinh(far / h)))
    return np.where((middle > start) & (middle < end), middle, 0.5 * (start + far))


def _with_channels(segments: Segments, sigma: np.ndarray, sigma_low: np.ndarray) -> Segments:
    """Return each segment once a channel, with that channel's extinction."""
    if len(sigma) == 1:
        return segments._replace(sigma=segments.sigma + sigma, sigma_low=segments.sigma_low + sigma_low)
    count = len(segments.h)
    repeated = Segments(*(np.repeat(x, len(sigma)) for x in segments))
    return repeated._replace(sigma=np.tile(sigma, count), sigma_low=np.tile(sigma_low, count))
