"""Phase functions as the airlight integral sees them: 4 pi f_p at the cosine (wt - w) / (wt + w).

At a point t of the ray, w = r + t and wt = r - t are positive and known without cancellation, so each formula is
written in them: 1 - mu = 2 w / (w + wt) and 1 + mu = 2 wt / (w + wt) keep their relative accuracy to the very ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.phase import mie as phase_mie
from fogproof.errors import UnsupportedError
from fogproof.scene.phase_functions import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mie,
    Mixture,
    Murky,
    PhaseFunction,
    Rayleigh,
    Schlick,
    Tabulated,
)

Array = np.ndarray
Slope = Callable[[Array, Array], tuple[Array, Array]]


class AirlightPhase(NamedTuple):
    """What the integral needs to know about F = 4 pi f_p.

    factor    (w, wt) -> F, or None where it is 1; (F, its absolute error) if `noisy`
    floor     lower bound of F
    peak      upper bound of F
    eps       relative rounding error of F, in units of 2^-52
    slope     (mu_low, mu_high) -> bounds (of |d log F / d theta|, and of |dF / d theta| beyond that), over these cosines:
              what an error of the angle costs
    absolute  absolute rounding error of F, in units of 2^-52, besides the relative one
    degree    how many factors tanh s the formula multiplies, which panels must resolve
    kinks     cosines where F is not smooth
    noisy     whether `factor` returns its error
    """

    factor: Callable[[Array, Array], Any] | None
    floor: float
    peak: float
    eps: float
    slope: Slope
    absolute: float = 0.0
    degree: int = 0
    kinks: Array = np.empty(0)
    noisy: bool = False

    @property
    def spread(self) -> float:
        """How many e-folds further than without F the tails of the integral can matter; inf if F reaches 0."""
        return math.log(self.peak / self.floor) if self.floor > 0 else math.inf


def airlight_phase(phase: PhaseFunction) -> AirlightPhase:
    """Return the form of `phase` that the airlight integral uses."""
    build = _BUILD.get(type(phase))
    if build is None:
        known = ", ".join(kind.__name__ for kind in _BUILD)
        raise UnsupportedError(f"no airlight integral for the phase function {phase!r}; known are {known}", "phase")
    return build(phase)


def _no_slope(low: Array, _high: Array) -> tuple[Array, Array]:
    return np.zeros_like(low), np.zeros_like(low)


def _isotropic(_phase: Isotropic) -> AirlightPhase:
    return AirlightPhase(None, 1.0, 1.0, 0.0, _no_slope)


def _henyey_greenstein(phase: HenyeyGreenstein) -> AirlightPhase:
    """Build (1 - g^2) / (1 + g^2 - 2 g mu)^(3/2), where 1 + g^2 - 2 g mu = ((1-g)^2 wt + (1+g)^2 w) / (w + wt)."""
    g = phase.g
    backward, forward, scale = (1 + g) ** 2, (1 - g) ** 2, (1 - g) * (1 + g)

    def factor(w: Array, wt: Array) -> Array:
        ratio = (w + wt) / (backward * w + forward * wt)
        return ratio * np.sqrt(ratio) * scale

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        """F is D^-3, D the distance of the direction from the point g of the axis: a turn moves it by |g| at most."""
        nearest = (1 - abs(g)) ** 2 + 2 * abs(g) * (1 - (high if g >= 0 else -low))
        return 3 * abs(g) / np.sqrt(nearest), np.zeros_like(low)

    least, most = (1 - abs(g)) / (1 + abs(g)) ** 2, (1 + abs(g)) / (1 - abs(g)) ** 2
    return AirlightPhase(factor, least, most, 8.0, slope)


def _draine(phase: Draine | CornetteShanks | Rayleigh) -> AirlightPhase:
    """Build Henyey-Greenstein times (1 + alpha mu^2) / (1 + alpha (1 + 2 g^2)/3)."""
    g, alpha = getattr(phase, "g", 0.0), getattr(phase, "alpha", 1.0)
    lobe = _henyey_greenstein(HenyeyGreenstein(g))
    assert lobe.factor is not None
    hg, scale = lobe.factor, 1 / (1 + alpha * (1 + 2 * g * g) / 3)

    def factor(w: Array, wt: Array) -> Array:
        mu = (wt - w) / (wt + w)
        bracket = (1 + alpha * (mu * mu)) * scale
        return bracket if g == 0 else bracket * hg(w, wt)

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        return lobe.slope(low, high)[0] + alpha / math.sqrt(1 + alpha), np.zeros_like(low)

    most = lobe.peak * (1 + alpha) * scale
    return AirlightPhase(factor, lobe.floor * scale, most, 6.0 if g == 0 else 16.0, slope, degree=2)


def _schlick(phase: Schlick) -> AirlightPhase:
    """Build (1 - k^2) / (1 - k mu)^2, where 1 - k mu = ((1+k) w + (1-k) wt) / (w + wt)."""
    k = phase.k
    scale = (1 - k) * (1 + k)

    def factor(w: Array, wt: Array) -> Array:
        ratio = (w + wt) / ((1 + k) * w + (1 - k) * wt)
        return ratio * ratio * scale

    def slope(low: Array, _high: Array) -> tuple[Array, Array]:
        return np.full_like(low, 2 * abs(k) / math.sqrt(scale)), np.zeros_like(low)

    return AirlightPhase(factor, (1 - abs(k)) / (1 + abs(k)), (1 + abs(k)) / (1 - abs(k)), 8.0, slope)


def _lobe(phase: Hazy | Murky) -> AirlightPhase:
    """Build 1/2 + (n+1)/2 u^n, u = (1 + mu)/2 = wt / (w + wt), n = 8 or 32."""
    n = 8 if isinstance(phase, Hazy) else 32

    def factor(w: Array, wt: Array) -> Array:
        power = wt / (w + wt)
        for _ in range(n.bit_length() - 1):
            power = power * power
        return 0.5 + (n + 1) / 2 * power

    def slope(low: Array, _high: Array) -> tuple[Array, Array]:
        """|d log F / d theta| = n tan(theta/2) times the share of the lobe, which is below n / 2."""
        return np.full_like(low, n / 2), np.zeros_like(low)

    return AirlightPhase(factor, 0.5, 1 + n / 2, 3.0 * n, slope, degree=n)


def _mixture(phase: Mixture | DoubleHenyeyGreenstein) -> AirlightPhase:
    """Build the weighted mean of the parts."""
    if isinstance(phase, Mixture):
        weights = np.array(phase.weights) / sum(phase.weights)
        parts = [airlight_phase(component) for component in phase.components]
    else:
        weights = np.array([phase.weight, 1 - phase.weight])
        parts = [_henyey_greenstein(HenyeyGreenstein(g)) for g in (phase.g1, phase.g2)]
    weighted = [(float(weight), part) for weight, part in zip(weights, parts, strict=True) if weight > 0]
    noisy = any(part.noisy for _, part in weighted)

    def factor(w: Array, wt: Array) -> Any:
        total, noise = np.zeros_like(w), np.zeros_like(w)
        for weight, part in weighted:
            own = np.ones_like(w) if part.factor is None else part.factor(w, wt)
            if part.noisy:
                own, own_noise = own
                noise += weight * own_noise
            total += weight * own
        return (total, noise) if noisy else total

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        slopes = [(weight, *part.slope(low, high)) for weight, part in weighted]
        return np.max([s for _, s, _ in slopes], axis=0), sum((w * s for w, _, s in slopes), np.zeros_like(low))

    return AirlightPhase(
        factor,
        sum(weight * part.floor for weight, part in weighted),
        sum(weight * part.peak for weight, part in weighted),
        max(part.eps for _, part in weighted) + len(weighted) + 2,
        slope,
        sum(weight * part.absolute for weight, part in weighted),
        max(part.degree for _, part in weighted),
        np.unique(np.concatenate([part.kinks for _, part in weighted])),
        noisy,
    )


def _tabulated(phase: Tabulated) -> AirlightPhase:
    """Build the linear interpolant of the table, divided by its integral; panels end at its cosines."""
    cosines, values = np.array(phase.cosines), np.array(phase.values)
    widths = np.diff(cosines)
    F = values * (2 / float(np.sum(widths * (values[1:] + values[:-1])) / 2))
    steep = float(np.max(np.abs(np.diff(F)) / widths))

    def factor(w: Array, wt: Array) -> Array:
        return np.interp((wt - w) / (wt + w), cosines, F)

    def slope(low: Array, _high: Array) -> tuple[Array, Array]:
        return np.zeros_like(low), np.full_like(low, steep)

    eps = 6.0 + len(F) / 2
    return AirlightPhase(factor, float(F.min()), float(F.max()), eps, slope, 4 * steep, 1, cosines[1:-1])


def _mie(phase: Mie) -> AirlightPhase:
    """Build 4 pi f of the Lorenz-Mie series: a polynomial in mu, bounded and differentiated on a fine grid of angles."""
    size = math.pi * phase.diameter * phase.medium_index / phase.wavelength
    degree = 2 * math.ceil(size + 8 * size ** (1 / 3) + 5)
    theta = np.linspace(0, np.pi, 8 * degree + 1)
    F, noise = (4 * np.pi * x for x in phase_mie.pdf(phase, np.cos(theta)))
    # Between samples 8 times denser than the polynomial oscillates, neither F nor its slope grows by more than a tenth.
    steep = 1.1 * np.abs(np.diff(F)) / np.diff(theta)
    upto, beyond = np.maximum.accumulate(steep), np.maximum.accumulate(steep[::-1])[::-1]

    def factor(w: Array, wt: Array) -> tuple[Array, Array]:
        mu = (wt - w) / (wt + w)
        value, error = phase_mie.pdf(phase, mu.ravel())
        blur = 4 * EPS * np.interp(np.arccos(mu), theta[1:], steep)
        return 4 * np.pi * value.reshape(mu.shape), 4 * np.pi * error.reshape(mu.shape) + blur

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        """The smaller of the largest slopes up to the largest angle and beyond the smallest."""
        first, last = (np.clip((np.arccos(mu) / theta[1]).astype(int), 0, len(steep) - 1) for mu in (high, low))
        return np.zeros_like(low), np.minimum(upto[last], beyond[first])

    floor = max(0.0, 0.5 * float(np.min(F - noise)))
    return AirlightPhase(factor, floor, 1.1 * float(F.max()), 2.0, slope, 0.0, degree, noisy=True)


_BUILD: dict[type, Callable[[Any], AirlightPhase]] = {
    Isotropic: _isotropic,
    HenyeyGreenstein: _henyey_greenstein,
    Schlick: _schlick,
    Hazy: _lobe,
    Murky: _lobe,
    Rayleigh: _draine,
    CornetteShanks: _draine,
    Draine: _draine,
    DoubleHenyeyGreenstein: _mixture,
    Mixture: _mixture,
    Tabulated: _tabulated,
    Mie: _mie,
}
