"""Fits of hypotheses: least squares in units of the noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.errors import FogproofError
from fogproof.images.causes.image_cause import ImageCause, Sight

WINDOW = 9
"""Pixels along the side of the squares over which noise is averaged."""

STARTS, STEPS = 3, 15
"""How many of the best starts are followed, and how far."""

NEAR = 0.01
"""Of a fitted parameter: closer than this it is the value that has a name of its own."""

MIDDLES = 0.02
"""Share of the difference of a pixel's mean and its middle by which predictions from middles are taken to be off."""


@dataclass(frozen=True)
class CauseFit:
    """A fitted hypothesis: parameters, their standard errors, and the sum of squares left, in units of the noise."""

    hypothesis: ImageCause
    parameters: np.ndarray
    errors: np.ndarray
    left: float

    @property
    def told(self) -> tuple[str, str]:
        """The cause and a sentence with the fit; a value with a name of its own is called by it."""
        for value, cause, words in self.hypothesis.special:
            if abs(float(self.parameters[0]) - value) <= max(NEAR, 3 * float(self.errors[0])):
                return cause, words
        return self.hypothesis.cause, self.hypothesis.words(self.parameters)


def noise_of(sight: Sight) -> np.ndarray:
    """Return the standard deviation of the noise at the chosen pixels: as stated, or from differences of neighbours."""
    from scipy.ndimage import uniform_filter

    found = sight.found
    if sight.picture.variance is not None:
        square = np.where(np.isfinite(sight.picture.variance), sight.picture.variance, 0.0)
    elif len(sight.picture.renders) > 1:
        square = sight.picture.renders.var(axis=0, ddof=1) / len(sight.picture.renders)
        square = np.where(np.isfinite(square), square, 0.0)
    else:
        square = _third_differences(sight)
    smooth = uniform_filter(square, (WINDOW, WINDOW, 0), mode="nearest")
    allowed = found.allowed + sight.picture.rounding[0] * np.abs(found.reference)
    own = np.sqrt(np.maximum(smooth, 0.0) + allowed**2)[sight.rows, sight.columns]
    own = np.hypot(own, MIDDLES * np.abs(sight.reference - sight.centres))
    least = 1e-9 * float(np.mean(np.abs(sight.image)) + np.mean(np.abs(sight.reference))) or 1e-300
    return np.asarray(np.maximum(own, least))


def _third_differences(sight: Sight) -> np.ndarray:
    """Return squares whose mean is the noise's: what is smooth in the image, or is the reference by a factor, is none."""
    image = np.where(sight.found.good[..., None], sight.picture.value, 0.0)
    reference = np.where(sight.found.good[..., None], sight.found.reference, 0.0)
    total = float(np.sum(reference))
    rest = image - (float(np.sum(image)) / total if total > 0 else 0.0) * reference
    square, used = np.zeros_like(rest), 0
    for axis in (0, 1):
        if rest.shape[axis] > 3:
            padded = np.pad(
                np.diff(rest, 3, axis=axis), [(1, 2) if i == axis else (0, 0) for i in range(3)], mode="edge"
            )
            square, used = square + padded**2 / 20, used + 1
    return square / max(used, 1)


def fit(sight: Sight, hypothesis: ImageCause, noise: np.ndarray) -> CauseFit | None:
    """Return the best fit, or None where the hypothesis cannot be evaluated."""
    from scipy.optimize import least_squares

    if hypothesis.blur is not None:
        noise = np.hypot(noise, hypothesis.blur)

    def off(parameters: np.ndarray) -> np.ndarray:
        gap = (sight.image - hypothesis.predict(parameters)) / noise
        return np.where(np.isfinite(gap), gap, 1e6).ravel()

    try:
        with np.errstate(all="ignore"):
            if not hypothesis.starts:
                return CauseFit(hypothesis, np.zeros(0), np.zeros(0), float(np.sum(off(np.zeros(0)) ** 2)))
            starts = sorted(hypothesis.starts, key=lambda start: float(np.sum(off(np.array(start, float)) ** 2)))
            fits = [
                least_squares(off, np.array(start, float), bounds=(hypothesis.low, hypothesis.high), max_nfev=STEPS)
                for start in starts[:STARTS]
            ]
            best = min(fits, key=lambda one: float(one.cost))
            spread = np.linalg.pinv(best.jac.T @ best.jac)
    except (FogproofError, np.linalg.LinAlgError, ValueError):
        return None
    return CauseFit(hypothesis, best.x, np.sqrt(np.maximum(np.diag(spread), 0)), 2 * float(best.cost))
