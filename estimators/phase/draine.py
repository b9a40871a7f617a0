"""Draine's phase function (Draine 2003), Henyey-Greenstein times 1 + alpha mu^2; alpha = 1 is Cornette & Shanks 1992.

Let w be the Henyey-Greenstein cdf of mu, so that mu(w) is its stable inverse. Under the law wanted, w has the density
(1 + alpha mu(w)^2)/(1 + alpha (1 + 2 g^2)/3): never far from 1 when alpha is moderate, and its integral is rational in w,
with no division by g. That is inverted by Newton's method from the side where it cannot overshoot.
(Jendersie & d'Eon 2023 solve the equivalent quartic, which divides by g.)
"""

from __future__ import annotations

import numpy as np

from fogproof.estimators.phase import henyey_greenstein
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import CornetteShanks, Draine, HenyeyGreenstein

_MOST_STEPS = 64  # far fewer are taken but where alpha is huge and mu nearly 0, where the cdf is flat to third order


def _parameters(phase: Draine | CornetteShanks) -> tuple[float, float, float]:
    """Return g and the weights c0, c1 of 1 and mu^2 in the density of w."""
    alpha = phase.alpha
    norm = 1 + alpha * (1 + 2 * phase.g**2) / 3
    return phase.g, 1 / norm, alpha / norm


def density(phase: Draine | CornetteShanks, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function [1/sr]."""
    g, c0, c1 = _parameters(phase)
    mu = 0.5 * (coversine - versine)
    return (c0 + c1 * mu * mu) * henyey_greenstein.density(HenyeyGreenstein(g), versine, coversine)


def cosines(phase: Draine | CornetteShanks, xi: np.ndarray, out: np.ndarray) -> None:
    """Write forward cosines."""
    at = polar(phase, xi)
    np.subtract(at.coversine, at.versine, out=out)
    out *= 0.5


def polar(phase: Draine | CornetteShanks, xi: np.ndarray) -> Polar:
    """Return scattering angles and their pdf.

    For g < 0 the law is mirrored. Up to the median of w the unknown is w; above it, 1 - w, which is the same problem for -g:
    so the unknown keeps its relative precision at both poles.
    """
    g, c0, c1 = _parameters(phase)
    k, xi = (g, xi) if g >= 0 else (-g, 1 - xi)
    root = np.sqrt(1 + k * k)
    turn = (1 - k) / (root * ((1 + k) + root))  # the Henyey-Greenstein cdf at mu = 0, at most 1/2
    at_turn, at_half = (float(_cdf(np.array(w), np.array(k), c0, c1)) for w in (turn, 0.5))
    low, high = xi < at_turn, xi >= at_half
    signed = np.where(high, -k, k).astype(xi.dtype)
    # The density of w falls towards mu = 0: Newton's steps from 0, or from 1/2 down to the turning point, stay on their side.
    least, most = np.where(low | high, 0, turn), np.where(low, turn, 0.5)
    target = np.where(high, 1 - xi, xi)
    start = np.where(low | high, target / (c0 + c1), 0.5)
    w = _root(target, start.astype(xi.dtype), signed, least.astype(xi.dtype), most.astype(xi.dtype), c0, c1)
    d2 = _d(w, signed) ** 2
    lower = 2 * (1 + signed) ** 2 * w * ((1 - signed) + signed * w) / d2
    upper = 2 * (1 - signed) ** 2 * (1 - w) * (1 + signed * w) / d2
    versine, coversine = np.where(high, lower, upper), np.where(high, upper, lower)
    if g < 0:
        versine, coversine = coversine, versine
    return Polar(versine, coversine, density(phase, versine, coversine))


def _d(w: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Return (1 - g^2)/sqrt(1 + g^2 - 2 g mu) at the Henyey-Greenstein quantile of w."""
    return (1 - g) + 2 * g * w


def _cdf(w: np.ndarray, g: np.ndarray, c0: float, c1: float) -> np.ndarray:
    """Return the integral of c0 + c1 mu(w)^2 from 0.

    With a = 1 - g and b = 1 + g that of mu^2 is w less (2/3) a b^2 w^2 (3a + (b^2 - 3a^2) w - 3a g w^2)/d^3.
    """
    a, b = 1 - g, 1 + g
    d = _d(w, g)
    less = 2 / 3 * a * b * b * w * w * (3 * a + (b * b - 3 * a * a) * w - 3 * a * g * w * w) / (d * d * d)
    return c0 * w + c1 * (w - less)


def _root(
    target: np.ndarray, w: np.ndarray, g: np.ndarray, least: np.ndarray, most: np.ndarray, c0: float, c1: float
) -> np.ndarray:
    """Return w in [least, most] with _cdf(w) = target; each element stops on its own, whatever its neighbours do."""
    left = np.arange(len(w))
    for _ in range(_MOST_STEPS):
        x, k = w[left], g[left]
        mu = 2 * (1 + k) ** 2 * x * ((1 - k) + k * x) / _d(x, k) ** 2 - 1
        slope = np.maximum(c0 + c1 * mu * mu, np.finfo(w.dtype).tiny)
        # The bounds matter only where the slope is nearly 0 and rounding decides.
        w[left] = np.clip(x + (target[left] - _cdf(x, k, c0, c1)) / slope, least[left], most[left])
        left = left[np.abs(w[left] - x) > 4 * np.finfo(w.dtype).eps * x]
        if len(left) == 0:
            break
    return w
