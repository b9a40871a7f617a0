"""Directions that surfaces and their lights are sampled in: visible normals, transformed cosines, rectangles by solid angle."""

from __future__ import annotations

from functools import partial

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.outsiders.lights import Vector
from fogproof.catalogue.outsiders.subjects import Outsider, case
from fogproof.domains import UnitHemisphere, UnitSphere

_TURN = 2 * np.pi


def _unit(v: np.ndarray) -> np.ndarray:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def visible_normals(view: Vector, alpha: tuple[float, float]) -> Outsider:
    """Return the visible GGX normals of a surface of roughness (alpha_x, alpha_y), drawn by spherical caps."""
    wi, (ax, ay) = _unit(np.array(view)), alpha
    stretch = np.array([ax, ay, 1.0])
    v = _unit(stretch * wi)
    masked = 2 / (1 + np.linalg.norm(stretch * wi) / wi[2])

    def sample(u: np.ndarray) -> np.ndarray:
        z = 1 - u[:, 1] * (1 + v[2])
        s, phi = np.sqrt(np.clip(1 - z * z, 0, 1)), _TURN * u[:, 0]
        return _unit((np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1) + v) * stretch)

    def pdf(m: np.ndarray) -> np.ndarray:
        slope = np.sum((m / stretch) ** 2, axis=1)
        d = np.where(m[:, 2] > 0, 1 / (np.pi * ax * ay * slope**2), 0.0)
        return np.asarray(masked * d * np.maximum(m @ wi, 0.0) / wi[2])

    return Outsider(sample, pdf, UnitHemisphere(), 2)


def reflected_half_vectors(view: Vector, alpha: float) -> Outsider:
    """Return a view reflected at half vectors h of density D cos: below the horizon too, with the Jacobian 1 / (4 |h . wo|)."""
    wo = _unit(np.array(view))

    def normals(cosine: np.ndarray) -> np.ndarray:
        return np.asarray(alpha**2 * cosine / (np.pi * (cosine * cosine * (alpha**2 - 1) + 1) ** 2))

    def sample(u: np.ndarray) -> np.ndarray:
        z = np.sqrt((1 - u[:, 0]) / (1 - u[:, 0] * (1 - alpha**2)))
        s, phi = np.sqrt(np.clip(1 - z * z, 0, 1)), _TURN * u[:, 1]
        h = np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)
        return np.asarray(_unit(2 * (h @ wo)[:, None] * h - wo))

    def pdf(w: np.ndarray) -> np.ndarray:
        h = w + wo
        length = np.linalg.norm(h, axis=1)
        return normals(np.abs(h[:, 2]) / length) / (2 * length)  # 2 |h . wo| is the length of wo + w

    return Outsider(sample, pdf, UnitSphere(), 2)


def transformed_cosine(rows: tuple[Vector, Vector, Vector]) -> Outsider:
    """Return a linearly transformed cosine: w = M w_o / |M w_o|, whose density is that of w_o times det M^-1 / |M^-1 w|^3."""
    m = np.array(rows)
    back, size = np.linalg.inv(m), abs(np.linalg.det(m))

    def sample(u: np.ndarray) -> np.ndarray:
        r, phi = np.sqrt(u[:, 0]), _TURN * u[:, 1]
        return _unit(np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=-1) @ m.T)

    def pdf(w: np.ndarray) -> np.ndarray:
        o = w @ back.T
        length = np.linalg.norm(o, axis=1)
        return np.asarray(np.maximum(o[:, 2], 0.0) / (np.pi * size * length**4))

    return Outsider(sample, pdf, UnitSphere(), 2)


def rectangle(corner: Vector, width: float, height: float) -> Outsider:
    """Return the directions to a rectangle below the origin, parallel to x and y, even in solid angle."""
    (x0, y0, z), x1, y1 = corner, corner[0] + width, corner[1] + height
    corners = np.array([(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)])
    normals = _unit(np.cross(corners, np.roll(corners, -1, axis=0)))
    inner = np.arccos(np.clip(-np.sum(normals * np.roll(normals, -1, axis=0), axis=1), -1, 1))
    k, angle = _TURN - inner[2] - inner[3], float(inner.sum()) - _TURN
    b0, b1 = normals[0, 2], normals[2, 2]

    def sample(u: np.ndarray) -> np.ndarray:
        a = u[:, 0] * angle + k
        f = (np.cos(a) * b0 - b1) / np.sin(a)
        c = np.copysign(1 / np.sqrt(f * f + b0 * b0), f)
        x = np.clip(-c * z / np.sqrt(np.maximum(1 - c * c, 1e-300)), x0, x1)
        d = np.hypot(x, z)
        low, high = y0 / np.hypot(d, y0), y1 / np.hypot(d, y1)
        h = low + u[:, 1] * (high - low)
        return _unit(np.stack([x, np.clip(h * d / np.sqrt(1 - h * h), y0, y1), np.full_like(x, z)], axis=-1))

    def pdf(w: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            x, y = w[:, 0] * (z / w[:, 2]), w[:, 1] * (z / w[:, 2])
        slack = 1e-12 * (1 + np.abs(corners).max())
        on = (w[:, 2] < 0) & (x >= x0 - slack) & (x <= x1 + slack) & (y >= y0 - slack) & (y <= y1 + slack)
        return np.where(on, 1 / angle, 0.0)

    return Outsider(sample, pdf, UnitSphere(), 2)


def cases() -> list[SamplerCase]:
    """Return the surfaces' samplers; all run by name."""
    found = []
    for name, view, alpha in (
        ("steep", (0.1, 0.2, 1.0), (0.5, 0.5)),
        ("oblique", (0.7, 0.3, 0.35), (0.3, 0.6)),
        ("smooth", (-0.4, 0.5, 0.6), (0.02, 0.05)),
    ):
        make = partial(visible_normals, view, alpha)
        found.append(case(f"surfaces/visible-normals/{name}", f"Visible normals, {name}", make, "Dupuy & Benyoub 2023"))
    half = partial(reflected_half_vectors, (0.5, 0.3, 0.8), 0.4)
    found.append(case("surfaces/reflected-half-vectors", "Half vectors, reflected", half, "Walter et al. 2007"))
    rows = ((0.5, 0.0, 0.2), (0.0, 0.4, 0.0), (-0.3, 0.0, 1.0))
    cosine = partial(transformed_cosine, rows)
    found.append(case("surfaces/transformed-cosine", "Linearly transformed cosine", cosine, "Heitz et al. 2016"))
    for name, corner, width, height in (
        ("near", (-0.3, -0.2, -1.0), 1.2, 0.7),
        ("aside", (0.5, 1.0, -0.4), 0.6, 2.0),
    ):
        light = partial(rectangle, corner, width, height)
        title = f"Rectangle by solid angle, {name}"
        found.append(case(f"surfaces/rectangle/{name}", title, light, "Urena, Fajardo & King 2013"))
    return found
