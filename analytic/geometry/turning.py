"""By how much light is turned between two directions that are given by their cosines to a normal and an azimuth."""

from __future__ import annotations

import numpy as np


def turning(mu0: np.ndarray, mu: np.ndarray, azimuth: np.ndarray, *, turns_back: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return (1 - cos)/2 and (1 + cos)/2 of the angle between two ways, neither of which cancels; arguments broadcast.

    mu0, mu     cosines to the normal, as magnitudes
    azimuth     between the horizontal directions of both ways [rad]; 0 goes on ahead
    turns_back  whether the second way leaves on the side from which the first came
    """
    s0, s = np.sqrt((1 - mu0) * (1 + mu0)), np.sqrt((1 - mu) * (1 + mu))
    both = s + s0
    across = np.square(np.divide((mu0 - mu) * (mu0 + mu), both, out=np.zeros_like(both), where=both > 0))
    near, far = (np.square(mu - mu0) + across) / 4, (np.square(mu + mu0) + across) / 4
    away, along = s * s0 * np.sin(azimuth / 2) ** 2, s * s0 * np.cos(azimuth / 2) ** 2
    return (far + away, near + along) if turns_back else (near + away, far + along)
