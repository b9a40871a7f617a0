"""The inverse of a distribution of cosines, found by a bracketing root finder and certified afterwards.

The root finder's answer is a guess. Around it an interval is sought at whose ends the distribution, its own error
counted, lies below xi and not below it: the true quantile is inside, whatever the guess was. Its middle is returned.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS


def inverse_cdf(
    cdf: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], xi: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest mu in [-1, 1] with cdf(mu) >= xi, and its absolute error.

    cdf  maps (n,) cosines to values and errors
    xi   (n,) probabilities
    """
    from scipy.optimize.elementwise import find_root

    guess = find_root(lambda mu, target: cdf(mu)[0] - target, (-np.ones_like(xi), np.ones_like(xi)), args=(xi,)).x
    # No sign change, hence no root, only where rounding of the cdf at an end hides it.
    guess = np.where(np.isfinite(guess), np.clip(guess, -1, 1), np.where(xi < 0.5, -1.0, 1.0))

    def below(mu: np.ndarray, target: np.ndarray) -> np.ndarray:
        value, error = cdf(mu)
        return (mu == -1) | (value + error < target)

    def not_below(mu: np.ndarray, target: np.ndarray) -> np.ndarray:
        value, error = cdf(mu)
        return (mu == 1) | (value - error >= target)

    low = _step_out(guess, -1.0, below, xi)
    high = np.where(xi > 0, _step_out(guess, 1.0, not_below, xi), -1.0)
    low = np.minimum(low, high)
    mu = low + (high - low) / 2
    return mu, np.maximum(high - mu, mu - low)


def _step_out(
    mu: np.ndarray, direction: float, reached: Callable[[np.ndarray, np.ndarray], np.ndarray], target: np.ndarray
) -> np.ndarray:
    """Return points on one side of mu, at distances doubled until `reached` holds or the end of [-1, 1] is met."""
    step = np.full_like(mu, 2 * EPS)
    point = np.clip(mu + direction * step, -1, 1)
    left = np.flatnonzero(~reached(point, target))
    while left.size:
        step[left] *= 2
        point[left] = np.clip(mu[left] + direction * step[left], -1, 1)
        left = left[~reached(point[left], target[left])]
    return point
