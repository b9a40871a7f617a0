"""Radiance that leaves a slab lit by a uniform sky, from modes of even and odd parity, which may be complex.

The slab lies under a sky of radiance 1 on one side and nothing on the other. What is seen at cosine mu on the lit side
is, by reciprocity, the share of a beam of that cosine that is reflected; on the dark side, the share that passes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.multiple.slab_modes import FINEST, PARITIES, Modes, Parity, amplitudes, scattered


class Leaving(NamedTuple):
    """Radiance at the asked cosines (v,)."""

    reflected: np.ndarray
    transmitted: np.ndarray


def leaving_slab(modes: Modes | None, tau: float, mu0: np.ndarray) -> Leaving:
    """Return what leaves a slab of optical thickness tau at cosines mu0 (v,).

    modes  of the medium; None if it does not scatter
    """
    even, odd = (_at_surface(modes, tau, np.maximum(mu0, FINEST), parity) for parity in PARITIES)
    return Leaving(even + odd, even - odd)


def _at_surface(modes: Modes | None, tau: float, mu: np.ndarray, parity: Parity) -> np.ndarray:
    """Return the radiance that reaches the lit surface at cosines mu, half of the sky on either side.

    With odd parity the other half is negative.
    """
    straight = np.exp(-tau / mu) * (0.5 if parity == "even" else -0.5)
    if modes is None:
        return straight
    amplitude = amplitudes(modes, tau / 2, parity, np.full(len(modes.mu), 0.5))
    return straight + scattered(modes, tau / 2, parity, amplitude, mu)
