"""The airlight integral by Gauss-Legendre quadrature in s = asinh(t/h): full accuracy everywhere.

    I = int_a^b exp(-sigma_t ((t - a) + r)) / r^2  4 pi f_p(-t/r) dt,    r^2 = t^2 + h^2          [1/m]

t is measured along the ray from the foot of the perpendicular from the light, whose distance is h; the camera is at a.

With t = h sinh s the integrand becomes exp(-sigma_t (w - a)) 4 pi f_p / r ds, w = t + r = h e^s, which is analytic in
|Im s| < pi/2 for every h, sigma_t and g: Gauss-Legendre on panels at most 3 wide converges uniformly. `airlight_window` says
where to integrate.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase
from fogproof.analytic.airlight.segments import Segments, cut
from fogproof.analytic.airlight.window import Window, window_of
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.arithmetic.gauss_legendre import RULES

REACHES = {12: (0.75, 6.0), 16: (1.3, 14.0), 20: (1.9, 26.0), 28: (3.0, 50.0)}
"""Nodes -> the largest panel that they integrate to 1e-16: its width in s, and e-folds of the attenuation across it.

The widths follow from the Bernstein ellipse in |Im s| < 1.5, the e-folds from the rule applied to an exponential.
"""

TAIL = 40.0
"""How many e-folds below the anchor the window ends."""

ROUNDING = 28.0
"""Relative error [eps] of the sum without the phase function: u (10), w, wt and r (5), two exponentials (4), the sum of
positive terms (5), the attenuation up to the anchor (4)."""

BLOCK = 16384
"""Nodes evaluated at a time, so that the temporaries stay in the cache."""

ROWS = 8192
"""Segments at a time, for the same reason."""

METHOD = "Gauss-Legendre 12 to 28 in asinh(t/h)"
SOURCE = "Sun et al. 2005, eq. 5, with t = h sinh s; tails bounded by log-concavity"


class Gain(NamedTuple):
    """A further factor of the integrand, in [0, 1].

    factor  (w, wt, scale, segment) -> (nodes, m): of nodes with w/scale and wt/scale on the segments of those numbers (m,)
    degree  how many factors tanh s and sech s the formula multiplies
    eps     bound of its error, in units of 2^-52
    """

    factor: Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
    degree: int
    eps: float

    def of(self, owner: np.ndarray) -> Gain:
        """Return the factor of pieces, given the segments they come from."""
        return self._replace(factor=lambda w, wt, scale, piece: self.factor(w, wt, scale, owner[piece]))


def integrate(segments: Segments, phase: AirlightPhase, gain: Gain | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over each segment and a bound of its error, (n,) both; inf where the light is on it."""
    count = len(segments.h)
    if count > ROWS:
        value, error = np.empty((2, count))
        for i in range(0, count, ROWS):
            block = slice(i, i + ROWS)
            some = Segments(*(x[block] for x in segments))
            value[block], error[block] = integrate(some, phase, gain.of(np.arange(count)[block]) if gain else None)
        return value, error
    if phase.finer.size:
        coarse = integrate(segments, phase._replace(finer=np.empty(0)), gain)[0]
        value, error = integrate(segments, phase._replace(finer=np.empty(0), kinks=phase.finer), gain)
        return value, np.where(np.isfinite(value), error + np.abs(np.nan_to_num(value - coarse)), error)
    if phase.kinks.size:
        return _between_kinks(segments, phase, gain)
    exact = phase.absolute == 0 and phase.floor > 0 and not phase.noisy and gain is None
    with np.errstate(all="ignore"):
        # Where F reaches 0 the tails are bounded by its peak, and counted against the integral without it.
        window = window_of(segments, TAIL + (phase.spread if phase.floor > 0 else np.log(max(phase.peak, 1))))
        sums, plain, noise = _sums(window, phase, gain, exact)
        half = np.exp(-0.5 * window.path)  # in two halves: a large sum may bring back what exp(-path) would lose
        arrives = half * (1 - window.path_low)
        value = (sums * arrives) * half
        error = (ROUNDING + phase.eps) * EPS * value + 4 * TINY
        if not exact:
            error += (
                ((phase.absolute + 1 + (gain.eps * phase.peak if gain else 0)) * EPS * plain + noise) * arrives * half
            )
    on_light = (segments.h == 0) & (segments.start <= 0) & (segments.end >= 0) & (segments.length > 0)
    if phase.peak == np.inf:  # straight towards the light
        on_light |= (segments.h == 0) & (segments.start < 0) & (segments.length > 0)
    value[on_light], error[on_light] = np.inf, 0.0
    return value, error


def _between_kinks(segments: Segments, phase: AirlightPhase, gain: Gain | None) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral as a sum over the pieces on which the phase function is smooth."""
    mu, smooth = phase.kinks, phase._replace(kinks=np.empty(0))
    count = len(segments.h)
    value, error = np.empty((2, count))
    step = max(1, 65536 // len(mu))
    for i in range(0, count, step):
        block = slice(i, i + step)
        some = Segments(*(x[block] for x in segments))
        with np.errstate(all="ignore"):
            pieces, owner = cut(some, -some.h[:, None] * (mu / np.sqrt((1 - mu) * (1 + mu))))
        parts = integrate(pieces, smooth, gain.of(owner + i) if gain else None)
        value[block], error[block] = (np.bincount(owner, part, len(some.h)) for part in parts)
    return value, np.where(value < np.inf, error + len(mu) * EPS * value, 0.0)


def _sums(
    window: Window, phase: AirlightPhase, gain: Gain | None, exact: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the integral over u for each segment, by the smallest rule that does it in one panel, or panels of the largest.

    With it the same without phase function and gain, and the integral of the error of the phase function, each (n,);
    zeros if `exact`.
    """
    narrow = 1 + (phase.degree + (gain.degree if gain else 0)) / 8
    extent = (window.high - window.low) * narrow
    fall = window.k * np.expm1(window.high)
    result = np.zeros((3, len(extent)))
    left = np.ones(len(extent), bool)
    for nodes, (widest, deepest) in REACHES.items():
        fits = left & (extent <= widest) & (fall <= deepest) if nodes < max(REACHES) else left
        which = np.flatnonzero(fits)
        if len(which):
            panels = np.maximum(np.ceil(np.maximum(extent[which] / widest, fall[which] / deepest)), 1).astype(np.intp)
            result[:, which] = _by_rule(nodes, which, panels, window, phase, gain, exact)
            left &= ~fits
    sums, plain, noise = result
    return sums, plain, noise


def _by_rule(
    nodes: int,
    which: np.ndarray,
    panels: np.ndarray,
    window: Window,
    phase: AirlightPhase,
    gain: Gain | None,
    exact: bool,
) -> np.ndarray:
    """Return what `_sums` returns, (3, m), for the segments `which`, each cut into so many panels.

    In a panel that starts at u0, with v = u - u0: w = w0 e^u0 e^v, and the exponent is that at u0 and k e^u0 expm1(v). Only
    w/wt matters to a phase function, so w e^v and wt e^v = wt0 e^-u0 save a division.
    """
    x, weights = RULES[nodes]
    item, first, u0, width = _laid_out(panels, window.low[which], window.high[which])
    owner = which[item]
    k, grown = window.k[owner], np.exp(u0)
    before = np.exp(-k * np.expm1(u0))
    k, w0, wt0 = -k * grown, window.w0[owner] * grown, window.wt0[owner] / grown
    total = len(item)
    parts = np.zeros((3, total))
    step = BLOCK // nodes
    buffers = np.empty((4, nodes, step))
    for i in range(0, total, step):
        block = slice(i, min(i + step, total))
        e, grow, w, f = buffers[:, :, : block.stop - i]
        np.multiply(x[:, None], width[block], out=e)
        np.expm1(e, out=e)
        np.add(e, 1.0, out=grow)
        e *= k[block]
        np.exp(e, out=e)
        e *= grow
        np.multiply(grow, grow, out=w)
        w *= w0[block]
        np.add(w, wt0[block], out=f)
        np.divide(e, f, out=f)
        if not exact:
            parts[1, block] = weights @ f
        wt = wt0[block]
        if gain is not None:
            f *= gain.factor(w, wt, grow, owner[block])
        if phase.factor is not None:
            factor = phase.factor(w, wt)
            if phase.noisy:
                factor, noise = factor
                parts[2, block] = weights @ (f * noise)
            f *= factor
        parts[0, block] = weights @ f
    parts *= 2 * before * width
    if total > len(which):
        parts = np.add.reduceat(parts, first, axis=1)
    return parts


def _laid_out(
    panels: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return whose each panel is, the first of each window, and where each begins and how wide it is.

    Edges of several panels count from the anchor, where the integrand is large: an edge is then off by half an EPS of its distance
    from there, and not of the length of the whole window.
    """
    split = panels > 1
    extent = np.where(split, high - low, 1.0)
    below = np.where(split, np.ceil(panels * (-low / extent)), 0).astype(np.intp)
    above = np.where(split, np.ceil(panels * (high / extent)), 1).astype(np.intp)
    start = np.where(split, 0.0, low)
    widths = -low / np.maximum(below, 1), (high - start) / np.maximum(above, 1)
    first = np.cumsum(below + above) - below - above
    item = np.repeat(np.arange(len(panels)), below + above)
    panel = np.arange(len(item)) - (first + below)[item]
    width = np.where(panel < 0, widths[0][item], widths[1][item])
    return item, first, start[item] + panel * width, width
