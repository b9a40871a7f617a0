"""Right samplers, in which errors of a stated size are planted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.checks import Subject
from fogproof.contracts import Draw
from fogproof.domains import Box, Discrete, Interval, UnitSphere, UnitSquare


def ones(x: np.ndarray) -> np.ndarray:
    """Return the uniform density on a domain of measure 1."""
    return np.ones(len(x))


def line() -> Subject:
    """Return uniform points of [0, 1]."""
    return Subject(lambda u: u[:, 0].copy(), ones, Interval(0, 1), 1)


def square() -> Subject:
    """Return uniform points of the unit square."""
    return Subject(lambda u: u.copy(), ones, UnitSquare(), 2)


def box() -> Subject:
    """Return uniform points of a box, which labels judge."""
    return Subject(lambda u: u.copy(), ones, Box((0.0,), (1.0,)), 1)


def volume() -> Subject:
    """Return uniform points of a cube, which labels judge."""
    return Subject(lambda u: u.copy(), ones, Box((0.0,) * 3, (1.0,) * 3), 3)


def stream() -> Subject:
    """Return uniform points of [0, 1] that draw their own uniforms."""
    return Subject(lambda rng, n: rng.random(n), ones, Interval(0, 1), None)


def with_atoms() -> Subject:
    """Return an atom of probability 0.05 in uniform points."""

    def sample(u: np.ndarray) -> np.ndarray:
        return np.where(u[:, 0] < 0.05, 0.5, u[:, 1])

    return Subject(sample, lambda x: 0.95 * ones(x), Interval(0, 1), 2, {0.5: 0.05})


def with_events() -> Subject:
    """Return uniform points with an event of probability 0.3."""
    return Subject(
        lambda u: Draw(u[:, 0], event=(u[:, 1] < 0.3) * 1.0), ones, Interval(0, 1), 2, events={1: 0.3, 0: 0.7}
    )


def weighted() -> Subject:
    """Return uniform points with weights of mean 0.6."""
    return Subject(lambda u: Draw(u[:, 0], weight=1.2 * u[:, 0]), ones, Interval(0, 1), 1, albedo=0.6)


def lobe() -> Subject:
    """Return directions with the density (1 + z) / (4 pi)."""

    def sample(u: np.ndarray) -> np.ndarray:
        z, phi = 2 * np.sqrt(u[:, 0]) - 1, 2 * np.pi * u[:, 1]
        s = np.sqrt(np.maximum(1 - z * z, 0))
        return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)

    pdf = lambda x: (1 + x[:, 2]) / (4 * np.pi)  # noqa: E731
    return Subject(sample, pdf, UnitSphere(), 2, axis=(0.0, 0.0, 1.0), mean_cosine=1 / 3, eval=pdf, albedo=1.0)


def table() -> Subject:
    """Return entries of a table of 1000 that grow linearly."""
    weights = np.arange(1.0, 1001.0) / 500500
    cdf = np.cumsum(weights)
    sample = lambda u: np.minimum(np.searchsorted(cdf, u[:, 0], side="right"), 999) * 1.0  # noqa: E731
    return Subject(sample, lambda i: weights[np.asarray(i).astype(int)], Discrete(1000), 1)


def few() -> Subject:
    """Return entries of a table of six, most of which come seldom."""
    weights = np.array([0.55, 0.3, 0.08, 0.04, 0.02, 0.01])
    cdf = np.cumsum(weights)
    sample = lambda u: np.minimum(np.searchsorted(cdf, u[:, 0], side="right"), 5) * 1.0  # noqa: E731
    return Subject(sample, lambda i: weights[np.asarray(i).astype(int)], Discrete(6), 1)


def wedge() -> Subject:
    """Return points of a square with the density 4 x y, which labels judge."""
    return Subject(lambda u: np.sqrt(u), lambda x: 4 * x[:, 0] * x[:, 1], Box((0.0,) * 2, (1.0,) * 2), 2)


_PEAK = 0.99


def _peak(hint: str) -> Subject:
    """Return directions of Henyey-Greenstein's lobe with g = 0.99 in single precision, and its cdf as a hint."""
    g = _PEAK

    def versine(x: np.ndarray) -> np.ndarray:
        small = (x[:, 0] ** 2 + x[:, 1] ** 2) / (1 + np.abs(x[:, 2]))
        return np.where(x[:, 2] < 0, 2 - small, small)

    def sample(u: np.ndarray) -> np.ndarray:
        one = u.dtype.type
        s = one(1 - g * g) / (one(1 - g) + one(2 * g) * u[:, 0])
        mu, phi = np.clip((one(1 + g * g) - s * s) / one(2 * g), -1, 1), one(2 * np.pi) * u[:, 1]
        sine = np.sqrt(1 - mu * mu)
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)

    def cdf(x: np.ndarray) -> np.ndarray:
        low = (1 - g * g) / (2 * g) * (1 / np.sqrt((1 - g) ** 2 + 2 * g * versine(x)) - 1 / (1 + g))
        return np.stack([low, np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) % 1], axis=-1)

    pdf = lambda x: (1 - g * g) / (4 * np.pi * ((1 - g) ** 2 + 2 * g * versine(x)) ** 1.5)  # noqa: E731
    subject = Subject(sample, pdf, UnitSphere(), 2, precision="float32")
    return replace(subject, cdf=cdf) if hint == "cdf" else replace(subject, inverse=cdf)


def peak_with_cdf() -> Subject:
    """Return a peak in single precision, counted under its cdf."""
    return _peak("cdf")


def peak_with_inverse() -> Subject:
    """Return a peak in single precision, counted under its inverse."""
    return _peak("inverse")


def line_with_cdf() -> Subject:
    """Return numbers of the density 2 x in single precision, counted under their cdf."""
    return Subject(
        lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, Interval(0, 1), 1, precision="float32", cdf=lambda x: x * x
    )
