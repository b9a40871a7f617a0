"""A hypothesis about a misfit: a density that the samples might have instead of the claimed one, with at most one parameter."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from fogproof.checks.density.determinant import determinant
from fogproof.checks.diagnosis.contrast import Contrast, Density
from fogproof.domains import Domain, Law

_PINNED = 5e-3  # relative standard error of a parameter that may be named
_SIMPLE = 0.02  # how near a whole or half number a power must lie, beside three standard errors
_SIMPLE_ERROR = 0.15  # most of those
_STEP = 1e-5  # of the way to the nearer end of an axis


@dataclass(frozen=True)
class Setting:
    """What hypotheses may look at: the domain, its known law, the claimed density p, samples x and points z of density q.

    values  claimed density (n + m,) at all points of the contrast, where nearly every hypothesis asks for it
    """

    domain: Domain
    law: Law
    claim: Density
    contrast: Contrast
    values: np.ndarray

    @staticmethod
    def of(domain: Domain, claim: Density, contrast: Contrast) -> Setting:
        """Return the setting of a claimed density, which is evaluated at all points of the contrast."""
        return Setting(domain, contrast.law, claim, contrast, claim(contrast.points))

    def p(self, x: np.ndarray) -> np.ndarray:
        """Return the claimed density; at all points of the contrast it is known."""
        return self.values if x is self.contrast.points else self.claim(x)

    def part(self, n: int) -> Setting:
        """Return what hypotheses may look at of the first n samples and as many known points."""
        kept = self.contrast.kept(n)
        return self if kept is None else replace(self, contrast=self.contrast.part(n), values=self.values[kept])

    def claimed_mean(self) -> np.ndarray:
        """Return the mean of the points under the claimed density."""
        z, n = self.contrast.z, len(self.contrast.x)
        weight = self.values[n:] / self.contrast.q[n:]
        return np.tensordot(weight, z, axes=1) / max(float(weight.sum()), 1e-300)

    def claimed_points(self, most: int) -> np.ndarray:
        """Return points where the claim has its probability, (most, ...): what they tell of it holds beyond where samples are."""
        n = len(self.contrast.x)
        share = np.cumsum(np.maximum(self.values[n:], 0.0) / self.contrast.q[n:])
        at = np.searchsorted(share, share[-1] * (np.arange(most) + 0.5) / most)
        return self.contrast.z[np.minimum(at, len(share) - 1)]

    def moved(self, back: Callable[[np.ndarray], np.ndarray], jacobian: Density | None = None) -> Density:
        """Return the density of points that a map has moved, by the inverse of the map: p(y) |dy/dx| at y = back(x).

        jacobian  x -> |dy/dx| in the measure of the domain, where it has a closed form; differences cost five times as much
        """

        def density(x: np.ndarray) -> np.ndarray:
            y = back(x)
            with np.errstate(all="ignore"):
                volume = jacobian(x) if jacobian else self._volume(back, x) * self.law.density(x) / self.law.density(y)
            return np.where(np.isfinite(volume), self.p(y) * volume, 0.0)

        return density

    def _volume(self, back: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
        half = np.full((len(x), len(self.law.axes)), 0.5)

        def map_back(u: np.ndarray) -> np.ndarray:
            return self.law.coordinates(back(self.law.place(u)), half)

        return determinant(map_back, self.law.coordinates(x, half), _STEP)


@dataclass(frozen=True)
class Hypothesis:
    """One explanation.

    cause    the class of error it is
    words    the explanation as a sentence about "these samples"; {value} stands for the fitted parameter
    density  (setting, parameter) -> the density that the samples would have, known up to a constant
    trials   values of the parameter to begin with, in order; () if there is none
    fitted   how many parameters were taken from the samples beforehand
    named    parameter -> what it is better known as, "" if it is nothing special
    null     the parameter with which it is the claim itself, None if there is none
    below    the class of error where the parameter is less than that, `cause` unless given
    prior    logarithm of how much likelier it is than others before any sample is seen
    otherwise  the class of error where the parameter is no whole or half number, `cause` unless given
    power    whether it raises the density to a power: of one part of a product, that would raise the other parts too
    loose    whether it only says where samples are wrong, in rates: what these leave there refutes nothing
    """

    cause: str
    words: str
    density: Callable[[Setting, float], Density]
    trials: tuple[float, ...] = ()
    named: Callable[[float, float], str] = field(default=lambda value, error: "")
    fitted: int = 0
    prior: float = 0.0
    otherwise: str = ""
    null: float | None = None
    below: str = ""
    loose: bool = False
    power: bool = False

    def caused(self, value: float, error: float) -> str:
        """Return the class of error, given the fitted parameter and its standard error."""
        if self.below and self.null is not None and value < self.null:
            return self.below
        pinned = 3 * error < _SIMPLE_ERROR
        simple = pinned and abs(2 * value - round(2 * value)) < 2 * (3 * error + _SIMPLE) and round(2 * value) != 0
        return self.otherwise if self.otherwise and not simple else self.cause

    def price(self, n: int) -> float:
        """Return what the parameters cost on n samples, in log-likelihood (Schwarz 1978), less what was known before."""
        return 0.5 * math.log(n) * (bool(self.trials) + self.fitted) - self.prior

    def said(self, value: float, error: float) -> str:
        """Return the explanation with the fitted parameter and its standard error."""
        digits = max(math.ceil(-math.log10(max(error, 1e-12))) + 1, 1) if error > 0 else 4
        number = f"{value:.{min(digits, 12)}f} +- {error:.1g}" if self.trials else ""
        known = self.named(value, error) if self.trials else ""
        return self.words.format(value=number) + (f", {known}" if known else "")


def known_number(table: dict[float, str], pinned: float = _PINNED) -> Callable[[float, float], str]:
    """Return what names a parameter that lies within three standard errors of a telling number, if these are small.

    pinned  the largest relative standard error of a parameter that is named: whole numbers are told apart by less
    """

    def named(value: float, error: float) -> str:
        if error > pinned * abs(value):
            return ""
        near = {words for number, words in table.items() if abs(value - number) < 3 * error + 1e-3 * abs(number)}
        return near.pop() if len(near) == 1 else ""

    return named


def of_points(back: Callable[[np.ndarray], np.ndarray]) -> Callable[[Setting, float], Density]:
    """Return the hypothesis that the samples have the claimed density at back(x): a map that keeps volumes moved them."""
    return lambda setting, _: lambda x: setting.p(back(x))
