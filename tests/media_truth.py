"""What the tests compare with: slow, literal and independent of the package, in mpmath at 60 digits."""

from __future__ import annotations

import mpmath as mp
import numpy as np

DIGITS = 60


def within(reference, truth, at=()):
    """Assert that element `at` of a Reference keeps its promise |value - truth| <= error; return the relative error."""
    with mp.workdps(DIGITS):
        value, error = mp.mpf(float(reference.value[at])), mp.mpf(float(reference.error[at]))
        off = abs(value - truth)
        assert off <= error, (
            f"value {value} is off by {mp.nstr(off, 5)}, it promised {mp.nstr(error, 5)}; truth {truth}"
        )
        return float(off / truth) if truth else float(off)


def exact(x):
    """Return the exact number that a float stands for."""
    return mp.mpf(float(x)) if np.isfinite(x) else mp.inf


def fog(sigma_a, sigma_s, emission, s, ambient, background):
    """The lerp with ambient light and emission, straight from the integral of the source along the ray."""
    with mp.workdps(DIGITS + 700):  # 1 - exp(-tau) is taken literally, with tau down to 1e-600
        sigma_a, sigma_s, emission, s, ambient, background = map(
            exact, (sigma_a, sigma_s, emission, s, ambient, background)
        )
        sigma_t = sigma_a + sigma_s
        if not sigma_t:
            return background
        survived = mp.exp(-sigma_t * s) if s != mp.inf else mp.mpf(0)
        return survived * background + (sigma_s * ambient + sigma_a * emission) * (1 - survived) / sigma_t
