"""Which part of a ray matters to the airlight integral, in the variable u = asinh(t/h) - s0.

All lengths are taken relative to an anchor s0 near the largest integrand: w = r + t = w0 e^u and wt = r - t = wt0 e^-u, so
that nothing cancels and h = 0 is no special case. The anchor is the start of the segment, its end, or
e^s0 = 1/(1 + sigma_t h), close to the maximum of the isotropic integrand, where that lies inside.

Without the phase function log(integrand) is concave in s. Where it has fallen by K below its value at the anchor, the chord
continued bounds the tail by e^-K / (1 - e^-K) of the integral; a phase function changes that ratio by at most
max f_p / min f_p. So K = 40 + log(max f_p / min f_p) leaves out less than 1e-17 on each side.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.segments import Segments
from fogproof.analytic.arithmetic.error_free import two_prod
from fogproof.analytic.arithmetic.vectors import hypot, sum_pair


class Window(NamedTuple):
    """What is left to integrate, each (n,): exp(-path) int_low^high exp(-k expm1(u)) 4 pi f_p 2/(w + wt) du.

    w = w0 e^u, wt = wt0 e^-u; sigma times the length of the path camera - anchor - light is path + path_low.
    """

    k: np.ndarray
    w0: np.ndarray
    wt0: np.ndarray
    low: np.ndarray
    high: np.ndarray
    path: np.ndarray
    path_low: np.ndarray


def window_of(segments: Segments, tail: float) -> Window:
    """Choose the anchor, and the part of the segment around it that counts: nothing where nothing arrives."""
    sigma, sigma_low, h, _, camera, camera_low, a, b, length, ra, ra_low = segments
    rb = hypot(b, h)
    wa, wta = _w(a, ra, h), _w(-a, ra, h)
    wb, wtb = _w(b, rb, h), _w(-b, rb, h)
    H = sigma * h
    depth = np.log1p(H)  # the maximum of the isotropic integrand is near s = -depth
    w0, wt0 = h / (1 + H), h * (1 + H)

    at_start = wta <= np.e * wt0
    at_end = ~at_start & (wtb >= wt0)
    inside = ~(at_start | at_end)
    w0 = np.where(at_start, wa, np.where(at_end, wb, w0))
    wt0 = np.where(at_start, wta, np.where(at_end, wtb, wt0))
    k = sigma * w0

    # Distances in s from the anchor to the ends. Between the ends: log1p of the difference over the smaller, so that a
    # short segment keeps its relative accuracy. An anchor inside is more than 1 from the start: log will do.
    ratio = (length / (ra + rb)) * np.where(at_start, (wa + wb) / wa, (wta + wtb) / wtb)
    across = np.where(b < np.inf, np.log1p(ratio), np.inf)
    to_start = np.where(inside, np.log(wta / wt0), across)
    to_end = np.where(inside, np.maximum(np.log(wb / w0), 0.0), across)
    low = np.where(at_start, 0.0, -np.minimum(to_start, tail + 1.7))
    high = np.minimum(to_end, tail + 2.7 + 2 * depth)
    high = np.minimum(high, np.log1p((tail + 1.7 + depth) / k))
    high = np.where(at_end, 0.0, high)

    # Path camera - anchor - light: r_a and the way to a where the anchor is the start, else w0 - camera, both positive.
    before, before_low = sum_pair(a, -camera)
    path, path_low = sum_pair(np.where(at_start, ra, w0), np.where(at_start, before, -camera))
    path_low += np.where(at_start, ra_low + before_low, 0.0)
    path_low -= np.where(at_start & (before == 0), 0.0, camera_low)
    tau, tau_low = two_prod(sigma, path)
    tau_low = tau_low + sigma * path_low + sigma_low * path

    nothing = (length == 0) | ~(tau < 4096)  # exp(-4096) / r is 0 for every r > 0 there is
    for x, replacement in ((k, 1.0), (w0, 1.0), (wt0, 1.0), (low, 0.0), (high, 0.0), (tau, 0.0), (tau_low, 0.0)):
        x[nothing] = replacement
    return Window(k, w0, wt0, low, high, tau, tau_low)


def _w(a: np.ndarray, r: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Return r + a without cancellation; r = hypot(a, h)."""
    return np.where(a >= 0, r + a, h * (h / (r - a)))
