"""Faults that need no statistics: pixels that are no numbers, an image that is black, one that was 8 bits once."""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.verdict import Finding
from fogproof.images.picture import RenderedImage
from fogproof.images.residuals import Residuals

FINE = 1e-5
"""Relative rounding of storage up to which steps of 1/255 can be told."""


BRIGHT = 1e30
"""No radiance [W/(m^2 sr)] that anybody renders; numbers whose bytes are in the wrong order are of all sizes."""


def faults(picture: RenderedImage, found: Residuals, brightest: float, alpha: float) -> list[Finding]:
    """Return what is wrong with an image at first sight.

    brightest  the largest value that one path can bring, where that is known; inf where not
    """
    return [
        finding
        for finding in (_numbers(picture), _black(picture, found, brightest, alpha), _quantised(picture, found))
        if finding is not None
    ]


def notes(picture: RenderedImage) -> list[str]:
    """Return in words what is odd and no fault by itself."""
    told = list(picture.notes)
    size = np.where(np.isfinite(picture.value), np.abs(picture.value), 0.0)
    if size.max() > BRIGHT:
        place = _place(int(np.argmax(size)), picture)
        told.append(f"values are as large as {size.max():.3g}, at {place}: is the file's order of bytes right?")
    negative = picture.value < 0
    if not negative.any():
        return told
    least, place = float(np.nanmin(picture.value)), _place(int(np.nanargmin(picture.value)), picture)
    return [
        *told,
        f"{int(negative.sum())} values are negative, the least {least:.3g} at {place}: no radiance is; weights of both signs and"
        " filters with negative lobes make such, and bets on brightness are off",
    ]


def _numbers(picture: RenderedImage) -> Finding | None:
    bad = ~np.isfinite(picture.renders)
    if not bad.any():
        return None
    kinds = {
        "NaN": int(np.isnan(picture.renders).sum()),
        "infinite": int(np.isinf(picture.renders).sum()),
    }
    counts = ", ".join(f"{count} {name}" for name, count in kinds.items() if count)
    where = _place(int(np.argmax(bad.any(axis=0))), picture)
    message = f"{counts} of {picture.renders.size} values, the first at {where}; the others are compared"
    return Finding("numbers", "rejected", message, effect=float(bad.mean()), cause="no-number")


def _black(picture: RenderedImage, found: Residuals, brightest: float, alpha: float) -> Finding | None:
    mean = float(np.mean(found.reference[found.good])) if found.good.any() else 0.0
    if not found.good.any() or np.any(picture.renders[:, found.good]) or mean <= float(np.mean(found.allowed)):
        return None
    missed = picture.renders[..., 0].size * mean / brightest
    if missed < math.log(1 / alpha):
        message = f"every pixel is 0, the reference is {mean:.3g}: a path in {brightest / mean:.2g} brings light"
        return Finding("light", "inconclusive", message + ", and none may have; take more samples")
    return Finding("light", "rejected", f"every pixel is 0, the mean of the reference is {mean:.6g}", cause="black")


def _quantised(picture: RenderedImage, found: Residuals) -> Finding | None:
    value = picture.renders[:, found.good]
    if picture.rounding[0] > FINE or not value.size or value.min() < 0 or value.max() > 1 or len(np.unique(value)) < 3:
        return None
    steps = 255 * value
    if np.max(np.abs(steps - np.round(steps))) > 255 * 4 * max(picture.rounding[0], 1e-9):
        return None
    if np.max(np.abs(255 * found.reference[found.good] - np.round(255 * found.reference[found.good]))) < 1e-3:
        return None
    return Finding(
        "steps", "rejected", "every value is a whole number of 255ths: 8 bits, tone-mapped or not", cause="8-bit"
    )


def _place(index: int, picture: RenderedImage) -> str:
    row, column, channel = np.unravel_index(index, picture.value.shape)
    return f"row {row}, column {column}, {picture.names[channel]}"
