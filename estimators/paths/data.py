"""From a scene's shapes, lights, phase functions and surfaces to the plain numbers that path tracing kernels work on."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.free_paths.fog import everywhere
from fogproof.estimators.kernels import path_data as data
from fogproof.estimators.kernels.data import BlockBound, Lattice, RayBound
from fogproof.estimators.media import ROOM
from fogproof.estimators.tracking.majorant_grid import MajorantGrid
from fogproof.estimators.tracking.medium_data import grey_medium, medium_data
from fogproof.scene import AnyMedium
from fogproof.scene.kinds import given
from fogproof.scene.lights import Light
from fogproof.scene.media import box
from fogproof.scene.shapes import Shape
from fogproof.scene.surfaces import Surface
from fogproof.validate import number


def region(shape: Shape) -> data.Region:
    """Return a shape for kernels."""
    made: data.Region = _given(shape, "shapes", "region", "shape")(shape)
    return made


def lamp(light: Light | None) -> data.Lamp:
    """Return a light for kernels."""
    if light is None:
        return data.Lamp(data.DARK, 0.0, 0.0, 0.0, 0.0)
    made: data.Lamp = _given(light, "lights", "lamp", "light")(light)
    return made


def wall(surface: Surface | None) -> data.Wall:
    """Return a surface for kernels."""
    if surface is None:
        return data.Wall(data.NOWHERE, 0.0, 0.0, 0.0, 0.0, data.LAMBERT, 0.0, 0.0)
    finish = data.MIRROR if surface.finish == "mirror" else data.LAMBERT
    place: tuple[int, float, float, float, float] = _given(surface.place, "surfaces", "place", "surface")(surface.place)
    return data.Wall(*place, finish, surface.albedo, surface.radiance)


def _given(thing: Any, room: str, name: str, argument: str) -> Any:
    """Return what the module of this kind gives to path tracing, or refuse the kind."""
    made = given(thing, f"fogproof.estimators.{room}", name)
    if made is None:
        raise UnsupportedError(f"path tracing knows no {type(thing).__name__}", argument)
    return made


def sources(medium: AnyMedium) -> tuple[float, float]:
    """Return albedo and emission [W/(m^2 sr)] of a grey medium; 0 for both where the kernel looks them up at each collision."""
    if looks_up(medium):
        grey_medium(medium)
        return 0.0, 0.0
    return everywhere(medium)


def looks_up(medium: AnyMedium) -> bool:
    """Return whether kernels know albedo and emission of a medium at a place."""
    return given(medium, ROOM, "kernel_sources") is not None


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
