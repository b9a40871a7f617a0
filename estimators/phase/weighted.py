"""Weighted means of phase functions: a component is chosen by its weight, but the pdf is the weighted sum of all."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.phase.kinds import Parts, formula
from fogproof.estimators.phase.polar import Polar


def density(parts: Parts, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    total = np.zeros_like(versine)
    for weight, phase in parts:
        total += weight * formula(phase, "density")(phase, versine, coversine)
    return total


def polar(parts: Parts, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf.

    What is left of xi in the share that chose the component is uniform again; rounding must not carry it out of [0, 1).
    """
    ends = np.cumsum([weight for weight, _ in parts])
    ends /= ends[-1]
    chosen = np.minimum(np.searchsorted(ends, xi, side="right"), len(parts) - 1)
    below_one = np.nextafter(np.ones((), xi.dtype), 0)
    versine, coversine = np.empty_like(xi), np.empty_like(xi)
    start = 0.0
    for i, ((_, phase), end) in enumerate(zip(parts, ends.tolist(), strict=True)):
        at = np.flatnonzero(chosen == i)
        fresh = np.clip((xi[at] - start) / (end - start), 0, below_one) if len(at) else xi[at]
        part = formula(phase, "polar")(phase, fresh.astype(xi.dtype, copy=False))
        versine[at], coversine[at] = part.versine, part.coversine
        start = end
    return Polar(versine, coversine, density(parts, versine, coversine))
