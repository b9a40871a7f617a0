"""A ray through a few voxels of constant extinction, in exact numbers."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.validate import as_float_array, require

MOST_VOXELS = 64


class VoxelRay(NamedTuple):
    """Extinctions [1/m] and ways [m] of the voxels, in order."""

    sigma: list[Fraction]
    length: list[Fraction]

    @property
    def depth(self) -> float:
        """Optical depth, rounded once."""
        return float(sum((s * way for s, way in zip(self.sigma, self.length, strict=True)), Fraction(0)))


class EstimateMoments(NamedTuple):
    """Of one realisation: mean, variance and their errors, expected look-ups."""

    mean: float
    variance: float
    cost: float
    mean_error: float
    variance_error: float


def voxel_ray(sigma: Any, length: Any) -> VoxelRay:
    """Return the ray of checked arguments."""
    s, way = as_float_array("sigma", sigma), as_float_array("length", length)
    if s.ndim != 1 or not 1 <= s.size <= MOST_VOXELS:
        raise InvalidValueError("sigma", f"must be a list of 1 to {MOST_VOXELS} numbers", sigma)
    if way.shape != s.shape:
        raise InvalidValueError("length", "must be one number a voxel", length, f"there are {s.size} voxels")
    require("sigma", s, np.isfinite(s) & (s >= 0), "must be finite and >= 0 [1/m]")
    require("length", way, np.isfinite(way) & (way > 0), "must be finite and > 0 [m]")
    require("sigma", s, s * way.sum() <= 500, "must make an optical depth of at most 500 on the whole way")
    return VoxelRay([Fraction(x) for x in s.tolist()], [Fraction(x) for x in way.tolist()])
