"""OpenGL's fogs for trackers and samplers: functions of the distance from the eye."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.free_paths.extinction import Constant, Extinction, Linear, Vanishing
from fogproof.scene import OpenGLFog, Ray

EXP, EXP2, LINEAR = range(3)
MODES = {"exp": EXP, "exp2": EXP2, "linear": LINEAR}


class FogData(NamedTuple):
    """One of three modes about an eye (3,); density [1/m], start and end [m]."""

    mode: int
    density: float
    start: float
    end: float
    eye: np.ndarray

    @staticmethod
    def extinction(medium: Any, channel: int, x: float, y: float, z: float) -> float:
        """Return the extinction at a point [1/m]; in kernels only."""
        if medium.mode == EXP:
            return medium.density
        r = np.sqrt((x - medium.eye[0]) ** 2 + (y - medium.eye[1]) ** 2 + (z - medium.eye[2]) ** 2)
        if medium.mode == EXP2:
            return 2.0 * medium.density * medium.density * r
        if r < medium.start:
            return 0.0
        return 1.0 / (medium.end - r) if r < medium.end else np.inf


def kernel_data(medium: OpenGLFog) -> FogData:
    """Return the medium for kernels."""
    return FogData(MODES[medium.mode], medium.density, medium.start, medium.end, np.array(medium.eye))


def along(medium: OpenGLFog, ray: Ray) -> Extinction:
    """Return the extinction along a ray from the eye."""
    if not np.array_equal(ray.origin, medium.eye):
        raise UnsupportedError("the fog of OpenGL is defined for rays from the eye only", "ray.origin")
    match medium.mode:
        case "exp":
            return Constant(medium.density)
        case "exp2":
            return Linear(0.0, 2 * medium.density**2)
    return Vanishing(medium.start, medium.end)


def bounds(
    medium: OpenGLFog, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return 0 and what is at the farther end of each ray; linear fog is infinitely dense at its own end."""
    ends = np.stack([origin, origin + length[:, None] * direction])
    r = np.sqrt(np.sum((ends - medium.eye) ** 2, axis=-1)).max(axis=0)
    return np.zeros_like(r), _extinction(medium, r)


def _extinction(medium: OpenGLFog, r: np.ndarray) -> np.ndarray:
    """Return the extinction at distances from the eye [1/m]."""
    match medium.mode:
        case "exp":
            return np.full_like(r, medium.density)
        case "exp2":
            return 2 * medium.density**2 * r
    within = (r >= medium.start) & (r < medium.end)
    beyond = np.where(r < medium.start, 0.0, np.inf)
    return np.divide(1.0, medium.end - r, out=beyond, where=within)


def depth_towards(medium: OpenGLFog, x: np.ndarray, w: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the optical depth of many ways that need not start at the eye, and one look each.

    Along a line r^2 = p^2 + t^2. "exp2" has the area under a hyperbola; "linear" the integral of 1/(end - r) outside of the sphere
    where the fog begins, and no end to it beyond the one where it ends.
    """
    offset = x - medium.eye[:, None]
    start = np.sum(offset * w, axis=0)
    p = np.sqrt(np.maximum(np.sum((offset - start * w) ** 2, axis=0), 0.0))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        stop = start + way
        match medium.mode:
            case "exp":
                depth = medium.density * way if medium.density > 0 else np.zeros_like(way)
            case "exp2":
                depth = medium.density**2 * (_hyperbola(stop, p) - _hyperbola(start, p))
            case _:
                depth = _linear_depth(medium.start, medium.end, start, stop, p)
    return depth, np.ones_like(way)


def _hyperbola(t: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return twice the integral of sqrt(p^2 + t^2) from 0 to t."""
    bent = p * p * np.arcsinh(t / np.where(p > 0, p, 1.0))
    return t * np.hypot(t, p) + np.where(p > 0, bent, 0.0)


def _linear_depth(begin: float, end: float, start: np.ndarray, stop: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return the integral of 1/(end - r) over what lies outside of r = begin; inf if the way leaves r < end."""
    leaves = (np.hypot(start, p) >= end) | (np.hypot(stop, p) >= end)
    half = np.sqrt(np.maximum(begin * begin - p * p, 0.0))  # half of the chord through the clear ball
    p = np.maximum(p, 1e-9 * end)
    parts = [(start, np.minimum(stop, -half)), (np.maximum(start, half), stop)]
    if not half.any():
        parts = [(start, stop)]
    total = np.zeros_like(p)
    for low, high in parts:
        total += np.where(high > low, _primitive(high, p, end) - _primitive(low, p, end), 0.0)
    return np.where(leaves, np.inf, total)


def _primitive(t: np.ndarray, p: np.ndarray, end: float) -> np.ndarray:
    """Return the integral of 1/(end - sqrt(p^2 + t^2)) from 0 to t, by t = p sinh u."""
    tangent = t / (p + np.hypot(t, p))  # tanh(u/2)
    steep = np.sqrt((end + p) / (end - p))
    return 2 * end / np.sqrt((end - p) * (end + p)) * np.arctanh(steep * tangent) - np.arcsinh(t / p)
