"""A phase function that is linear between tabulated values: the cdf is quadratic in each cell, and inverted there."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.path_data import TableLobe
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import Tabulated


def _cells(phase: Tabulated) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the cosines, the values divided by their integral, and the cdf, 0 at the first cosine and 1 at the last."""
    c, f = np.array(phase.cosines), np.array(phase.values)
    upto = np.concatenate([[0.0], np.cumsum(np.pi * np.diff(c) * (f[1:] + f[:-1]))])
    return c, f / upto[-1], upto / upto[-1]


def density(phase: Tabulated, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    c, f, _ = _cells(phase)
    mu = 0.5 * (coversine - versine)
    i = np.clip(np.searchsorted(c, mu, side="right") - 1, 0, len(c) - 2)
    share = np.clip((mu - c[i]) / np.diff(c)[i], 0, 1)
    return ((1 - share) * f[i] + share * f[i + 1]).astype(
        versine.dtype
    )  # a sum of positive terms keeps its digits near 0


def cosines(phase: Tabulated, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines."""
    at = polar(phase, xi)
    np.subtract(at.coversine, at.versine, out=out)
    out *= 0.5


def polar(phase: Tabulated, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf.

    In a cell with values f0, f1 at its ends, of whose probability a share r lies below and s = 1 - r above, the density is
    root = sqrt(s f0^2 + r f1^2), and the place is r (f0 + f1)/(f0 + root) of the cell from its left and s (f0 + f1)/(f1 + root)
    from its right: no difference of close numbers in either.
    """
    c, f, cdf = _cells(phase)
    i = np.clip(np.searchsorted(cdf, xi, side="right") - 1, 0, len(c) - 2)
    mass = cdf[i + 1] - cdf[i]
    mass = np.where(mass > 0, mass, 1.0)  # a cell of no probability is met only by rounding
    r, s = np.clip((xi - cdf[i]) / mass, 0, 1), np.clip((cdf[i + 1] - xi) / mass, 0, 1)
    f0, f1, width = f[i], f[i + 1], np.diff(c)[i]
    root = np.sqrt(s * f0 * f0 + r * f1 * f1)
    from_left, from_right = _share(r * (f0 + f1), f0 + root), _share(s * (f0 + f1), f1 + root)
    versine, coversine = (1 - c[i + 1]) + width * from_right, (1 + c[i]) + width * from_left
    return Polar(versine.astype(xi.dtype), coversine.astype(xi.dtype), root.astype(xi.dtype))


def _share(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Return part / whole, 0 where both vanish: at the very end of a cell that begins with density 0."""
    return np.divide(part, whole, out=np.zeros_like(part), where=whole > 0)


def lobe(phase: Tabulated) -> TableLobe:
    """Return it for compiled kernels, exactly."""
    c, f, cdf = _cells(phase)
    return TableLobe(
        (1 - c)[::-1].copy(), (1 + c)[::-1].copy(), (1 - cdf)[::-1].copy(), f[:0:-1].copy(), f[-2::-1].copy()
    )
