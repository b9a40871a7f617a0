"""What trackers see of a medium: data for kernels, an array function of points, and how strong it can be."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.media import ROOM
from fogproof.scene import AnyMedium
from fogproof.scene.kinds import given
from fogproof.scene.media import box

Field = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Points (k, 3) and directions (k, 3) -> extinction (k, channels) [1/m]."""


def medium_data(medium: AnyMedium) -> Any:
    """Return a medium as data for kernels, None if only an array function is known of it."""
    data, extinction = (given(medium, ROOM, name) for name in ("kernel_data", "extinction"))
    if data is None and extinction is None:
        raise UnsupportedError(f"trackers do not know a {type(medium).__name__}", "medium")
    return data(medium) if data is not None else None


def look_ups(medium: AnyMedium) -> Field:
    """Return the extinction [1/m] as a function of points and directions (k, 3), (k, channels)."""
    extinction = given(medium, ROOM, "extinction")
    if extinction is not None:

        def field(x: np.ndarray, w: np.ndarray) -> np.ndarray:
            found: np.ndarray = extinction(medium, x, w)
            return found

        return field
    data, channels = medium_data(medium), medium.channels or 1

    def points(x: np.ndarray, w: np.ndarray) -> np.ndarray:
        from fogproof.estimators.kernels.tracking import look_up

        sigma = np.empty((len(x), channels))
        look_up(data, np.ascontiguousarray(x), sigma)
        return sigma

    return points


def grey_medium(medium: AnyMedium) -> AnyMedium:
    """Return a grey medium, or say that the estimator has no channels."""
    if medium.channels is not None:
        raise UnsupportedError(
            f"the medium has {medium.channels} channels; this estimator follows one: see SpectralFreePath", "medium"
        )
    return medium


def bounded(medium: AnyMedium) -> bool:
    """Return whether trackers find a majorant of the medium by themselves."""
    return given(medium, ROOM, "bounds") is not None


def extremes(
    medium: AnyMedium, origin: np.ndarray, direction: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return bounds of the extinction along each ray over all channels, (rays,) each."""
    name = type(medium).__name__
    if np.isinf(length).any() and not np.isfinite(box(medium)).all():
        raise UnsupportedError(
            f"a tracker would never end on an infinite ray through a {name}: give the ray a length", "ray"
        )
    bounds = given(medium, ROOM, "bounds")
    if bounds is None:
        raise UnsupportedError(f"no bound of the extinction of a {name} is known: give a majorant", "majorant")
    low, high = (np.broadcast_to(bound, length.shape) for bound in bounds(medium, origin, direction, length))
    return np.array(low), np.array(high)
