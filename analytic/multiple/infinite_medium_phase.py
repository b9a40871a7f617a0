"""The infinite medium of any phase function around an isotropic point source: sums over poles and along the cut."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import TINY
from fogproof.analytic.multiple.transport_poles import cut, poles
from fogproof.analytic.phase.functions import phase_legendre_moments
from fogproof.scene.phase import PhaseFunction

METHOD = "poles and cut of the transform"
SOURCE = "Davison & Sykes 1957, Neutron Transport Theory, chapter 17; McCormick & Kuscer 1966"

FEWEST, MOST = 64, 1024
"""Moments to begin with, and at most."""

SEEN = 1e-15
"""Moment that matters."""

STEP, FINEST, REACH = 0.125, 1 / 1024, 45.0
"""Steps along the cut to begin with, halved until nothing changes, and how far beyond where it matters; in log(u)."""

SETTLED = 1e-13
"""Relative change that is nothing."""

SAFETY, FEWER = 3.0, (0.5, 0.625, 0.75)
"""Where moments go on after the last: what the largest difference to solutions with so many of them is multiplied with."""

RELATIVE_ERROR = 1e-13
"""Of values with all moments; compared with the spectrum of 1500 moments in the tests."""

BLOCK = 256

Kernel = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""(alpha, r) -> what exp(-alpha r) counts for."""


class MomentSeries(NamedTuple):
    """The first moments of a phase function, how uncertain they are, and whether others follow."""

    chi: np.ndarray
    change: float
    go_on: bool


@lru_cache(maxsize=32)
def moments_of(phase: PhaseFunction) -> MomentSeries:
    """Return as many moments as can be seen, or the first `MOST` of them."""
    count = FEWEST
    while True:
        found = phase_legendre_moments(phase, count)
        tail = float(np.max(np.abs(found.value[3 * count // 4 :])))
        if tail < SEEN or count >= MOST:
            last = np.flatnonzero(np.abs(found.value) >= SEEN)[-1]
            chi = found.value[: max(int(last), 1) + 1]
            weight = 2 * np.arange(len(chi)) + 1
            return MomentSeries(chi, float(np.sqrt(weight @ found.error[: len(chi)] ** 2)), tail >= SEEN)
        count *= 2


def around_point_source(
    c: np.ndarray, r: np.ndarray, phase: PhaseFunction, kernel: Kernel
) -> tuple[np.ndarray, np.ndarray]:
    """Return the sum over the spectrum of kernel(alpha, r) and its error, for albedos and distances (v,)."""
    known = moments_of(phase)
    value, error = np.zeros(c.shape), np.zeros(c.shape)
    for one in np.unique(c).tolist():
        here = np.flatnonzero(c == one)
        value[here], unsettled = _sum(one, known.chi, r[here], kernel)
        doubt = 10 * known.change * one * (1 + r[here]) / (1 - one * float(known.chi[1]))
        error[here] = (RELATIVE_ERROR * (1 + r[here] / 100) + doubt) * value[here] + unsettled + TINY
        if known.go_on:
            coarser = [_sum(one, known.chi[: int(part * len(known.chi))], r[here], kernel)[0] for part in FEWER]
            error[here] += SAFETY * np.max(np.abs(coarser - value[here]), axis=0)
    return value, error


def _sum(c: float, chi: np.ndarray, r: np.ndarray, kernel: Kernel) -> tuple[np.ndarray, np.ndarray]:
    """Return the sum for distances r (v,), and by how much the last halving of the step changed it.

    What counts along the cut lies between u = 1 and u = 1/r.
    """
    far = -np.log(np.maximum(r, 1e-130))
    low, high = min(0.0, float(far.min())) - REACH, max(0.0, float(far.max())) + REACH
    found = poles(c, chi)
    discrete = _weighted(kernel, found.kappa, found.residue, r)
    step, at = STEP, np.arange(low, high, STEP)
    along = STEP * _along(c, chi, at, r, kernel)
    while True:
        finer = along / 2 + step / 2 * _along(c, chi, at + step / 2, r, kernel)
        at, step, change = np.concatenate([at, at + step / 2]), step / 2, np.abs(finer - along)
        along = finer
        if step <= FINEST or np.all(change <= SETTLED * (discrete + along)):
            return discrete + along, change


def _along(c: float, chi: np.ndarray, at: np.ndarray, r: np.ndarray, kernel: Kernel) -> np.ndarray:
    """Return the sum of density times kernel at u = e^at along the cut."""
    u = np.exp(at)
    return _weighted(kernel, 1 + u, u * cut(c, chi, u), r)


def _weighted(kernel: Kernel, alpha: np.ndarray, weight: np.ndarray, r: np.ndarray) -> np.ndarray:
    blocks = [r[start : start + BLOCK, None] for start in range(0, len(r), BLOCK)]
    return np.concatenate([kernel(alpha, some) @ weight for some in blocks])
