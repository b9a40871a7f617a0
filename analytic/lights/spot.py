"""Spot lights: where a ray enters the cone, and how the intensity varies along it.

cos(alpha) = (A + B t)/r for a point t of the ray, with A = axis . foot and B = axis . direction. With y = (t + r)/h the
edge cos(alpha) = C is a root y > 0 of (B - C) y^2 + 2 (A/h) y - (B + C) = 0, without the spurious roots of a squared
equation. Edges are taken with a margin: what lies between C - margin and C + margin may be lit or dark.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from fogproof.analytic.airlight.asinh import Gain
from fogproof.analytic.airlight.beam import Beam
from fogproof.analytic.airlight.from_a_point import from_a_point
from fogproof.analytic.airlight.integral import Method
from fogproof.analytic.airlight.ray_and_light import Placement, foot, place
from fogproof.analytic.airlight.result import Result
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.scene import AnyMedium
from fogproof.scene.lights import SpotLight
from fogproof.scene.occluders import Occluder
from fogproof.scene.shapes import Shape


def beam(light: SpotLight, ray: FlatRays, exact: bool) -> Beam:
    """Return the light for quadrature along rays."""
    where = place(ray, light.position, exact)
    outer, inner = _cosines(light)
    if inner == outer and light.exponent == 0:
        return Beam(where, edges=edges(where, light), weight=partial(lit_by_cone, where, light))
    return Beam(
        where,
        edges=edges(where, light),
        weight=partial(lit_by_cone, where, light),
        profile=partial(intensity_at, where, light),
        # An angle has a kink where a ray passes the axis, for which the airlight integral has no rule.
        gain=None if light.profile == "linear" else partial(falloff, where, light),
    )


def single_scattering(
    medium: AnyMedium,
    ray: FlatRays,
    light: SpotLight,
    shape: Shape,
    occluders: Sequence[Occluder],
    method: Method,
    exact: bool,
) -> Result | None:
    """Return the airlight integral over the lit pieces of the rays, with a bound of its error."""
    return from_a_point(medium, ray, light.position, light.intensity, beam(light, ray, exact), shape, occluders, method)


def axis_products(where: Placement, light: SpotLight) -> tuple[np.ndarray, np.ndarray]:
    """Return A [m] and B, (n,) both."""
    axis = np.array(light.direction)[:, None]
    return np.sum(axis * foot(where), axis=0), np.sum(axis * where.direction, axis=0)


def margin(where: Placement) -> np.ndarray:
    """Return how wrong the cosine of the angle from the axis may be, (n,)."""
    with np.errstate(all="ignore"):
        return 16 * EPS + 2 * where.uncertainty / where.nearest


def edges(where: Placement, light: SpotLight) -> np.ndarray:
    """Return (n, m) places t where the ray crosses edges of the cone; NaN where it does not."""
    A, B = axis_products(where, light)
    delta = margin(where)
    outer, inner = _cosines(light)
    levels = [outer - delta, outer + delta] if inner == outer else [outer - delta, outer + 0 * delta, inner + 0 * delta]
    found = [t for level in levels for t in _crossings(where.h, A, B, level)]
    if light.profile == "linear":
        with np.errstate(all="ignore"):
            closest = where.h * (where.h * B / A)  # to the axis, where the angle turns
        found.append(np.where(np.isfinite(closest), closest, np.nan))
    return np.stack(found, axis=1)


def _crossings(h: np.ndarray, A: np.ndarray, B: np.ndarray, C: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the two places t where cos(alpha) = C; NaN for those there are not."""
    with np.errstate(all="ignore"):
        A = np.where(h > 0, A / h, 0.0)
        root = np.sqrt(A * A + (B - C) * (B + C))
        q = -(A + np.copysign(root, A))
        found = []
        for y in (q / (B - C), -(B + C) / q):
            t = h * ((y - 1) * (y + 1) / (2 * y))
            found.append(np.where((y > 0) & np.isfinite(t), t, np.nan))
    return found[0], found[1]


def lit_by_cone(where: Placement, light: SpotLight, ray: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return 1 where the light may shine on the place t of the ray, 0 where not, 1/2 where its hard edge may be."""
    if light.half_angle == math.pi:
        return np.ones(t.shape)
    A, B = axis_products(where, light)
    r = np.hypot(t, where.h[ray])
    # A ray through the light itself has no edges; the angle is uncertain close to the light only.
    cosine = (A[ray] + B[ray] * t) / r
    delta = np.where(where.h[ray] > 0, margin(where)[ray], 16 * EPS + 2 * where.uncertainty[ray] / r)
    outer, inner = _cosines(light)
    if inner > outer:
        return (cosine >= outer - delta).astype(float)
    return np.where(cosine > outer + delta, 1.0, np.where(cosine < outer - delta, 0.0, 0.5))


def falloff(where: Placement, light: SpotLight, ray: np.ndarray) -> tuple[Gain, np.ndarray]:
    """Return the intensity relative to the axis along segments of the given rays, and its error, (n,), one a ray."""
    outer, inner = _cosines(light)
    A, B = axis_products(where, light)

    def factor(w: np.ndarray, wt: np.ndarray, scale: np.ndarray, segment: np.ndarray) -> np.ndarray:
        i = ray[segment]
        cosine = (2 * A[i] * scale + B[i] * (w - wt)) / (w + wt)
        return intensity(light, cosine)

    steepness = light.exponent + (1.5 / (inner - outer) if inner > outer else 0.0)
    degree = light.exponent + (3 if inner > outer else 0)
    return Gain(factor, degree, 16.0), np.minimum(1.0, steepness * margin(where))


def intensity(light: SpotLight, cosine: np.ndarray) -> np.ndarray:
    """Return the intensity relative to the axis inside the cone."""
    outer, inner = _cosines(light)
    value = np.clip(cosine, 0.0, 1.0) ** light.exponent if light.exponent else np.ones_like(cosine)
    if inner > outer and light.profile == "linear":
        start = light.half_angle if light.falloff_start is None else light.falloff_start
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        value = value * np.clip((light.half_angle - angle) / (light.half_angle - start), 0.0, 1.0)
    elif inner > outer:
        x = np.clip((cosine - outer) / (inner - outer), 0.0, 1.0)
        value = value * (x * x * (3 - 2 * x))
    return value


def intensity_at(where: Placement, light: SpotLight, ray: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the intensity relative to the axis, and its error, at lit places t (p, nodes) of rays (p,)."""
    A, B = axis_products(where, light)
    cosine, delta = (A[ray, None] + B[ray, None] * t) / np.hypot(t, where.h[ray, None]), margin(where)[ray, None]
    below, above = intensity(light, cosine - delta), intensity(light, cosine + delta)
    return intensity(light, cosine), above - below


def _cosines(light: SpotLight) -> tuple[float, float]:
    """Return the cosines of the edge of the cone and of its full part; equal for a hard edge."""
    start = light.half_angle if light.falloff_start is None else light.falloff_start
    return math.cos(light.half_angle), math.cos(start)
