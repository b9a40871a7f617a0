"""The airlight integral: light of a point source scattered once towards a camera by a homogeneous medium.

    I = int_a^b exp(-sigma_t ((t - a) + r)) / r^2  4 pi f_p(-t/r) dt,    r^2 = t^2 + h^2          [1/m]

t is measured along the ray from the foot of the perpendicular from the light, whose distance is h; the camera is at a.

Method. With t = h sinh s the integrand becomes exp(-sigma_t (w - a)) 4 pi f_p / r ds, w = t + r = h e^s, which is
analytic in |Im s| < pi/2 for every h, sigma_t and g: Gauss-Legendre on panels at most 3 wide converges uniformly. All
lengths are taken relative to an anchor s0 near the largest integrand, w = w0 e^u and wt = r - t = wt0 e^-u, so that
nothing cancels and h = 0 is no special case. The anchor is the start of the segment, its end, or
e^s0 = 1/(1 + sigma_t h), close to the maximum of the isotropic integrand, where it lies inside.

Window. Without the phase function log(integrand) is concave in s. Where it has fallen by K below its value at the
anchor, the chord continued bounds the tail by e^-K / (1 - e^-K) of the integral; a phase function changes that ratio
by at most max f_p / min f_p. So K = 40 + log(max f_p / min f_p) leaves out less than 1e-17 on each side.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.airlight_phase import AirlightPhase, airlight_phase
from fogproof.analytic.error_free import EPS, TINY, two_prod, two_sum
from fogproof.analytic.gauss_legendre import NODES, WEIGHTS
from fogproof.analytic.vectors import norm
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene.phase_functions import Isotropic, PhaseFunction
from fogproof.validate import as_float_array, require

PANEL = 3.0
"""Largest width of a panel in s: 28 nodes then leave a relative error below 1e-17 (isotropic), 1e-16 (|g| <= .9999)."""

TAIL = 40.0
"""How many e-folds below the anchor the window ends."""

ROUNDING = 28.0
"""Relative error [eps] of the sum without the phase function: u (10), w, wt and r (5), two exponentials (4), the sum of
positive terms (5), the attenuation up to the anchor (4)."""

BLOCK = 1024
"""Panels evaluated at a time: 28 nodes each, so that the temporaries stay in the cache."""

METHOD = "Gauss-Legendre 28 in asinh(t/h)"
SOURCE = "Sun et al. 2005, eq. 5, with t = h sinh s; tails bounded by log-concavity"


def airlight_integral(sigma_t: Any, h: Any, a: Any, b: Any, phase: PhaseFunction | None = None) -> Reference:
    """Return the integral over t in [a, b] of exp(-sigma_t ((t - a) + r)) / r^2  4 pi f_p(-t/r), r^2 = t^2 + h^2 [1/m].

    sigma_t  extinction coefficient [1/m], >= 0
    h        distance of the light from the line of the ray [m], >= 0
    a, b     the segment, as coordinates along the ray from the foot of the perpendicular [m]: camera at a, surface at
             b >= a, which may be inf
    phase    phase function, isotropic unless given; its forward cosine at t is -t/r

    All four broadcast. The inputs are taken as exact. The relative error is below 1e-14 for isotropic,
    Henyey-Greenstein and Rayleigh scattering until the result underflows. A light on the segment (h = 0) gives inf.
    Source: Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model, eq. 5 (isotropic).
    """
    sigma_t, h, a, b = (as_float_array(*item) for item in {"sigma_t": sigma_t, "h": h, "a": a, "b": b}.items())
    require("sigma_t", sigma_t, np.isfinite(sigma_t) & (sigma_t >= 0), "must be finite and >= 0 [1/m]")
    require("h", h, np.isfinite(h) & (h >= 0), "must be finite and >= 0 [m]", "h is a distance from the line")
    require("a", a, np.isfinite(a), "must be finite [m]", "the camera is somewhere")
    try:
        sigma_t, h, a, b = np.broadcast_arrays(sigma_t, h, a, b)
    except ValueError:
        shapes = [x.shape for x in (sigma_t, h, a, b)]
        raise InvalidValueError("sigma_t", "must broadcast with h, a and b", shapes) from None
    require("b", b, b >= a, "must be >= a [m]", "the camera is at a, the surface at b; inf if there is none")
    zero = np.zeros(h.size)
    fields = [x.ravel() for x in (sigma_t, h, a, b, b - a)]
    value, error = integrate(Segments(*fields, zero, zero, zero), airlight_phase(phase or Isotropic()))
    return Reference(value.reshape(h.shape), error.reshape(h.shape), METHOD, SOURCE)


class Segments(NamedTuple):
    """Pieces of rays, each (n,): `length` is b - a, more accurate than the difference where the caller knows better.

    `*_low` is what the rounded number lacks; it matters for the attenuation over many mean free paths.
    """

    sigma: np.ndarray
    h: np.ndarray
    a: np.ndarray
    b: np.ndarray
    length: np.ndarray
    sigma_low: np.ndarray
    h_low: np.ndarray
    a_low: np.ndarray


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


def integrate(segments: Segments, phase: AirlightPhase) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over each segment and a bound of its error, (n,) both; inf where the light is on it."""
    with np.errstate(all="ignore"):
        window = _window(segments, TAIL + phase.spread)
        sums = _sums(window, phase)
        half = np.exp(-0.5 * window.path)  # in two halves: a large sum may bring back what exp(-path) would lose
        value = (sums * half) * half
        value -= value * window.path_low
    value[(segments.h == 0) & (segments.a <= 0) & (segments.b >= 0) & (segments.length > 0)] = np.inf
    error = (ROUNDING + phase.eps) * EPS * np.where(value < np.inf, value, 0.0) + 4 * TINY
    error[value == np.inf] = 0.0
    return value, error


def _window(segments: Segments, tail: float) -> Window:
    """Choose the anchor, and the part of the segment around it that counts: nothing where nothing arrives."""
    sigma, h, a, b, length, sigma_low, h_low, a_low = segments
    ra, rb = np.hypot(a, h), np.hypot(b, h)
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
    whole = np.where(b < np.inf, np.log1p(ratio), np.inf)
    to_start = np.where(inside, np.log(wta / wt0), whole)
    to_end = np.where(inside, np.maximum(np.log(wb / w0), 0.0), whole)
    low = np.where(at_start, 0.0, -np.minimum(to_start, tail + 1.7))
    high = np.minimum(to_end, tail + 2.7 + 2 * depth)
    high = np.minimum(high, np.log1p((tail + 1.7 + depth) / k))
    high = np.where(at_end, 0.0, high)

    # Path camera - anchor - light: r_a where the anchor is the start, else w0 - a, a sum of positive terms.
    path, path_low = two_sum(w0, -a)
    start, start_low = norm((a, h), (a_low, h_low))
    path, path_low = np.where(at_start, start, path), np.where(at_start, start_low, path_low - a_low)
    tau, tau_low = two_prod(sigma, path)
    tau_low = tau_low + sigma * path_low + sigma_low * path

    nothing = (length == 0) | ~(tau < 4096)  # exp(-4096) / r is 0 for every r > 0 there is
    for x, replacement in ((k, 1.0), (w0, 1.0), (wt0, 1.0), (low, 0.0), (high, 0.0), (tau, 0.0), (tau_low, 0.0)):
        x[nothing] = replacement
    return Window(k, w0, wt0, low, high, tau, tau_low)


def _w(a: np.ndarray, r: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Return r + a without cancellation; r = hypot(a, h)."""
    return np.where(a >= 0, r + a, h * (h / (r - a)))


def _sums(window: Window, phase: AirlightPhase) -> np.ndarray:
    """Return int_low^high exp(-k expm1(u)) 4 pi f_p 2/(w + wt) du for each segment, panel by panel in blocks."""
    k, w0, wt0, low, high, _, _ = window
    panels = np.maximum(np.ceil((high - low) / PANEL), 1).astype(np.intp)
    width = (high - low) / panels
    first = np.cumsum(panels) - panels
    total = int(panels.sum())
    parts = np.empty(total)
    owner = np.repeat(np.arange(len(k)), panels)
    start = low[owner] + width[owner] * (np.arange(total) - first[owner])
    for i in range(0, total, BLOCK):
        block = slice(i, i + BLOCK)
        own = owner[block]
        u = NODES[:, None] * width[own] + start[block]
        grow = np.exp(u)
        w, wt = w0[own] * grow, wt0[own] / grow
        f = np.exp(np.expm1(u) * -k[own]) / (w + wt)
        if phase.factor is not None:
            f *= phase.factor(w, wt)
        parts[block] = WEIGHTS @ f
    if total > len(k):
        parts = np.add.reduceat(parts, first) if len(k) else parts
    return 2 * width * parts
