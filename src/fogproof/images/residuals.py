"""What an image has that its reference has not, and how much of that is allowed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.images.picture import RenderedImage

DITHERED = 2.0
"""Half units in the last place by which a pixel is off, beyond which noise has made its rounding random."""


@dataclass(frozen=True)
class Residuals:
    """Differences of an image and its reference, (rows, columns, channels) each.

    difference  image - reference, 0 where a pixel is no number
    allowed     what the difference may be without noise: error of the reference, rounding, tolerance
    reference   the reference
    good        (rows, columns) which pixels are numbers
    """

    difference: np.ndarray
    allowed: np.ndarray
    reference: np.ndarray
    good: np.ndarray


def residuals(picture: RenderedImage, value: np.ndarray, error: np.ndarray, tolerance: float) -> Residuals:
    """Return the differences from a reference (rows, columns, channels) known to within `error`.

    tolerance  relative error that does not matter

    A pixel's rounding is an error of its own where the pixel is closer to the reference than two such roundings; noise that is
    larger makes roundings random, and they cancel.
    """
    good = np.isfinite(picture.renders).all(axis=(0, 3)) & np.isfinite(value).all(axis=2)
    with np.errstate(invalid="ignore"):
        difference = np.where(good[..., None], picture.value - value, 0.0)
    relative, step = picture.rounding
    rounding = relative * np.abs(value) + step
    fine = np.abs(difference) > DITHERED * rounding
    allowed = error + tolerance * np.abs(value) + np.where(fine, 0.0, rounding)
    return Residuals(difference, np.where(good[..., None], allowed, 0.0), value, good)
