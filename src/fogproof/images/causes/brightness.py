"""Brightness that is no longer linear: a tone curve, a clamp, something added."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.images.causes.image_cause import ImageCause, Sight, fixed


def hypotheses(sight: Sight) -> Iterator[ImageCause]:
    """Yield curves of brightness."""
    reference = sight.reference
    top, mean = float(np.max(reference)), float(np.mean(reference))
    if not top > 0:
        return
    yield fixed("tone-curve", lambda: srgb(reference), "the pixels are sRGB-encoded, not linear")
    yield fixed("tone-curve", lambda: reference / (1 + reference), "the pixels are x/(1 + x), Reinhard's tone curve")
    yield ImageCause("added", lambda p: reference + p[0], lambda p: f"{p[0]:+.4g} is added to every pixel", ((0.0,),))
    if np.ptp(reference) > 0:
        yield ImageCause(
            "tone-curve",
            lambda p: np.maximum(reference, 0) ** p[0],
            lambda p: (
                f"the pixels are the reference to the power of {p[0]:.4g}"
                + (f" = 1/{1 / p[0]:.3g}" if p[0] < 0.9 else "")
            ),
            ((0.45,), (0.9,), (1.1,), (2.2,)),
            0.05,
            20,
        )
        yield ImageCause(
            "clamped",
            lambda p: np.minimum(reference, p[0]),
            lambda p: f"pixels are cut off at {p[0]:.4g}",
            ((1.0,), (0.5 * top,), (0.9 * top,), (mean,)),
            1e-6 * top,
            top,
        )


def srgb(x: np.ndarray) -> np.ndarray:
    """Return linear values in [0, 1] by the curve of IEC 61966-2-1."""
    cut = np.clip(x, 0, 1)
    encoded: np.ndarray = np.where(cut <= 0.0031308, 12.92 * cut, 1.055 * cut ** (1 / 2.4) - 0.055)
    return encoded
