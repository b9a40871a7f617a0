"""From a scene's shapes, lights, phase functions and surfaces to the plain numbers that path tracing kernels work on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.grey import grey
from fogproof.estimators.kernels import path_data as data
from fogproof.estimators.kernels.data import BlockBound, Lattice, RayBound
from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.medium_data import medium_data
from fogproof.scene import AnyMedium, HenyeyGreenstein, Isotropic, Rayleigh
from fogproof.scene.kinds import given
from fogproof.scene.lights import DirectionalLight, Environment, Light, PointLight
from fogproof.scene.media import box
from fogproof.scene.shapes import Ball, Box, HalfSpace, Shape, Slab, Unbounded
from fogproof.scene.surfaces import Plane, Surface
from fogproof.validate import number


def region(shape: Shape) -> data.Region:
    """Return a shape for kernels."""
    match shape:
        case Unbounded():
            return data.Region(data.SPACE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        case HalfSpace(point, normal):
            return data.Region(data.LAYER, *normal, -np.inf, float(np.dot(normal, point)), 0.0)
        case Slab(point, normal, thickness):
            high = float(np.dot(normal, point))
            return data.Region(data.LAYER, *normal, high - thickness, high, 0.0)
        case Ball(center, radius):
            return data.Region(data.BALL, *center, radius, 0.0, 0.0)
        case Box(lower, upper):
            return data.Region(data.BOX, *lower, *upper)
    raise UnsupportedError(f"path tracing knows no {type(shape).__name__}", "shape")


def lobe(phase: Any) -> data.Lobe:
    """Return a phase function for kernels."""
    match phase:
        case Isotropic() | HenyeyGreenstein(g=0.0):
            return data.Lobe(data.ISOTROPIC, 0.0)
        case HenyeyGreenstein(g):
            return data.Lobe(data.HENYEY_GREENSTEIN, g)
        case Rayleigh():
            return data.Lobe(data.RAYLEIGH, 0.0)
    known = "isotropic, Henyey-Greenstein and Rayleigh scattering"
    raise UnsupportedError(f"path tracing knows {known}, got {type(phase).__name__}", "medium.phase")


def lamp(light: Any) -> data.Lamp:
    """Return a light for kernels."""
    match light:
        case None:
            return data.Lamp(data.DARK, 0.0, 0.0, 0.0, 0.0)
        case PointLight(position, intensity):
            return data.Lamp(data.POINT, *position, grey("intensity", intensity))
        case DirectionalLight(direction, irradiance):
            return data.Lamp(data.PARALLEL, *direction, grey("irradiance", irradiance))
        case Environment(radiance):
            return data.Lamp(data.SKY, 0.0, 0.0, 0.0, grey("radiance", radiance))
    raise UnsupportedError(f"path tracing knows no {type(light).__name__}", "light")


def unit_light(light: Light) -> Light:
    """Return the same light with a strength of 1."""
    match light:
        case DirectionalLight():
            return replace(light, irradiance=1.0)
        case Environment():
            return replace(light, radiance=1.0)
    return replace(light, intensity=1.0)


def wall(surface: Surface | None) -> data.Wall:
    """Return a surface for kernels."""
    if surface is None:
        return data.Wall(data.NOWHERE, 0.0, 0.0, 0.0, 0.0, data.LAMBERT, 0.0, 0.0)
    finish = data.MIRROR if surface.finish == "mirror" else data.LAMBERT
    place = surface.place
    if isinstance(place, Plane):
        size = float(np.dot(place.normal, place.point))
        return data.Wall(data.PLANE, *place.normal, size, finish, surface.albedo, surface.radiance)
    return data.Wall(data.SPHERE, *place.center, place.radius, finish, surface.albedo, surface.radiance)


def medium_and_bound(
    medium: AnyMedium, shape: Shape, majorant: float | MajorantGrid | None, channels: int | None = None
) -> tuple[Any, Any]:
    """Return a medium for kernels, and a bound of its extinction wherever a path can be.

    majorant  of the extinction [1/m]: a number, in blocks, or None for the medium's own, which a homogeneous one does not need
    channels  None if the kernel is one for grey light
    """
    uniform = given(medium, ROOM, "uniform")
    if uniform is not None and majorant is None:
        sigma = uniform(medium)
        if channels is None:
            return data.UniformData(float(sigma)), None
        return data.UniformSpectralData(np.array(np.broadcast_to(sigma, channels))), None
    if channels is not None and medium.channels is None:
        raise UnsupportedError("a tracked medium must have channels; trace a grey one with PathTracer", "medium")
    known = medium_data(medium)
    if known is None:
        fix = "wrap a numba function f(x, y, z) in CompiledField"
        raise UnsupportedError(f"path tracing needs a compiled medium, not a Python function; {fix}", "medium")
    if isinstance(majorant, MajorantGrid):
        majorant.require_around(medium)
        blocks = Lattice.between(majorant.lower, majorant.upper, majorant.high.shape)
        return known, BlockBound(np.zeros_like(majorant.high), np.array(majorant.high), blocks)
    if majorant is None:
        most = _greatest(medium, shape)
    else:
        most = number("majorant", majorant, "must be finite and > 0 [1/m]", 0, open_ends=True)
    lower, upper = box(medium)
    return known, RayBound(np.zeros(1), np.array([most]), lower, upper)


def _greatest(medium: AnyMedium, shape: Shape) -> float:
    """Return the greatest extinction in a shape, or a bound of it [1/m]."""
    own = given(medium, ROOM, "greatest")
    if own is None:
        what = f"no bound of the extinction of a {type(medium).__name__} is known"
        raise UnsupportedError(f"{what}: give a majorant", "majorant")
    most: float = own(medium, shape)
    return most
