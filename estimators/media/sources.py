"""Albedo and emission at points, where they may differ from place to place."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import UnsupportedError
from fogproof.estimators.media import ROOM
from fogproof.scene import AnyMedium
from fogproof.scene.kinds import given
from fogproof.scene.media import sources_vary


def sources_at(medium: AnyMedium, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return albedo and emission [W/(m^2 sr)] of a grey medium at points x (n, 3), (n,) each."""
    own = given(medium, ROOM, "sources")
    if own is not None:
        albedo, emission = own(medium, x)
    elif sources_vary(medium):
        raise UnsupportedError(f"nobody knows where the sources of a {type(medium).__name__} are", "medium")
    else:
        albedo, emission = medium.albedo, medium.emission
    return np.broadcast_to(albedo, len(x)), np.broadcast_to(emission, len(x))


def looked_up(value: Any, x: np.ndarray) -> Any:
    """Return what a constant or a function of points gives at points x (n, 3)."""
    return value(x) if callable(value) else value
