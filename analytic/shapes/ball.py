"""The ball."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.arithmetic.gauss_legendre import NODES, WEIGHTS
from fogproof.analytic.geometry.flat_rays import FlatRays
from fogproof.analytic.lights.environment import Answer, on_interval, over_directions
from fogproof.errors import UnsupportedError
from fogproof.scene.phase import PhaseFunction
from fogproof.scene.shapes import Ball

LARGEST_DEPTH = 2e4
"""Optical radius of a ball beyond which the quadrature for parallel light would take too many panels."""


def through(
    shape: Ball, origin: np.ndarray, direction: np.ndarray, margin: np.ndarray | float
) -> tuple[np.ndarray, np.ndarray]:
    """Return where lines enter and leave the ball, its radius larger by `margin`; NaN if they miss it."""
    q = origin - np.array(shape.center)
    middle = -np.sum(q * direction, axis=-1)
    distance = np.linalg.norm(q + middle[..., None] * direction, axis=-1)
    radius = shape.radius + margin
    half = np.sqrt((radius - distance) * (radius + distance))
    return middle - half, middle + half


def size(shape: Ball) -> float:
    """Return the largest coordinate."""
    return float(np.abs(shape.center).max() + shape.radius)


def mean_chord(shape: Ball) -> float:
    """Return 4 V/S [m]."""
    return 4 * shape.radius / 3


def parallel_light(
    shape: Ball,
    ray: FlatRays,
    travel: np.ndarray,
    sigma: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    owner: np.ndarray,
    enter: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return int exp(-sigma path) dt over each piece, (p, channels), and its error."""
    R, v = shape.radius, travel
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
        error[i] = (f * np.expm1(sigma[:, None, None] * blur)).sum(axis=(1, 2)) + 64 * EPS * value[i]
        if lost[i] > 0:  # at the ends: no more arrives from there than this
            ends, scale = np.array([start[i], end[i]]), np.abs(origin[i]).max() + R
            gap = np.sum((Q0[i] + ends[:, None] * Q1[i]) ** 2, axis=1)
            half = np.sqrt(np.maximum(R * R - gap - 64 * EPS * scale * scale, 0.0))
            ways = ends - enter[owner[i]] + np.maximum(origin[i] @ v + ends * (d[i] @ v) + half, 0.0)
            error[i] += lost[i] * np.exp(-sigma * max(float(ways.min()) - 16 * EPS * scale, 0.0))
    return value, error + TINY


def environment(
    shape: Ball,
    phase: PhaseFunction,
    origin: np.ndarray,
    d: np.ndarray,
    sigma: np.ndarray,
    start: float,
    end: float,
    fine: int,
) -> Answer:
    """Return the integral along the ray of the integral over directions, per channel, and what f_p's error is of it."""
    value, spread = np.zeros((2, len(sigma)))
    t, weights = on_interval(np.array(start), np.array(end), fine)
    for one, weight in zip(t, weights, strict=True):
        q = origin - np.array(shape.center) + one * d
        distance = float(np.linalg.norm(q))
        mu0 = float(np.clip(q @ d / distance, -1, 1)) if distance > 0 else 1.0
        room = max((shape.radius - distance) * (shape.radius + distance), 0.0)

        def survival(cosine: np.ndarray, distance: float = distance, room: float = room) -> np.ndarray:
            """exp(-sigma d), d = sqrt(c^2 + R^2 - r^2) - c with c = r cos, without cancellation."""
            c = distance * cosine
            root = np.sqrt(c * c + room)
            way = np.where(c > 0, room / (root + c), root - c)
            return np.exp(-sigma * way[..., None])

        received, noise = over_directions(phase, mu0, survival, fine)
        lit = weight * np.exp(-sigma * (one - start))
        value += lit * received
        spread += lit * noise
    return value, spread
