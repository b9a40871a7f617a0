"""What a light sends to the points of a ray: from which cosine, from how far, and how much before the medium takes its share."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.scene import Ray
from fogproof.scene.kinds import given
from fogproof.scene.lights import Light

ROOM = "fogproof.estimators.lights"


class Illumination(NamedTuple):
    """At points of a ray, each (n,).

    mu          forward cosine of the scattering towards the camera
    distance    of the light [m]; inf for parallel light
    irradiance  on a plane normal to the light, in vacuum [W/m^2]
    """

    mu: np.ndarray
    distance: np.ndarray
    irradiance: np.ndarray


class Sampled(NamedTuple):
    """A direction to a light with extent from each of n points.

    w         (3, n) unit vectors from the points
    distance  (n,) of the light there [m]
    arriving  (n,) its radiance over the density of w [W/m^2]
    """

    w: np.ndarray
    distance: np.ndarray
    arriving: np.ndarray


LightSampler = Callable[[np.ndarray, np.ndarray], Sampled]
"""(points (3, n), uniforms (n, 2)) -> directions to a light with extent."""


def sampler(light: Light) -> LightSampler | None:
    """Return how directions to a light with extent are drawn; None for others."""
    sample = given(light, ROOM, "sample")
    return None if sample is None else lambda x, u: sample(light, x, u)


def can_be_sampled(light: Light) -> bool:
    """Return whether each point knows where to look for the light."""
    return given(light, ROOM, "illumination") is not None or sampler(light) is not None


def met(light: Light, ray: Ray) -> float:
    """Return the distance at which a ray meets the light [m], inf if it does not."""
    distance = given(light, ROOM, "met")
    return np.inf if distance is None else float(distance(light, ray.origin, ray.direction))


def illumination(light: Light, ray: Ray) -> Callable[[np.ndarray], Illumination]:
    """Return the function of the distance s (n,) [m] from the ray's origin."""
    made = given(light, ROOM, "illumination")
    if made is None:
        raise UnsupportedError(f"a {type(light).__name__} shines from everywhere: use EnvironmentAirlight", "light")
    found: Callable[[np.ndarray], Illumination] = made(light, ray)
    return found


def towards(light: Light, x: np.ndarray) -> np.ndarray:
    """Return unit vectors (3, n) from points x (3, n) to a light with one direction a point."""
    w: np.ndarray = given(light, ROOM, "towards")(light, x)
    return w


def focus(light: Light) -> tuple[float, float, float] | None:
    """Return the point about which equiangular sampling is done; None for a light from infinitely far."""
    point = given(light, ROOM, "focus")
    return None if point is None else point(light)


def breadth(light: Light) -> float:
    """Return how close to the focus all places are alike [m]: the size of the light."""
    size = given(light, ROOM, "breadth")
    return 0.0 if size is None else float(size(light))


def foot(ray: Ray, position: tuple[float, float, float]) -> tuple[float, float]:
    """Return the distance h of a point from the ray's line [m], and the distance from the ray's origin to the foot of it."""
    towards = np.asarray(position) - ray.origin
    along = float(towards @ ray.direction)
    across = towards - along * ray.direction
    with np.errstate(over="ignore"):  # the squares of more than 1e154 m
        h = float(np.linalg.norm(across))
    return h if h < math.inf else math.hypot(*across), along


def at_a_point(position: tuple[float, float, float], intensity: float, ray: Ray, s: np.ndarray) -> Illumination:
    """Return what a light at a point sends; all is told by t, counted from the foot: r^2 = h^2 + t^2 and mu = -t/r."""
    h, along = foot(ray, position)
    t = s - along
    r2 = h * h + t * t
    r = np.sqrt(r2)
    return Illumination(-t / r, r, intensity / r2)


def to_a_point(position: tuple[float, float, float], x: np.ndarray) -> np.ndarray:
    """Return unit vectors (3, n) from points x (3, n) to one point."""
    w = np.asarray(position)[:, None] - x
    return w / np.sqrt(np.sum(w * w, axis=0))
