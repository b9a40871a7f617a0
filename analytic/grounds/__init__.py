"""What the oracle knows of each kind of ground, one module a kind, found by name. A module gives `brdf(ground, light)`.

It returns the BRDF [1/sr] and its error for directions of light in and out; everything else comes from it by quadrature, but for
`absorbed(ground, mu)`, what is not reflected of a beam, where a module gives that.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.scene.grounds import Ground
from fogproof.scene.kinds import given

ROOM = "fogproof.analytic.grounds"

MOST = 2048
"""Azimuths of a rule at most."""

FAINT = 1e-15
"""Share of the mean over azimuth that a mode may have and is left out."""


class GroundBeams(NamedTuple):
    """Cosines to the normal of where light comes from and of where it goes, and the azimuth between both ways; they broadcast."""

    mu0: np.ndarray
    mu: np.ndarray
    azimuth: np.ndarray


def ground_brdf(ground: Ground, light: GroundBeams) -> tuple[np.ndarray, np.ndarray]:
    """Return the BRDF of a ground [1/sr] and its error."""
    value, error = given(ground, ROOM, "brdf")(ground, light)
    return value, error


def ground_modes(ground: Ground, mu: np.ndarray) -> np.ndarray:
    """Return pi f_m between cosines mu (n,), where f = f_0 + 2 sum f_m cos(m azimuth): (modes, n, n), row out, column in.

    The trapezoidal rule in azimuth, with twice as many nodes until the last quarter of its modes is nothing; those left out
    are smaller still, as the BRDF is smooth and even.
    """
    count = 16
    while True:
        angle = np.pi * np.arange(count + 1) / count
        value, _ = ground_brdf(ground, GroundBeams(mu, mu[:, None], angle[:, None, None]))
        half = np.broadcast_to(value, (count + 1, len(mu), len(mu)))
        modes: np.ndarray = np.pi * np.fft.irfft(half, axis=0)[: count + 1]
        size = np.abs(modes).max(axis=(1, 2))
        faint = size <= FAINT * size[0]
        if faint[-count // 4 :].all() or 2 * count > MOST:
            return modes[: int(np.flatnonzero(~faint)[-1]) + 1] if not faint.all() else modes[:1]
        count *= 2
