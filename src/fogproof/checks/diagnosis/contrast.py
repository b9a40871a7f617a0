"""Samples beside points of a known law: how well does a density explain which is which?

Given a point, the label "sample" has probability c s / (c s + q) if the samples have the density c s and the other points the
density q (noise-contrastive estimation; Gutmann & Hyvarinen 2012). So any density, normalised or not, on any domain, has a
likelihood, and residuals in cells that tell how much it leaves unexplained. No integral is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product

import numpy as np

from fogproof.checks.density.tree import Tree
from fogproof.checks.mixture import moved_by_rounding
from fogproof.checks.promises import at_any_atom, inside
from fogproof.checks.subject import Subject, in_domain
from fogproof.domains import Law

Density = Callable[[np.ndarray], np.ndarray]

_PER_LEAF = 16  # pilot points in a cell of the known law
_ANYWHERE = 0.2  # share of the known law that is the domain's own
_BACKGROUND = 1e-4  # of the known law is added to every density: one stray point refutes none
_CELLS = 256
_WAVES = 4  # along each axis
_MOST_AXES = 6  # along which there are waves
_FEW_AXES = 3  # of which the products of second waves are taken too
_PER_CELL = 64  # points in a cell, at least
_ROUNDED = 1 << 12  # pilot points at which the effect of rounding is looked at
_BEGUN = 512  # points that tell where to begin
_THIN = 16  # every so manyth point tells the constant well enough to begin with


@dataclass(frozen=True)
class Fit:
    """How a density explains the samples.

    likelihood  logarithm of it
    constant    by which the density had to be multiplied
    left        chi-square of the residuals in cells, less its degrees of freedom
    freedom     of that chi-square
    doubt       standard error of the logarithm of the constant
    """

    likelihood: float
    constant: float
    left: float
    freedom: int
    doubt: float


@dataclass(frozen=True)
class Contrast:
    """Samples x (n, ...), points z (m, ...) of a known law, and the known density at both, x first; `cell` says where each lies.

    whole  whether no points are left out because rounding changes their density
    """

    law: Law
    tree: Tree
    x: np.ndarray
    z: np.ndarray
    q: np.ndarray
    cell: np.ndarray
    whole: bool = True

    @staticmethod
    def of(subject: Subject, n: int, rng: np.random.Generator, jumps: bool = False) -> Contrast | None:
        """Draw about n samples, and as many points of a law that follows a pilot of them; None if there are too few.

        jumps  whether points stay at which rounding changes the density: that of samples there says nothing
        """
        wanted = subject.pilot or max(n // 2, 1 << 12)
        pilot, x = good_points(subject, rng, wanted), good_points(subject, rng, n)
        if len(pilot) < _PER_CELL or len(x) < _PER_CELL:
            return None
        law = subject.domain.law(pilot)
        k = len(law.axes)
        tree = Tree.of(law.coordinates(pilot, rng.random((len(pilot), k))), _PER_LEAF)
        anywhere = int(_ANYWHERE * len(x)) if tree.share.any() else len(x)
        u = np.concatenate([rng.random((anywhere, k)), tree.draw(rng, len(x) - anywhere)])
        z = law.place(u)
        both = np.concatenate([x, z])
        coordinates = np.concatenate([law.coordinates(x, rng.random((len(x), k))), u])
        leaf = tree.leaf(coordinates)
        share, whole = anywhere / len(x), True
        q = law.density(both) * (share + (1 - share) * tree.density(coordinates, leaf))
        if (
            not (jumps or law.stepped) and moved_by_rounding(subject, pilot[:_ROUNDED]).any()
        ):  # their density says nothing
            telling = in_domain(subject.domain, both, subject.roundoff)
            telling[telling] = ~moved_by_rounding(subject, both[telling])
            whole = bool(telling.all())
            x, z, q, leaf = x[telling[: len(x)]], z[telling[len(x) :]], q[telling], leaf[telling]
            if min(len(x), len(z)) < _PER_CELL:
                return None
        cells = min(_CELLS, max(len(x) // _PER_CELL, 1), len(tree.share))
        return Contrast(law, tree, x, z, q, leaf * cells // len(tree.share), whole)

    @cached_property
    def points(self) -> np.ndarray:
        """All points, the samples first."""
        return np.concatenate([self.x, self.z])

    def part(self, n: int) -> Contrast:
        """Return the contrast of the first n samples and as many evenly chosen known points."""
        kept = self.kept(n)
        if kept is None:
            return self
        return Contrast(self.law, self.tree, self.x[:n], self.z[kept[n:] - len(self.x)], self.q[kept], self.cell[kept])

    def kept(self, n: int) -> np.ndarray | None:
        """Return which of all points (2 n,) such a part has, None if it is the whole."""
        if n >= len(self.x):
            return None
        return np.concatenate([np.arange(n), len(self.x) + np.linspace(0, len(self.z) - 1, n).astype(int)])

    def likelihood(self, s: np.ndarray) -> float:
        """Return the logarithm of the likelihood of the labels under a density with values s (n + m,), samples first."""
        return self._explained(s)[0]

    def fit(self, s: np.ndarray) -> Fit:
        """Return how well a density with values s (n + m,) at all points, samples first, explains the labels."""
        likelihood, log_c, odds = self._explained(s)
        w = odds / (1 + odds)
        label = np.zeros(len(w))
        label[: len(self.x)] = 1.0
        cells = int(self.cell.max()) + 1
        residual, variance = (np.bincount(self.cell, v, cells) for v in (label - w, w * (1 - w)))
        left = float(np.sum(residual**2 / (variance + 1.0))) - cells
        doubt = 1 / math.sqrt(max(float(variance.sum()), 1e-300))
        return Fit(likelihood, float(np.exp(log_c)), left, cells, doubt)

    def odds(self, s: np.ndarray) -> np.ndarray:
        """Return the odds (n + m,) of each point to be a sample under a density with values s."""
        return self._explained(s)[2]

    @cached_property
    def waves(self) -> np.ndarray:
        """Return 1, cosines of up to four half waves along each of the first axes, and products of two axes' first, at all points.

        (n + m, 1 + 4 k + pairs) for k axes, of few of them with the products of the second ones.

        By Chebyshev's recurrence, cos (k + 1) t = 2 cos t cos k t - cos (k - 1) t.
        """
        k = min(len(self.law.axes), _MOST_AXES)
        u = self.law.coordinates(self.points, np.full((len(self.points), len(self.law.axes)), 0.5))[:, :k]
        waves = np.ones((_WAVES + 1, k, len(u)))
        waves[1] = np.cos(np.pi * u.T)
        for order in range(2, _WAVES + 1):
            waves[order] = 2 * waves[1] * waves[order - 1] - waves[order - 2]
        orders = list(product((1, 2) if k <= _FEW_AXES else (1,), repeat=2))
        pairs = [waves[a, i] * waves[b, j] for i, j in combinations(range(k), 2) for a, b in orders]
        return np.concatenate([waves[0, :1], *waves[1:], np.array(pairs).reshape(-1, len(u))]).T

    def _explained(self, s: np.ndarray) -> tuple[float, float, np.ndarray]:
        """Return the likelihood of a density, the logarithm of its best constant, and the odds of each point to be a sample."""
        n = len(self.x)
        ratio = np.where((s > 0) & np.isfinite(s), s, 0.0) / self.q  # a mixture of less than nothing gains nothing
        few = ratio[np.r_[0:n:_THIN, n : len(ratio) : _THIN]]
        some = few[few > 0][:: max(len(few) // _BEGUN, 1)]
        usual = -float(np.log(np.median(some))) if len(some) else 0.0  # Newton's method begins within reach
        start, settled = _best_constant(few, -(-n // _THIN), usual)
        log_c, _ = _best_constant(ratio, n, start if settled else usual)
        odds = np.exp(log_c) * ratio + _BACKGROUND
        return float(np.sum(np.log(odds[:n] / (1 + odds[:n]))) - np.sum(np.log1p(odds[n:]))), log_c, odds


def _best_constant(ratio: np.ndarray, n: int, log_c: float) -> tuple[float, bool]:
    """Return the logarithm of the factor of `ratio` with which n points are expected to be samples, and whether there is one.

    By Newton's method, from log_c. Where the density is 0 at too many points, there is none.
    """
    for _ in range(60):
        w = np.exp(log_c) * ratio + _BACKGROUND
        w /= 1 + w
        total = float(w.sum())
        step = float(np.clip((n - total) / max(total - float(w @ w), 1e-9), -2, 2))
        log_c += step
        if abs(step) < 1e-6:
            return log_c, True
    return log_c, False


def good_points(subject: Subject, rng: np.random.Generator, n: int) -> np.ndarray:
    """Return the samples, of n drawn, that are points of the continuous part."""
    draw = subject.draw(rng, n)
    good = inside(subject, draw) & in_domain(subject.domain, draw.x, subject.roundoff)
    if subject.atoms:
        good &= ~at_any_atom(subject, draw.x)
    if draw.valid is not None:
        good &= draw.valid
    return draw.x[good]


def claimed(subject: Subject) -> Density:
    """Return the claimed density, 0 outside the domain."""

    def density(x: np.ndarray) -> np.ndarray:
        within = in_domain(subject.domain, x, 64 * subject.roundoff)
        p = np.zeros(len(x))
        if within.all():  # nothing to pick out
            p = subject.density(x)
        elif within.any():
            p[within] = subject.density(x[within])
        return np.where(np.isfinite(p), p, 0.0)

    return density
