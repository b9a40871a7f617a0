"""What a phase function is known by when only its pdf is: everything else by quadrature, and what was missed counts.

The variable is s = artanh(mu), in which a peak at either pole is no narrower than about 1 and an integrable singularity there
decays exponentially. Panels of 16 Gauss-Legendre nodes are halved until the halves agree with the whole. Phase functions are
normalised: what the panels have not found of the integral 1 is somewhere, so it counts in every error; and it is looked for.
The errors are estimates, as those of any quadrature that knows values only, but for that.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase, Array
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS
from fogproof.analytic.phase.kinds import ROOM, formula
from fogproof.analytic.phase.legendre import legendre_polynomials
from fogproof.scene.kinds import given
from fogproof.scene.phase import PhaseFunction

FAR, NEAR = 345.0, 40.0
"""Largest |s|: with a formula in (1 - mu)/2, which then is 1e-300; with one in mu, which then is 1 long since."""

POLE = 18.0
"""|s| beyond which cosines are 1 but for rounding."""

ROUNDING = 16 * EPS
"""Of a moment, measured: three times the worst of the kinds with a closed form, up to l = 512."""

FOUND = 1e-12
"""What may be missing of the integral before it is looked for on finer panels, so many times."""

HUNTS, ROUNDS, MOST = 3, 60, 20000

Pair = tuple[np.ndarray, np.ndarray]


class PhasePanels(NamedTuple):
    """Panels in order, (p,): from `low` over `width` in s, with the probability in each and its error.

    missing  what all of them lack of 1
    """

    low: np.ndarray
    width: np.ndarray
    mass: np.ndarray
    error: np.ndarray
    missing: float


def density(phase: PhaseFunction, x: np.ndarray, y: np.ndarray) -> Pair:
    """Return f at mu = y - x [1/sr]; what the rounding of mu changes is part of the error."""
    pdf, mu = formula(phase, "pdf"), np.clip(y - x, -1, 1)
    value, error = pdf(phase, mu)
    with np.errstate(invalid="ignore"):
        beside = [np.abs(pdf(phase, np.nextafter(mu, end))[0] - value) for end in (-1.0, 1.0)]
        return value, error + np.nan_to_num(np.maximum(*beside), nan=np.inf)


def cdf(phase: PhaseFunction, mu: np.ndarray) -> Pair:
    """Return F(mu): whole panels, and 16 nodes in the part of one."""
    known = panels(phase)
    with np.errstate(divide="ignore"):
        s = np.clip(0.5 * np.log((1 + mu) / (1 - mu)), known.low[0], known.low[-1] + known.width[-1])
    i = np.clip(np.searchsorted(known.low, s, side="right") - 1, 0, len(known.low) - 1)
    part, noise = _masses(phase, known.low[i], s - known.low[i])
    upto = np.concatenate([[0.0], np.cumsum(known.mass)])
    errors = np.concatenate([[0.0], np.cumsum(known.error)])
    value, error = upto[i] + part, errors[i + 1] + noise + known.missing + 4 * EPS
    ends = np.abs(mu) == 1
    return np.where(ends, (1 + mu) / 2, np.clip(value, 0, 1)), np.where(ends, 0.0, error)


def mean_cosine(phase: PhaseFunction) -> tuple[float, float]:
    """Return the first Legendre moment."""
    value, error = legendre_moments(phase, 1)
    return float(value[1]), float(error[1])


@lru_cache(maxsize=64)
def legendre_moments(phase: PhaseFunction, count: int) -> Pair:
    """Return chi_0 … chi_count, and their errors from panels twice as wide, the noise of the pdf and what was missed."""
    known = panels(phase)
    # P_count turns by count ds / cosh s across ds; a panel of 16 nodes follows four radians with ease.
    nearest = np.maximum(np.maximum(known.low, -(known.low + known.width)), 0.0)
    parts = np.ceil(count * known.width / np.cosh(np.minimum(nearest, 300.0)) / 4).clip(1).astype(int)
    wide, _ = _moments(phase, count, *_split(known.low, known.width, parts))
    value, noise = _moments(phase, count, *_split(known.low, known.width, 2 * parts))
    error = np.abs(value - wide) + noise + known.missing + ROUNDING
    return value, error


def airlight(phase: PhaseFunction) -> AirlightPhase:
    """Return 4 pi f between the edges of the panels; the integral is repeated with halved ones to see its error."""
    known = panels(phase)
    edges = np.concatenate([known.low, [known.low[-1] + known.width[-1]]])
    middles = known.low + known.width / 2
    s = (known.low[:, None] + known.width[:, None] * NODES).ravel()
    F = 4 * np.pi * _values(phase, s)[0]
    theta = 2 * np.arctan(np.exp(-s))[::-1]
    # Twice the largest quotient of differences of the 16 values of a panel and its neighbours stands for the slope.
    steep = 2 * np.abs(np.diff(F[::-1])) / np.maximum(np.diff(theta), 1e-300)
    upto, beyond = np.maximum.accumulate(steep), np.maximum.accumulate(steep[::-1])[::-1]
    at = formula(phase, "density")

    def factor(w: Array, wt: Array) -> tuple[Array, Array]:
        value, error = at(phase, w / (w + wt), wt / (w + wt))
        return 4 * np.pi * value, 4 * np.pi * error

    def slope(low: Array, high: Array) -> tuple[Array, Array]:
        first, last = (np.searchsorted(theta[1:], np.arccos(np.clip(mu, -1, 1))) for mu in (high, low))
        first, last = np.clip(first, 0, len(steep) - 1), np.clip(last, 0, len(steep) - 1)
        return np.zeros_like(low), np.minimum(upto[last], beyond[first])

    def cosines(s: np.ndarray) -> np.ndarray:
        return np.unique(np.tanh(s)[np.abs(s) < POLE])

    return AirlightPhase(
        factor,
        0.0,
        1.5 * float(F.max()),
        2.0,
        slope,
        kinks=cosines(edges[1:-1]),
        noisy=True,
        finer=cosines(np.concatenate([edges[1:-1], middles])),
    )


@lru_cache(maxsize=64)
def panels(phase: PhaseFunction) -> PhasePanels:
    """Return panels on which the pdf is smooth, found by halving."""
    reach = NEAR if given(phase, ROOM, "density") is None else FAR
    kinks = np.asarray(given(phase, ROOM, "kinks")(phase) if given(phase, ROOM, "kinks") else [], float)
    start = np.concatenate(
        [np.linspace(-8, 8, 33), np.arange(10, reach, 4.0), -np.arange(10, reach, 4.0), [-reach, reach]]
    )
    edges = np.unique(np.concatenate([start, np.arctanh(kinks)]))
    low, width = edges[:-1], np.diff(edges)
    for hunt in range(HUNTS + 1):
        low, width, mass, error = _halved(phase, low, width)
        missing = abs(1.0 - float(mass.sum()))
        if missing <= FOUND + 4 * float(error.sum()) or len(low) > MOST or hunt == HUNTS:
            break
        low, width = _split(low, width, np.full(len(low), 4))
    return PhasePanels(low, width, mass, error, missing)


def _halved(phase: PhaseFunction, low: np.ndarray, width: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return panels, their integrals and errors, halved where the halves differ from the whole by more than rounding."""
    done = [np.empty((4, 0))]
    mass, _ = _masses(phase, low, width)
    total = 0
    for _ in range(ROUNDS):
        half = width / 2
        left, left_noise = _masses(phase, low, half)
        right, right_noise = _masses(phase, low + half, half)
        noise = left_noise + right_noise
        off = np.abs(left + right - mass)
        bad = (off > np.maximum(noise, 8 * EPS * (left + right)) + 1e-19) & (half > 1e-12 * np.maximum(np.abs(low), 1))
        if total + 2 * bad.sum() > MOST:
            bad[:] = False
        good = ~bad
        total += int(good.sum())
        done.append(np.stack([low, width, left + right, off + noise])[:, good])
        low = np.concatenate([low[bad], (low + half)[bad]])
        width, mass = np.tile(half[bad], 2), np.concatenate([left[bad], right[bad]])
        if not len(low):
            break
    found = np.concatenate([*done, np.stack([low, width, mass, mass])], axis=1)
    found = found[:, np.argsort(found[0])]
    return found[0], found[1], found[2], found[3]


def _split(low: np.ndarray, width: np.ndarray, parts: np.ndarray) -> Pair:
    """Return each panel cut into so many equal ones."""
    first = np.repeat(np.cumsum(parts) - parts, parts)
    piece = np.repeat(width / parts, parts)
    return np.repeat(low, parts) + piece * (np.arange(parts.sum()) - first), piece


def _places(s: np.ndarray) -> Pair:
    """Return (1 - mu)/2 and (1 + mu)/2 at mu = tanh s, both with relative accuracy."""
    return 1 / (1 + np.exp(2 * s)), 1 / (1 + np.exp(-2 * s))


def _values(phase: PhaseFunction, s: np.ndarray) -> Pair:
    """Return f at mu = tanh s and its error; where the pdf is not finite, 0: that is missed then."""
    value, error = formula(phase, "density")(phase, *_places(s))
    there = np.isfinite(value) & np.isfinite(error)
    return np.where(there, value, 0.0), np.where(there, error, 0.0)


def _masses(phase: PhaseFunction, low: np.ndarray, width: np.ndarray) -> Pair:
    """Return the probability in each panel by 16 nodes, and what the errors of the pdf are of it."""
    s = low[:, None] + width[:, None] * NODES
    value, error = (x.reshape(s.shape) for x in _values(phase, s.ravel()))
    weight = 8 * np.pi * WEIGHTS * np.multiply(*_places(s))
    return width * (weight * value).sum(axis=1), np.abs(width) * (weight * error).sum(axis=1)


def _moments(phase: PhaseFunction, count: int, low: np.ndarray, width: np.ndarray) -> tuple[np.ndarray, float]:
    s = (low[:, None] + width[:, None] * NODES).ravel()
    x, y = _places(s)
    value, error = _values(phase, s)
    weight = (width[:, None] * WEIGHTS).ravel() * 8 * np.pi * x * y
    mass = weight * value
    return np.array([mass @ P for P in legendre_polynomials(count, x, y)]), float(weight @ error)
