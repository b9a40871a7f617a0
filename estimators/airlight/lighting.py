"""What a light sends to the points of a ray: from which cosine, from how far, and how much before the medium takes its share."""

from __future__ import annotations

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


def one_direction_a_point(light: Light) -> bool:
    """Return whether the light reaches each point from a single direction."""
    return given(light, ROOM, "illumination") is not None


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


def foot(ray: Ray, position: tuple[float, float, float]) -> tuple[float, float]:
    """Return the distance h of a point from the ray's line [m], and the distance from the ray's origin to the foot of it."""
    towards = np.asarray(position) - ray.origin
    along = float(towards @ ray.direction)
    return float(np.linalg.norm(towards - along * ray.direction)), along


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
