"""Second moments of single scattering: how noisy an estimate is when the scattering event is placed at random.

With F = 4 pi f_p(-t/r) the airlight integral is I = int F e^{-sigma_t ((t-a)+r)} / r^2 dt. An estimate F e^{...}/(r^2 p(t)) with
t drawn from the density p has the second moment int (F e^{...})^2 / (r^4 p) dt:

    equiangular  p = h/(Theta r^2)                  (Theta/h)          int F^2 e^{-2 sigma_t ((t-a)+r)} / r^2 dt
    free-path    p = sigma_t e^{-sigma_t (t-a)}     1/sigma_t          int F^2 e^{-sigma_t ((t-a)+2r)} / r^4 dt
    distance     the same, given that t < b         (1 - T)/sigma_t    the same integral
    uniform      p = 1/(b - a)                      (b - a)            int F^2 e^{-2 sigma_t ((t-a)+r)} / r^4 dt

Equiangular sampling in an isotropic medium has (Theta/h) I(2 sigma_t): the airlight of a medium twice as dense.

Method. With t = h sinh s the integrands are analytic in |Im s| < pi/2 and, F apart, log-concave: Gauss-Legendre on panels of
a window around the maximum, halved until two rounds agree; what the window leaves out is bounded by its chord.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, airlight_phase
from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.arithmetic.gauss_legendre import NODES, WEIGHTS
from fogproof.analytic.declaration import quantity
from fogproof.analytic.rays.compositing import phi1
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase import Isotropic, PhaseFunctionField
from fogproof.validate import as_float_array, require

Sampling = Literal["equiangular", "free-path", "distance", "uniform"]
"""How the scattering event is placed; paths of "free-path" that miss the segment score 0."""

SOURCE = "second moment of importance sampling; equiangular: Kulla & Fajardo 2012"
TAIL = 42.0
"""E-folds below the maximum where the window ends."""

FAR = 700.0
"""The largest |s| there is: sinh does not overflow."""

NEAREST = 1e-290
"""The smallest h/|a| whose asinh and squares are still numbers."""

ROUNDS = 7
TOLERANCE = 1e-13


@quantity(
    unit="1/m^2",
    convention="mean square of one realisation of airlight_integral that places its scattering event by `sampling`",
    source="Kulla & Fajardo 2012, Importance sampling techniques for path tracing in participating media",
    example={
        "sigma_t": 0.5,
        "h": [0.1, 1, 10],
        "a": -2,
        "b": 3,
        "phase": {"kind": "henyey-greenstein", "g": 0.6},
        "sampling": "equiangular",
    },
)
def airlight_second_moment(
    sigma_t: FloatArray,
    h: FloatArray,
    a: FloatArray,
    b: FloatArray,
    phase: PhaseFunctionField | None = None,
    sampling: Sampling = "equiangular",
) -> Reference:
    """Return the second moment of a one-sample estimate of `airlight_integral` [1/m^2].

    sigma_t, h, a, b, phase  as for `airlight_integral`; they broadcast
    sampling                 "equiangular", "free-path", "distance" (a free path that ends on the segment) or "uniform"

    A light on the segment gives inf; so does a free path in an empty medium, which never scatters. A uniform position
    on an infinite segment, or a distance on one in an empty medium, does not exist and is refused.
    Error: 1e-13 relative or so, from rounding of s and of the exponents, and from the last two rounds.
    """
    if sampling not in get_args(Sampling):
        raise InvalidValueError("sampling", f"must be one of {', '.join(get_args(Sampling))}", sampling)
    names = {"sigma_t": sigma_t, "h": h, "a": a, "b": b}
    sigma, h, a, b = np.broadcast_arrays(*(as_float_array(*item) for item in names.items()))
    require("sigma_t", sigma, np.isfinite(sigma) & (sigma >= 0), "must be finite and >= 0 [1/m]")
    require("h", h, np.isfinite(h) & (h >= 0), "must be finite and >= 0 [m]", "h is a distance from the line")
    require("a", a, np.isfinite(a), "must be finite [m]")
    require("b", b, b >= a, "must be >= a [m]", "the surface is at b; inf if there is none")
    seen = (h == 0) | (h >= NEAREST * np.abs(a))
    require("h", h, seen, f"must be 0 or at least {NEAREST:g} |a| [m]", "nearer, the light is on the line")
    endless = np.isinf(b) & ((sampling == "uniform") | ((sampling == "distance") & (sigma == 0)))
    if endless.any():
        raise UnsupportedError(f"{sampling} sampling has no density on an infinite segment: give it an end", "b")

    with np.errstate(all="ignore"):
        rays = (x.ravel() for x in (sigma, h, a, b))
        value, error = _integral(airlight_phase(phase or Isotropic()), sampling, *rays)
        value, error = value.reshape(h.shape), error.reshape(h.shape)
        factor = _inverse_density(sigma, h, a, b, sampling)
        on_light = (h == 0) & (a <= 0) & (b >= 0) & (b > a)
        value = np.where(on_light, np.inf, np.where(b > a, value * factor, 0.0))
        error = np.where(np.isfinite(value), error * factor + (2 * ELEMENTARY + 4 * EPS) * value + TINY, 0.0)
    method = f"second moment of {sampling} sampling, Gauss-Legendre 28 in asinh(t/h)"
    return Reference(value, error, method, SOURCE)


def _inverse_density(sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, sampling: Sampling) -> np.ndarray:
    """Return what stands before the integral: 1/p without the factors that are inside."""
    match sampling:
        case "equiangular":
            # Theta = atan(b/h) - atan(a/h), without cancellation; its limit for h -> 0 is h (b - a)/(a b).
            end = np.where(np.isinf(b), 1.0, b)
            side, ahead = np.where(np.isinf(b), 1.0, b - a), a * end
            theta = np.arctan2(h * side, np.where(np.isinf(b), a, h * h + ahead))
            return np.where(h > 0, theta / h, side / ahead)
        case "free-path":
            return 1 / sigma
        case "distance":
            tau = sigma * (b - a)
            return np.where(tau < 1, (b - a) * phi1(tau), -np.expm1(-tau) / sigma)
    return b - a


class _Shape(NamedTuple):
    """log of the integrand over s, F apart: -along (h sinh s - a) - across h cosh s - power log(h cosh s), each (n,)."""

    power: float
    h: np.ndarray
    a: np.ndarray
    along: np.ndarray
    across: np.ndarray

    def log(self, s: np.ndarray) -> np.ndarray:
        """Return the logarithm at s, (n,)."""
        r = self.h * np.cosh(s)
        return -self.along * (self.h * np.sinh(s) - self.a) - self.across * r - self.power * np.log(r)

    def slope(self, s: np.ndarray) -> np.ndarray:
        """Return its derivative, which decreases, (n,)."""
        return -self.h * (self.along * np.cosh(s) + self.across * np.sinh(s)) - self.power * np.tanh(s)


def _integral(
    phase: AirlightPhase, sampling: Sampling, sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return int F^2 e^{-along (t-a) - 2 sigma r} / r^m dt, m = 2 for equiangular, else 4, and its error."""
    # A light on the line is as good as one 1e-10 beside it, where the line does not pass it: r changes by 1e-20.
    nearest = np.where((a <= 0) & (b >= 0), 1.0, np.minimum(np.abs(a), np.abs(b)))
    h = np.where(h > 0, h, 1e-10 * nearest)
    free = sampling in ("free-path", "distance")
    shape = _Shape(1.0 if sampling == "equiangular" else 3.0, h, a, sigma if free else 2 * sigma, 2 * sigma)
    start, end = np.arcsinh(a / h), np.clip(np.arcsinh(b / h), -FAR, FAR)

    greatest = phase.peak if phase.peak < np.inf else phase.floor * np.exp(phase.folds)
    tail = TAIL + 2 * np.log(max(greatest, 1.0)) - (2 * np.log(phase.floor) if phase.floor > 0 else 0.0)
    top = _root(shape.slope, start, end)
    peak = shape.log(top)
    low = _root(lambda s: shape.log(s) < peak - tail, start, top, increasing=True)
    high = _root(lambda s: shape.log(s) >= peak - tail, top, end)
    chord = (low - start > 0) * (top - low) + (end - high > 0) * (high - top)
    left_out = greatest * np.exp(peak - tail) * greatest * chord / tail

    edges = [low]
    for cosine in np.sort(phase.kinks)[::-1]:
        edges.append(np.clip(-np.arctanh(cosine), low, high))
    edges.append(high)
    cuts = np.stack(edges, axis=-1)
    width = 2.0 / (1 + phase.degree / 8)
    value, rounding = _panels(shape, phase, cuts, width)
    error = np.full_like(value, np.inf)
    active = np.arange(value.size)
    for k in range(1, ROUNDS):
        some = _Shape(shape.power, *(x[active] for x in shape[1:]))
        finer, rounding[active] = _panels(some, phase, cuts[active], width / 2**k)
        error[active] = np.abs(finer - value[active])
        value[active] = finer
        active = active[error[active] > TOLERANCE * finer]
        if not active.size:
            break
    ends = sum((np.abs(s) + 4) * EPS * _integrand(shape, phase, s)[0] for s in (low, high))
    return value, error + rounding + left_out + np.where(end > start, ends, 0.0)


def _root(function: Any, low: np.ndarray, high: np.ndarray, increasing: bool = False) -> np.ndarray:
    """Return where a decreasing function changes sign between low and high, the end it points to if it does not."""
    low, high = low.copy(), high.copy()
    for _ in range(60):
        middle = low + (high - low) / 2
        up = np.asarray(function(middle) > 0)
        low, high = np.where(up, middle, low), np.where(up, high, middle)
    return low if increasing else high


def _panels(shape: _Shape, phase: AirlightPhase, cuts: np.ndarray, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over panels no wider than `width` between the cuts (n, k), and its rounding error."""
    n = len(shape.h)
    value, rounding = np.zeros((2, n))
    span = np.diff(cuts, axis=-1)
    count = np.maximum(np.ceil(span / width), 1).astype(int)
    owner = np.repeat(np.arange(n), count.sum(axis=-1))
    cell = np.repeat(np.arange(count.size), count.ravel())
    step = (span / count).ravel()[cell]
    place = np.arange(cell.size) - np.repeat(np.cumsum(count.ravel()) - count.ravel(), count.ravel())
    left = cuts[:, :-1].ravel()[cell] + step * place
    for i in range(0, cell.size, 2048):
        own = owner[i : i + 2048]
        part = _Shape(shape.power, *(x[own, None] for x in shape[1:]))
        s = left[i : i + 2048, None] + step[i : i + 2048, None] * NODES
        f, off = _integrand(part, phase, s)
        weight = step[i : i + 2048, None] * WEIGHTS
        np.add.at(value, own, (weight * f).sum(axis=-1))
        np.add.at(rounding, own, (weight * off).sum(axis=-1))
    return value, rounding


def _integrand(shape: _Shape, phase: AirlightPhase, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the integrand over s and its rounding error, a rounded s included."""
    w, wt = shape.h * np.exp(s), shape.h * np.exp(-s)
    r, t = (w + wt) / 2, (w - wt) / 2
    f = np.exp(-shape.along * (t - shape.a) - shape.across * r) / r**shape.power
    slope = np.abs(shape.along * r + shape.across * t) + shape.power
    eps = 40 + 2 * phase.eps + np.abs(s) * (slope + 6 + 2 * phase.degree)
    eps = eps + 8 * (shape.along * (np.abs(t) + np.abs(shape.a)) + shape.across * r)
    if phase.factor is None:
        return f, EPS * eps * f
    F = phase.factor(w, wt)
    F, noise = F if phase.noisy else (F, phase.absolute * EPS)
    return f * F * F, EPS * eps * f * F * F + f * (2 * F + noise) * noise
