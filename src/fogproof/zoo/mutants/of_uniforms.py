"""Errors of a sampler's uniforms, with the samples that the best test of the points needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.catalogue import SamplerCase
from fogproof.catalogue.cases import points_of
from fogproof.zoo.bug import Planted
from fogproof.zoo.limits import samples_needed
from fogproof.zoo.mutants.mutation import Mutated
from fogproof.zoo.mutants.planting import Array, planted

BEND, SKIPPED, TAIL, RIPPLE = 1.1, 0.01, 1e-3, 0.1


@dataclass(frozen=True)
class OfUniforms:
    """The sampler of changed uniforms: of those that its points depend on.

    change   (n, d) uniforms -> changed ones
    density  of the changed uniforms at (n, d) of them, None where no density has what gives the error away
    least    least number of uniforms that matter
    """

    change: Callable[[Array], Array]
    density: Callable[[Array], Array] | None = None
    least: int = 1

    def __call__(self, case: SamplerCase) -> Mutated | None:
        """Plant it."""
        right = planted(case)
        used = _that_matter(right, case)
        if len(used) < self.least:
            return None

        def sample(u: Array) -> Any:
            changed = u.copy()
            changed[:, used] = self.change(u[:, used])
            return right.sample(changed)

        density = self.density
        needed = (lambda: 1.0) if density is None else (lambda: _needed(right, lambda u: density(u[:, used])))
        return Mutated(replace(right, sample=sample), needed)


def _that_matter(subject: Planted, case: SamplerCase) -> list[int]:
    """Return which uniforms points depend on: some plugins take one that they ignore."""
    if subject.dimensions is None:
        return []
    rng = np.random.default_rng(1)
    u = rng.random((64, subject.dimensions)).astype(case.options.get("precision", "float64"))
    x, found = np.asarray(points_of(subject.sample(u))), []
    for column in range(subject.dimensions):
        other = u.copy()
        other[:, column] = rng.permutation(u[:, column])
        if not np.array_equal(x, points_of(subject.sample(other))):
            found.append(column)
    return found


def _needed(right: Planted, density: Callable[[Array], Array], pairs: int = 200_000) -> float:
    """Return a lower bound on the samples that the best test of the points needs, from the density of the changed uniforms.

    The points' chi-square distance is the variance of E[f(U) | X], the mean of (f(U) - 1)(f(U') - 1) over uniforms U, U' that
    lead to the same point: here to neighbouring points of many. Five standard errors are added, so that chance excuses nothing.
    """
    from scipy.spatial import cKDTree

    u = np.random.default_rng(1).random((pairs, right.dimensions or 0))
    x = np.asarray(points_of(right.sample(u)), dtype=float).reshape(pairs, -1)
    at = np.all(np.isfinite(x), axis=1)
    x, off = x[at], density(u[at]) - 1
    _, near = cKDTree(x + 1e-12 * np.random.default_rng(2).standard_normal(x.shape)).query(x, k=2)
    product = off * off[near[:, 1]]
    return samples_needed(max(float(product.mean()), 0.0) + 5 * float(product.std()) / np.sqrt(len(product)))


def of_the_first(change: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Change the first uniform alone."""

    def changed(u: Array) -> Array:
        u[:, 0] = change(u[:, 0])
        return u

    return changed


def of_the_last(change: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Change the last uniform alone."""

    def changed(u: Array) -> Array:
        u[:, -1] = change(u[:, -1])
        return u

    return changed


def skip(v: Array) -> Array:
    """Never draw what lies between 0.41 and 0.42."""
    squeezed = (1 - SKIPPED) * v
    return np.where(squeezed > 0.41, squeezed + SKIPPED, squeezed)


_STEPS = np.linspace(0, 1, 4097)
_RIPPLED = _STEPS + RIPPLE * (1 - np.cos(6 * np.pi * _STEPS)) / (6 * np.pi)


def ripple(v: Array) -> Array:
    """Draw with the density 1 + 0.1 sin(6 pi v)."""
    return np.minimum(np.interp(v, _RIPPLED, _STEPS), 1 - 2.0**-24)


def as_first(u: Array) -> Array:
    """Use the first uniform twice."""
    u[:, 1] = u[:, 0]
    return u


def lumped(case: SamplerCase) -> Mutated | None:
    """All uniforms of a strip lead to one point, which is no atom by itself."""
    right = planted(case)
    for place in (0.3, 0.05, 0.7, 0.95):
        change = OfUniforms(partial(_lump, place))
        mutated = change(case)
        if mutated is None or _single(right, place):
            return mutated
    return None


def _lump(place: float, u: Array) -> Array:
    u[np.abs(u[:, 0] - place) < 5e-4] = place
    return u


def _single(subject: Planted, place: float) -> bool:
    """Return whether uniforms beside a place lead to different points, so that the point there is no atom."""
    u = np.full((2, subject.dimensions or 1), place)
    u[1] += 1e-3
    x = np.asarray(points_of(subject.sample(u)))
    return not np.array_equal(x[0], x[1])


def coarse(u: Array) -> Array:
    """Keep 12 bits."""
    return np.floor(u * 4096) / 4096 + 2.0**-13


def bent(u: Array) -> Array:
    """Return the density of the first uniform to the power 1.1."""
    return np.maximum(u[:, 0], 1e-300) ** (1 / BEND - 1) / BEND


def without(low: float, high: float) -> Callable[[Array], Array]:
    """Return the density of a uniform that is never between `low` and `high`."""
    return lambda u: np.where((u[:, 0] > low) & (u[:, 0] < high), 0.0, 1 / (1 - (high - low)))
