"""Where a slab of any phase function sends what it reflects and transmits, at any angle.

The kernel between two directions is a Fourier series in azimuth, each term of which is found by doubling. Light scattered once
is taken out of every term and put back in closed form, with the phase function itself instead of its moments; what is
left converges quickly, also for peaked phase functions.
Source: Nakajima & Tanaka 1988, Algorithms for radiative intensity calculations in moderately thick atmospheres (TMS);
de Haan, Bosma & Hovenier 1987, Astronomy and Astrophysics 183.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.turning import turning
from fogproof.analytic.multiple.doubling import layer
from fogproof.analytic.multiple.mode_integrals import FARTHEST
from fogproof.analytic.multiple.scattering_arguments import seen_at
from fogproof.analytic.multiple.scattering_kernel import Scaled, fourier_medium, scaled
from fogproof.analytic.multiple.slab_by_doubling import LEVELS, MOMENTS, phase_moments
from fogproof.analytic.multiple.slab_modes import quadrature
from fogproof.analytic.phase.functions import phase_values
from fogproof.scene.phase import PhaseFunction

Side = Literal["reflected", "transmitted"]

MODES = 8
"""Fourier modes evaluated at a time."""

SEEN = 1e-13
"""Share of the sum below which a run of modes is the last."""

GRAZING = 1e-13
"""Cosine, over the thickness or 1, below which what is scattered twice or more is taken from there."""

ENOUGH = 1e-11
ROUNDING = 256 * EPS


VIEWS = 24
"""Pairs of directions evaluated at a time where the phase function is not isotropic."""


class Beams(NamedTuple):
    """Cosines of what comes in and of what goes out, and the azimuth between their ways on, (v,) each."""

    mu0: np.ndarray
    mu: np.ndarray
    azimuth: np.ndarray


def directional(c: float, tau: float, beams: Beams, phase: PhaseFunction, side: Side) -> tuple[np.ndarray, np.ndarray]:
    """Return radiance per irradiance [1/sr] for one slab of albedo c > 0 and thickness tau > 0, and its error, (v,)."""
    moments = phase_moments(phase)
    single, its_error = scattered_once(c, beams, phase, side)
    before = None
    found = error = np.zeros_like(single)
    with np.errstate(under="ignore"):
        for n in LEVELS:
            slab = scaled(np.array([c]), np.array([tau]), moments.chi[: MOMENTS * n + 1])
            once = (
                single
                * single_gain(float(slab.tau[0]), beams.mu0, beams.mu, side)
                / (1 - c * float(moments.chi[MOMENTS * n]))
            )
            more = _many_times(slab, beams, side, n, once)
            found = once + more
            if before is not None:
                difference = np.abs(found - before)
                change = moments.change[MOMENTS * n] * np.abs(more)
                error = (
                    difference + its_error / np.maximum(single, TINY) * once + ROUNDING * (once + np.abs(more)) + change
                )
                error += 16 * SEEN * found
                grazes = np.minimum(beams.mu0, beams.mu) < GRAZING * min(tau, 1.0)
                error += np.where(grazes, 64 * GRAZING, 0.0) * np.abs(more)
                if np.all(difference <= ENOUGH * np.abs(found)):
                    break
            before = found
    return found, error + 2 * TINY


def directional_in_parts(
    c: float, tau: float, beams: Beams, phase: PhaseFunction, side: Side
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same for any number of pairs of directions, a few at a time."""
    pairs, which = np.unique(np.stack([beams.mu0, beams.mu]), axis=1, return_inverse=True)
    value, error = np.zeros_like(beams.mu), np.zeros_like(beams.mu)
    for first in range(0, pairs.shape[1], VIEWS):
        some = (which.ravel() >= first) & (which.ravel() < first + VIEWS)
        value[some], error[some] = directional(c, tau, Beams(*(x[some] for x in beams)), phase, side)
    return value, error


def scattered_once(c: float, beams: Beams, phase: PhaseFunction, side: Side) -> tuple[np.ndarray, np.ndarray]:
    """Return c f_p [1/sr] between the two directions, and its error; nothing cancels near the forward direction."""
    mu0, mu, azimuth = beams
    x, y = turning(mu0, mu, azimuth, turns_back=side == "reflected")
    cosine = y - x
    density, error = phase_values(phase, cosine, x, y)
    # What the cosine is rounded by: the change of f_p over 4 eps on either side.
    around = [phase_values(phase, np.clip(cosine + d, -1, 1), x, y)[0] for d in (-4 * EPS, 4 * EPS)]
    error = error + np.abs(around[1] - density) + np.abs(around[0] - density)
    return c * density, c * (error + 32 * EPS * density)


def single_gain(tau: float, mu0: np.ndarray, mu: np.ndarray, side: Side) -> np.ndarray:
    """Return int_0^tau exp(-x/mu0 - (x or tau - x)/mu) dx / (mu mu0)."""
    if side == "reflected":
        return -np.expm1(-tau * (1 / mu + 1 / mu0)) / (mu + mu0)
    deep = np.minimum(tau / np.maximum(mu, mu0), FARTHEST)
    over = np.maximum(np.minimum(mu, mu0), TINY)
    apart = np.minimum(deep / over, FARTHEST) * np.abs(mu - mu0)
    small = apart < 1e-8
    gap = np.where(small, 1.0, np.abs(mu - mu0))
    return np.exp(-deep) * np.where(small, (1 - apart / 2) * np.minimum(deep / over, FARTHEST), -np.expm1(-apart) / gap)


def _many_times(slab: Scaled, beams: Beams, side: Side, n: int, once: np.ndarray) -> np.ndarray:
    """Return the kernel of what is scattered twice or more, over pi (v,); `once` is that of what is scattered once."""
    tau = float(slab.tau[0])
    cosines, where = np.unique(seen_at(np.concatenate([beams.mu0, beams.mu]), tau, GRAZING), return_inverse=True)
    came, goes = np.split(where, 2)
    mu, w = quadrature(min(tau, 10 * float(cosines.min())), n, weight=tau)
    count = len(mu)
    total = np.zeros(len(beams.mu))
    highest = int(np.flatnonzero(slab.chi)[-1])  # azimuth modes beyond the last moment are zero
    for first in range(0, highest + 1, MODES):
        orders = np.arange(first, min(first + MODES, highest + 1))
        between = fourier_medium(slab, mu, w, cosines, orders)
        found = layer(between, np.full(len(orders), tau))
        matrix = found.R if side == "reflected" else found.T
        kernel = between.backward if side == "reflected" else between.forward
        root = np.sqrt(2 * between.mu * between.w)[count:]
        aside = matrix[:, count:, count:] / (root[:, None] * root)
        single = kernel[:, count:, count:] / 2 * single_gain(tau, cosines[:, None], cosines, side)
        part = (aside - single)[:, goes, came]
        twice = np.where(orders == 0, 1.0, 2.0)[:, None] * np.cos(orders[:, None] * beams.azimuth)
        total += np.sum(part * twice, axis=0)
        if np.all(np.abs(part[-1]) <= SEEN * (np.abs(total) + np.pi * once)):
            break
    return total / np.pi
