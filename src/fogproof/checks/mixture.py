"""Samples mixed with points of a known law by coin tosses: what the label test counts.

The known law is a mixture itself: mostly the histogram of a pilot sample, which makes the coins about fair wherever the claim is
right, and a share of the domain's own law, which is nowhere zero. Evenly spread points of the domain look for what the claim has
where the pilot has not been; if there is any, the histogram follows it too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.density.lattice import lattice
from fogproof.checks.density.tree import Tree
from fogproof.checks.statistics.integrated import Integrated
from fogproof.checks.statistics.label_scores import Basis
from fogproof.checks.statistics.label_strips import Strips
from fogproof.checks.statistics.labels import Sums
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject, in_domain
from fogproof.contracts import Draw
from fogproof.domains import Law

_PER_LEAF = 12  # pilot points in a leaf of the histogram
_ANYWHERE = 0.1  # share of the domain's own law
_LOOK = 400_000  # evenly spread points: all those that raise doubts about quadrature are among them
_CHECKED = 1 << 15  # pilot points at which the effect of rounding is looked at
_UNSEEN = 0.9  # probability of being a sample, above which the pilot should have been there
_NEGLIGIBLE = 1e-3  # mass that need not be followed
_ROUNDS = 3  # of following
_LEAST_PILOT = 1 << 14  # points that a histogram is made of, at least
_FOLLOWED = 0.25  # share of the points that follow what the pilot has not seen
_MOVED = 1e-2  # relative change of the pdf by rounding, from which on its value says nothing
_FEW = 1e-3  # of the points: so many may lie so near the edges of their cells
_FINE = 2.0**20  # roundings: sides of cells that all are longer need no look
_THIN = 8.0  # roundings: a shorter side cannot be drawn from, the points would come out beside it
_SIX = 6.0  # standard deviations


@dataclass(frozen=True)
class MixtureTest:
    """The known law of one subject.

    tree     in the coordinates of the domain's law
    basis    smooth functions of the same coordinates
    strips   along the same axes
    seed     of the check
    most     batches that are mixed: the first so many
    rounded  whether the pdf changes much by rounding somewhere: such points are left out
    steps    the same of the histogram, whose cells may be hardly larger than the steps of the points
    """

    subject: Subject
    law: Law
    tree: Tree
    basis: Basis
    strips: Strips
    seed: int
    most: int
    rounded: bool
    steps: bool = False

    @staticmethod
    def of(subject: Subject, law: Law, points: np.ndarray, seed: int, most: int) -> MixtureTest:
        """Return the mixture that follows pilot points (n, ...) of the domain."""
        rng = batch_generator(seed, "labels", 0, 0)
        u = law.coordinates(points, rng.random((len(points), len(law.axes))))
        rounded = len(points) > 0 and not law.stepped and bool(moved_by_rounding(subject, points[:_CHECKED]).any())
        mixture = MixtureTest(subject, law, Tree.of(u, _PER_LEAF), Basis.of(u), Strips.of(u), seed, most, rounded)
        return mixture._without_thin_cells(points)

    def _without_thin_cells(self, points: np.ndarray) -> MixtureTest:
        """Return the mixture without cells thinner than the steps of points; `points` tell whether the others need care.

        Points drawn in such a cell come out beside it, where the known density is another: what follows from it would be false.
        Samples crowd in one where they are clamped, or where single precision leaves no others.
        """
        single = self.subject.precision == "float32"
        sides = self.tree.high - self.tree.low
        if self.law.stepped or len(points) == 0 or not (single or sides.min() < _FINE * self.subject.roundoff):
            return self
        middle = 0.5 * (self.tree.low + self.tree.high)
        half = np.full(middle.shape, 0.5)
        x = self.law.place(middle)
        near = [self.law.coordinates(y, half) for y in (x, *self._beside(x))]
        step = np.max([np.abs(u - middle) for u in near], axis=0)
        kept = replace(self, tree=self.tree.without(np.any(sides < _THIN * step, axis=1)))
        across = kept._across(points[:_CHECKED])
        return replace(kept, steps=bool(np.mean(across) > (_FEW if single else 0.0)))

    def wider(self, points: np.ndarray) -> MixtureTest:
        """Return the mixture that also follows the pdf where it is high and no pilot point was: evenly spread points find it."""
        rng = batch_generator(self.seed, "labels", 0, 1)
        k = len(self.law.axes)
        u = lattice(_LOOK, k, np.full(k, 0.5))
        x = self.law.place(u)
        unseen = self._unseen(rng, u, x, self.law.density(x))
        if len(unseen) == 0:
            return self
        own = self.law.coordinates(points, rng.random((len(points), k)))
        n = max(len(own), _LEAST_PILOT)
        found, wider, side = np.empty((0, k)), self, _LOOK ** (-1 / k)
        for _ in range(_ROUNDS):  # each finds more of the place whose edge the last one found
            follow = unseen[rng.integers(0, len(unseen), int(_FOLLOWED * n))]
            follow = np.clip(follow + side * (2 * rng.random(follow.shape) - 1), 0, 1)
            found = np.concatenate([found, follow])
            wider = replace(self, tree=Tree.of(rng.permutation(np.concatenate([own, found])), _PER_LEAF))
            wider = wider._without_thin_cells(points)
            x, u = wider._drawn(rng, n)
            unseen = wider._unseen(rng, u, x, wider._q(x, u, wider.tree.leaf(u)))
            if len(unseen) == 0:
                break
        return wider

    def _unseen(self, rng: np.random.Generator, u: np.ndarray, x: np.ndarray, law: np.ndarray) -> np.ndarray:
        """Return those of the coordinates u (n, k) where the pdf is high beyond the histogram, repeated by the mass they stand for.

        x, law  the points there, and the density (n,) that they were drawn with
        """
        p = self.density(x)
        with np.errstate(all="ignore"):
            high = np.isfinite(p) & (p > _UNSEEN / (1 - _UNSEEN) * self._q(x, u, self.tree.leaf(u)))
            most = 0.5 * np.finfo(np.float64).max / len(u)  # so that the sum of any claim is finite
            mass = np.where(high, np.minimum(p / law, most), 0.0)
        total = mass.sum()
        if not total > _NEGLIGIBLE * len(u):
            return np.empty((0, u.shape[1]))
        return u[rng.choice(len(u), 1 << 12, p=mass / total)]

    def density(self, x: np.ndarray) -> np.ndarray:
        """Return (n,) the claimed density at points that may lie outside the domain, where it is 0."""
        inside = in_domain(self.subject.domain, x, self.subject.roundoff)
        if inside.all():
            return self.subject.density(x)
        p = np.zeros(len(x))
        p[inside] = self.subject.density(x[inside])
        return p

    def nothing(self) -> Sums:
        """Return the sums over no points."""
        none = np.empty(0)
        weighed = self._weighed(np.empty((0, len(self.law.axes))), none, none)
        return Sums.of(none, none, none.astype(np.intp), len(self.tree.share), Integrated.of(none).sums, weighed)

    def _weighed(self, u: np.ndarray, labels: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return *self.basis.weighed(u, labels, w), self.strips.sums(u, labels, w)

    def count(self, draw: Draw, good: np.ndarray, p: np.ndarray, index: int) -> tuple[Sums, Sums]:
        """Return the sums over batch number `index`: with all samples as labels, and with those alone that were not given up.

        good  (n,) which samples are good points of the continuous part
        p     the claimed density there
        """
        rng = batch_generator(self.seed, "labels", 1, index)
        tried = np.ones(len(good), dtype=bool) if draw.valid is None else draw.valid
        every = self._sums(draw.x, good, p, rng, np.arange(len(good)))
        return every, (every if tried.all() else self._sums(draw.x, good, p, rng, np.flatnonzero(tried)))

    def _sums(
        self, x: np.ndarray, good: np.ndarray, p: np.ndarray, rng: np.random.Generator, tried: np.ndarray
    ) -> Sums:
        n = len(tried)
        tosses = max(int(2 * n - _SIX * np.sqrt(2 * n)), 0)
        samples = min(int(rng.binomial(tosses, 0.5)), n)
        used = tried[:samples]
        used = used[good[used]]
        at = np.cumsum(good) - 1
        known, u = self._drawn(rng, tosses - samples)
        points = np.concatenate([x[used], known])
        claimed = np.concatenate([p[at[used]], self.density(known)])
        v = rng.random((len(points), len(self.law.axes))) if self.law.stepped else points
        coordinates = self.law.coordinates(points, v)
        if self.law.stepped:
            coordinates[len(used) :] = u
        leaf = self.tree.leaf(coordinates)
        q = self._q(points, coordinates, leaf)
        labels = np.zeros(len(points))
        labels[: len(used)] = 1.0
        with np.errstate(all="ignore"):
            ratio = claimed / q
            w = ratio / (1 + ratio)
        telling = np.isfinite(ratio) & (ratio > 0)
        if self.rounded:
            telling &= ~moved_by_rounding(self.subject, points)
        if self.steps:
            telling &= ~self._across(points)
        integrated = Integrated.of(np.where(telling | (claimed == 0), ratio, np.nan)[len(used) :]).sums
        if not telling.all():
            labels, w, leaf, coordinates = labels[telling], w[telling], leaf[telling], coordinates[telling]
        return Sums.of(labels, w, leaf, len(self.tree.share), integrated, self._weighed(coordinates, labels, w))

    def _across(self, points: np.ndarray) -> np.ndarray:
        """Return (n,) which points lie so near another cell of the histogram that rounding, or the known law, confuses them."""
        k = len(self.law.axes)
        leaf = self.tree.leaf(self.law.coordinates(points, np.full((len(points), k), 0.5)))
        across = np.zeros(len(points), dtype=bool)
        for near in self._beside(points):
            across |= self.tree.leaf(self.law.coordinates(near, np.full((len(near), k), 0.5))) != leaf
        return across

    def _beside(self, points: np.ndarray) -> list[np.ndarray]:
        """Return copies of the points as far off as rounding moves them, and as the points of the known law are apart."""
        return [*self.subject.nudged(points), *self.law.neighbours(points)]

    def known(self, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return n points of the known law and its density (n,) there."""
        x, u = self._drawn(rng, n)
        return x, self._q(x, u, self.tree.leaf(u))

    def _q(self, x: np.ndarray, u: np.ndarray, leaf: np.ndarray) -> np.ndarray:
        return self.law.density(x) * (_ANYWHERE + (1 - _ANYWHERE) * self.tree.density(u, leaf))

    def _drawn(self, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return n points of the known law, in no special order, and their coordinates."""
        anywhere = int(rng.binomial(n, _ANYWHERE)) if self.tree.share.any() else n
        u = np.concatenate([rng.random((anywhere, len(self.law.axes))), self.tree.draw(rng, n - anywhere)])
        x = self.law.place(u)
        if self.subject.precision == "float32":
            x = x.astype(np.float32).astype(np.float64)
        return x, u

    def describe(self, depth: int, number: int) -> str:
        """Return in words where a node of the tree lies: the shares of the known law along each axis."""
        step = len(self.tree.share) >> depth
        leaves = slice(number * step, (number + 1) * step)
        low, high = self.tree.low[leaves].min(axis=0), self.tree.high[leaves].max(axis=0)
        corners = self.law.place(np.stack([low, np.minimum(high, 1 - 2.0**-53)]))
        if corners.ndim == 1:
            return f"{corners[0]:.6g} to {corners[1]:.6g}"
        middle = self.law.place(0.5 * (low + high)[None])[0]
        return f"about ({', '.join(f'{c:.6g}' for c in middle)})"


def moved_by_rounding(subject: Subject, points: np.ndarray) -> np.ndarray:
    """Return (n,) where the pdf changes so much by rounding of the point that its value there says nothing."""
    p = subject.density(points)
    moved = np.isinf(p)
    for near in subject.nudged(points):
        with np.errstate(all="ignore"):
            moved |= ~(np.abs(subject.density(near) - p) <= _MOVED * p) & (p > 0)
    return moved
