"""Pixels that depend on each other: a filter wider than a pixel, a denoiser, blue noise, random numbers that pixels share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fogproof.images.residuals import Residuals

CERTAIN = 6.0
"""Standard deviations of a correlation that is taken for one: once in 10^9 by chance."""

SIDE = 8
"""Pixels along a cell that is tested as one where neighbours depend on each other."""

Kind = Literal["independent", "neighbours", "anticorrelated", "shared"]


@dataclass(frozen=True)
class Dependence:
    """How pixels depend on each other, and in words how that is known; z is in standard deviations of chance."""

    kind: Kind
    z: float
    words: str = ""


def dependence(renders: np.ndarray, found: Residuals) -> Dependence:
    """Return how the noise of pixels depends on that of others.

    renders     (n, rows, columns, channels); two or more independent ones tell noise from bias
    found       residuals: in one render, differences of neighbours show noise alone where bias is smooth

    Noise is taken relative to the brightness, so that no bright pixel stands for all.
    """
    size = np.abs(found.reference) + (0.1 * float(np.mean(np.abs(found.reference))) or 1.0)
    difference = _scaled(found.difference / size)
    if len(renders) > 1:
        pairs = renders[0 : len(renders) // 2 * 2 : 2] - renders[1::2]
        noise = _scaled(np.where(np.isfinite(pairs), pairs, 0.0) / size)
        near = [_z(noise[:, :, 1:] * noise[:, :, :-1]), _z(noise[:, 1:] * noise[:, :-1])]
        square = np.sum(noise * noise, axis=(1, 2))
        total = np.sum(noise, axis=(1, 2)) ** 2 / np.where(square > 0, square, 1.0)
        wide = float(np.sum(total) - total.size) / math.sqrt(2 * total.size)
        # chi-square with as many degrees of freedom: far out it falls like exp(-x/2), not like a normal law.
        if np.max(total) > 2 * CERTAIN**2 or wide > 2 * CERTAIN:
            return Dependence(
                "shared", wide, "the sum over an image scatters more than its pixels do: they share random numbers"
            )
    else:
        steps = difference[:, 1:] - difference[:, :-1], difference[1:] - difference[:-1]
        # The steps 0-1 and 2-3 have covariance -c1 + 2 c2 - c3: the sign of the neighbours' is turned.
        near = [-_z(steps[0][:, 2:] * steps[0][:, :-2]), -_z(steps[1][2:] * steps[1][:-2])]
    z = max(near, key=abs)
    if z > CERTAIN:
        words = "the noise of neighbours is alike: a filter wider than a pixel, a denoiser, or shared random numbers"
        return Dependence("neighbours", z, words)
    if z < -CERTAIN:
        return Dependence(
            "anticorrelated", z, "the noise of neighbours is opposed, as blue noise is: means are better than told"
        )
    return Dependence("independent", z)


def _scaled(x: np.ndarray) -> np.ndarray:
    """Return noise in units of its largest value: no product of two overflows, and nothing that is asked of it has a scale."""
    largest = float(np.max(np.abs(x), initial=0.0))
    return x / largest if 0 < largest < math.inf else x


def _z(products: np.ndarray) -> float:
    """Return a sum of products of mean 0 in standard deviations; large ones may not stand for all."""
    flat = products.ravel()
    square = float(np.sum(flat * flat))
    if square == 0 or np.max(np.abs(flat)) ** 2 > 0.1 * square:
        return 0.0
    return float(np.sum(flat)) / math.sqrt(square)


def in_cells(found: Residuals) -> Residuals:
    """Return the residuals as means over cells of `SIDE` x `SIDE` pixels, which hardly depend on each other; rests are cut off."""
    rows, columns = found.difference.shape[:2]
    side = max(1, min(SIDE, rows // 2, columns // 2))
    rows, columns = rows // side * side, columns // side * side

    def mean(x: np.ndarray) -> np.ndarray:
        cut = x[:rows, :columns].reshape(rows // side, side, columns // side, side, -1)
        averaged: np.ndarray = cut.mean(axis=(1, 3))
        return averaged

    good = mean(found.good[..., None].astype(float))[..., 0]
    share = np.where(good > 0, good, 1.0)[..., None]
    masked = [np.where(found.good[..., None], x, 0.0) for x in (found.difference, found.allowed, found.reference)]
    difference, allowed, reference = (mean(x) / share for x in masked)
    return Residuals(difference, allowed, reference, good > 0)
