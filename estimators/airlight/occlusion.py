"""Shadow rays: does anything opaque stand between points and a light?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogproof.scene.kinds import given
from fogproof.scene.occluders import Occluder


def lit(occluders: Sequence[Occluder], x: np.ndarray, w: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return (n,) whether the way from points x (3, n) along unit vectors w (3, n) is free for `distance` (n,) [m]."""
    free = np.ones(x.shape[1], dtype=bool)
    for occluder in occluders:
        free &= ~given(occluder, "fogproof.estimators.occluders", "meets")(occluder, x, w, distance)
    return free
