"""Smooth errors of a given size, in any direction of what a test looks along, or in the one that it sees least."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
from planted_samplers import wedge

from fogproof.checks import SamplerCheck, Subject
from fogproof.checks.density.curve import legendre

_TRIES = 12  # points, of which the first that is accepted is taken
_MOST = 2.0  # ratio of densities: half of the points are accepted, and one of 4096 for want of another
_COMPONENTS = 4  # polynomials along an axis
_PRODUCTS = 3  # polynomials of each of two axes
_SHOWN = 0.1  # of the mean square of a combination of polynomials, that the cells must leave

Ratio = Callable[[np.ndarray], np.ndarray]


def in_uniforms(subject: Subject, move: Callable[[np.ndarray], np.ndarray], axis: int = 0) -> Subject:
    """Return the subject with one of its uniforms moved by a map of [0, 1] to itself."""
    sample = subject.sample

    def moved(u: np.ndarray) -> np.ndarray:
        v = np.array(u)
        v[:, axis] = move(v[:, axis])
        return sample(v)

    return replace(subject, sample=moved)


def with_density(density: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    """Return the map from uniform numbers to numbers of a density on [0, 1], by its numerical cdf."""
    edges = np.linspace(0, 1, 1 << 16)
    mass = np.maximum(density(0.5 * (edges[1:] + edges[:-1])), 0.0)
    cdf = np.concatenate([[0.0], np.cumsum(mass)]) / mass.sum()
    return lambda u: np.interp(u, cdf, edges)


def tilted(subject: Subject, ratio: Ratio) -> Subject:
    """Return the subject with the density of its points times a ratio (n,) of mean 1: the first accepted of several points."""
    sample, k = subject.sample, subject.dimensions or 0

    def chosen(u: np.ndarray) -> np.ndarray:
        tries = u.reshape(len(u), _TRIES, k + 1)
        x = sample(tries[:, -1, :k])
        left = np.arange(len(u))
        for each in range(_TRIES):
            y = sample(tries[left, each, :k])
            taken = tries[left, each, k] * _MOST < ratio(y)
            x[left[taken]] = y[taken]
            left = left[~taken]
        return x

    return replace(subject, sample=chosen, dimensions=_TRIES * (k + 1))


def _normalised(s: np.ndarray, components: int) -> np.ndarray:
    """Return (components, n) Legendre polynomials of mean square 1 at s (n,) in [-1, 1], without the constant."""
    return np.asarray(np.sqrt(2 * np.arange(1, components + 1) + 1)[:, None] * legendre(s, components)[1:])


def _direction(k: int, trial: int, up: bool) -> np.ndarray:
    """Return a unit vector (k,): one axis after another, and any direction in between."""
    v = np.eye(k)[trial // 4 % k] if trial % 4 < 2 else np.random.default_rng(trial).normal(size=k)
    return np.asarray((1 if up else -1) * v / np.linalg.norm(v))


def _along(subject: Subject, size: float, trial: int, up: bool, components: int) -> Subject:
    weights = size * _direction(components, trial, up)
    return in_uniforms(subject, with_density(lambda x: 1 + weights @ _normalised(2 * x - 1, components)))


def polynomials(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """A misfit along four polynomials of the first uniform."""
    return _along(subject, size, trial, up, _COMPONENTS)


def straight_and_bent(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """A misfit along the first two."""
    return _along(subject, size, trial, up, 2)


def products(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """A dependence of the two coordinates of the unit square along products of three polynomials of each."""
    weights = size * _direction(_PRODUCTS**2, trial, up).reshape(_PRODUCTS, _PRODUCTS)

    def ratio(x: np.ndarray) -> np.ndarray:
        first, second = (_normalised(2 * column - 1, _PRODUCTS) for column in x.T)
        return 1 + np.sum(first * (weights @ second), axis=0)

    return tilted(subject, ratio)


def few_entries(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """A misfit of a table of few entries, along what these leave of the polynomials, in the direction that shows least."""
    mass = subject.pdf(np.arange(subject.domain.measure))
    ends = np.concatenate([[0.0], np.cumsum(mass)])
    u = np.linspace(0, 1, 1 << 14) + 2.0**-15
    values = _normalised(2 * u[:-1] - 1, _COMPONENTS)
    entry = np.minimum(np.searchsorted(ends, u[:-1], side="right") - 1, len(mass) - 1)
    means = np.stack([np.bincount(entry, row, len(mass)) for row in values]) / np.bincount(entry)
    shares, vectors = np.linalg.eigh((means * mass) @ means.T)
    least = np.flatnonzero(shares > _SHOWN)[0]
    delta = vectors[:, least] @ means / np.sqrt(shares[least])
    wrong = np.cumsum(mass * np.maximum(1 + (size if up else -size) * delta, 0.0))
    return replace(
        subject, sample=lambda u: 1.0 * np.searchsorted(wrong / wrong[-1], u[:, 0], side="right").clip(0, len(mass) - 1)
    )


@cache
def _least_seen() -> Ratio:
    """Return the misfit of mean square 1 of the wedge that the labels of a check see least."""
    from scipy.linalg import eigh

    check = SamplerCheck.of(wedge(), None, 1 << 17, 1e-4, 1)
    mixture, sums = check.prepared.counter.mixture, check.tally(range(check.batches)).labels
    assert mixture is not None
    assert sums is not None
    covariance, gram = (products[:-1, :-1] / sums[0].spread[1, -1, -1] for products in sums[0].spread)
    shares, directions = eigh(gram, covariance)
    weights = directions[:, -1] / np.sqrt(shares[-1])
    return lambda x: weights @ mixture.basis.at(x)


def least_seen(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """A misfit of the wedge along smooth functions, in the direction that moves the fewest coins."""
    delta = _least_seen()
    return tilted(subject, lambda x: 1 + (size if up else -size) * delta(x))
