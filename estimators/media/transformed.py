"""A medium moved by an affine map, for trackers: its own extinction at the place that is mapped."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.media import ROOM
from fogproof.estimators.media.sources import sources_at
from fogproof.estimators.tracking.medium_data import look_ups, medium_data
from fogproof.scene import Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import TransformedMedium, box
from fogproof.scene.shapes import EVERYWHERE, Shape


def _to_own(medium: TransformedMedium) -> np.ndarray:
    """Return the map (3, 4) from the world to the medium's own coordinates."""
    linear = np.linalg.inv(medium.to_world[:, :3])
    return np.concatenate([linear, -(linear @ medium.to_world[:, 3:])], axis=1)


def _own(medium: TransformedMedium, x: np.ndarray) -> np.ndarray:
    to_own = _to_own(medium)
    mapped: np.ndarray = x @ to_own[:, :3].T + to_own[:, 3]
    return mapped


def _along(
    medium: TransformedMedium, origin: np.ndarray, direction: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return origins and directions of rays in the medium's own coordinates, and its metres a metre of the world."""
    way = direction @ _to_own(medium)[:, :3].T
    speed = np.linalg.norm(way, axis=-1)
    way = way / speed[..., None]
    return _own(medium, origin), way / np.linalg.norm(way, axis=-1, keepdims=True), speed


def kernel_data(medium: TransformedMedium) -> Any:
    """Return the medium for kernels, None if it is an array function."""
    from fogproof.estimators.kernels.affine import AffineData

    data = medium_data(medium.medium)
    return None if data is None else AffineData(data, _to_own(medium), *box(medium.medium))


def extinction(medium: TransformedMedium, x: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return the extinction at points x along w, (k, channels) [1/m]."""
    at, way, _ = _along(medium, x, w)
    lower, upper = box(medium.medium)
    inside = np.all((at >= lower) & (at < upper), axis=1)
    found: np.ndarray = look_ups(medium.medium)(at, way) * inside[:, None]
    return found


def sources(medium: TransformedMedium, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo and emission at points x (n, 3) of a grey medium."""
    return sources_at(medium.medium, _own(medium, x))


def bounds(
    medium: TransformedMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return those of the medium along the mapped rays; 0 for the least, as the rays may leave it."""
    found = given(medium.medium, ROOM, "bounds")
    if found is None:
        what = f"no bound of the extinction of a {type(medium.medium).__name__} is known"
        raise UnsupportedError(what, "majorant")
    at, way, speed = _along(medium, origin, direction)
    most = np.broadcast_to(found(medium.medium, at, way, length * speed)[1], length.shape)
    return np.zeros(length.shape), most


def greatest(medium: TransformedMedium, shape: Shape) -> float:
    """Return what the medium may be anywhere."""
    found = given(medium.medium, ROOM, "greatest")
    if found is None:
        what = f"no bound of the extinction of a {type(medium.medium).__name__} is known"
        raise UnsupportedError(f"{what}: give a majorant", "majorant")
    most: float = found(medium.medium, EVERYWHERE)
    return most


def depth(medium: TransformedMedium, ray: Ray, t: np.ndarray) -> np.ndarray:
    """Return the optical depth along the mapped ray, (n, channels); metres of the world count."""
    from fogproof.estimators.free_paths import extinction as closed_forms

    at, way, speed = _along(medium, ray.origin, ray.direction)
    own = given(medium.medium, ROOM, "depth")
    mapped = Ray(at, way, ray.length * speed)
    if own is not None:
        found: np.ndarray = own(medium.medium, mapped, t * speed) / speed
        return found
    return closed_forms.along(medium.medium, mapped).depth(t * speed)[:, None] / speed
