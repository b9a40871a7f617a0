"""The airlight integral by Gauss-Legendre quadrature in the angle seen from the light (equiangular).

    I = 1/h int exp(-sigma (h (tan th + sec th) - a)) 4 pi f_p(-sin th) dth,    t = h tan th

The 1/r^2 disappears, but for long rays the exponential falls ever more steeply towards th = pi/2: convergence is slow
where the medium ends the ray rather than the surface.

Error estimate: the difference between 64 and 128 nodes, which is the error of 64; what the interpolant through the 128
nodes misses at the two ends, times the outermost weight, for peaks there that fall between the nodes; and rounding, of
the angle too, since tan th + sec th magnifies it near pi/2.
Source: Kulla & Fajardo 2012, Importance sampling techniques for path tracing in participating media, section 4.1.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from fogproof.analytic.airlight.phase import airlight_phase
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.errors import UnsupportedError, shorten
from fogproof.scene.phase import PhaseFunction

METHOD = "equiangular Gauss-Legendre 128"
SOURCE = "Kulla & Fajardo 2012, section 4.1"

BLOCK = 512


def integrate(
    sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, phase: PhaseFunction
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over each segment, and an estimate of its error."""
    known = airlight_phase(phase)
    if known.kinks.size or known.degree > 64:
        raise UnsupportedError(f"128 nodes do not resolve the phase function {shorten(phase)}", "phase")
    blocks = [slice(i, i + BLOCK) for i in range(0, len(h), BLOCK)]
    parts = [_block(sigma[i], h[i], a[i], b[i], phase) for i in blocks]
    value, error = np.concatenate(parts, axis=1) if parts else np.empty((2, 0))
    return value, error


def _block(sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, phase: PhaseFunction) -> np.ndarray:
    first, last = np.arctan2(a, h), np.arctan2(b, h)
    width = np.arctan2(h * (b - a), h * h + a * b)
    width = np.where(b < np.inf, width, np.arctan2(h, a))  # not pi/2 - first, which cancels
    factor = airlight_phase(phase)
    (coarse, coarse_weights), (fine, weights) = _rule(64), _rule(128)
    left, right = _ends()

    def f(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The integrand at first + width x, its relative rounding error in eps, its absolute error."""
        theta = np.minimum(first + width * x[:, None], last)
        sine, cosine = np.sin(theta), np.cos(theta)
        r = h / cosine
        w = np.where(sine > 0, r * (1 + sine), h * (cosine / (1 - sine)))
        wt = np.where(sine > 0, h * (cosine / (1 + sine)), r * (1 - sine))
        attenuation = np.where(sigma > 0, np.exp(-sigma * (w - a)), 1.0)
        rounding = 8 + sigma * (np.abs(a) + 4 * w) + sigma * w * r / h
        if factor.factor is None:
            return attenuation, rounding, np.zeros_like(w)
        if factor.noisy:
            P, noise = factor.factor(w, wt)
        else:
            P, noise = factor.factor(w, wt), factor.absolute * EPS
        slope, steep = factor.slope(-sine, -sine)
        return attenuation * P, rounding + factor.eps + 16 * slope, attenuation * (noise + 16 * EPS * steep)

    values, rounding, noise = f(fine)
    value = weights @ values
    ends = [np.abs(basis @ values - f(np.array([x]))[0][0]) for basis, x in ((left, 0.0), (right, 1.0))]
    missed = weights[0] * np.where(np.isfinite(ends), ends, 0.0).sum(axis=0)
    rounded = weights @ (values * np.where(values > 0, 20 + rounding, 0)) * EPS + weights @ noise
    error = 2 * np.abs(value - coarse_weights @ f(coarse)[0]) + 2 * missed + rounded
    return np.array([value, error]) * (width / h) + [[0.0], [4 * TINY]]


@cache
def _rule(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(n)
    return (1 + x) / 2, w / 2


@cache
def _ends() -> tuple[np.ndarray, np.ndarray]:
    """Return what turns values at 128 nodes into their interpolant at 0 and at 1 (Berrut & Trefethen 2004, sec. 6)."""
    x, w = np.polynomial.legendre.leggauss(128)
    barycentric = (-1.0) ** np.arange(128) * np.sqrt((1 - x * x) * w)
    left, right = barycentric / (-1 - x), barycentric / (1 - x)
    return left / left.sum(), right / right.sum()
