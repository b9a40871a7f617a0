"""Chi-square on a fixed grid over the sphere, as Nori and pbrt test their samplers (W. Jakob's hypothesis.h).

A million samples are counted in cells of cos(theta) x phi (Nori, 10 x 20) or theta x phi (pbrt-v4, 80 x 160). Expected counts are
integrals of the pdf by adaptive Simpson quadrature, which halves a cell at most six times. Cells are taken in the order of their
expected counts: a cell without any expected count rejects if more than n / 100 000 samples are in it; those with fewer than five
are pooled until they have five together. The level is .01, shared by five runs. Written anew from its description: the quadrature
halves a whole cell at a time, in both directions, where the original halves one direction inside the other.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fogproof.domains import UnitHemisphere, UnitSphere
from fogproof.zoo.others.test import OtherTest, drawn, several_runs

SAMPLES, DEEPEST, TOLERANCE, FEWEST = 1_000_000, 6, 1e-6, 5.0
_SIMPSON = np.array([1.0, 4.0, 1.0]) / 6


def on_the_sphere(sampler: Any) -> bool:
    """Return whether points are directions without atoms."""
    directions = isinstance(sampler.domain, UnitSphere | UnitHemisphere)
    return directions and not getattr(sampler, "atoms", {})


def chi_square(sampler: Any, rng: np.random.Generator, rows: int, columns: int, polar: bool) -> float:
    """Return the p-value; `polar` cuts in theta, otherwise in cos(theta)."""
    x = drawn(sampler, rng, SAMPLES)
    if not np.all(np.isfinite(x)):
        return 0.0
    mu = np.clip(x[:, 2], -1, 1)
    first = np.arccos(mu) / np.pi if polar else (mu + 1) / 2
    second = np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) % 1
    cell = np.minimum((first * rows).astype(int), rows - 1) * columns + np.minimum(
        (second * columns).astype(int), columns - 1
    )
    observed = np.bincount(cell, minlength=rows * columns)
    return pooled(observed, SAMPLES * expected(partial(_density, sampler, polar), rows, columns))


def _density(sampler: Any, polar: bool, s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the density over the unit square of (first, second) coordinates."""
    mu, phi = np.cos(np.pi * s) if polar else 2 * s - 1, 2 * np.pi * t
    sine = np.sqrt(np.maximum(1 - mu * mu, 0))
    x = np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)
    value = np.asarray(sampler.pdf(x), dtype=float)
    if isinstance(sampler.domain, UnitHemisphere):
        value = np.where(mu >= 0, value, 0.0)
    return value * (2 * np.pi * np.pi * sine if polar else 4 * np.pi)


def expected(density: Callable[[np.ndarray, np.ndarray], np.ndarray], rows: int, columns: int) -> np.ndarray:
    """Return the integrals of a density on the unit square over equal cells, (rows * columns,)."""
    low = np.stack(
        [g.ravel() for g in np.meshgrid(np.arange(rows) / rows, np.arange(columns) / columns, indexing="ij")]
    )
    size, total, cell = np.array([1 / rows, 1 / columns]), np.zeros(rows * columns), np.arange(rows * columns)
    coarse = _rule(density, low, size)
    for depth in range(DEEPEST):
        size = size / 2
        quarters = [low + size[:, None] * np.array(corner)[:, None] for corner in ((0, 0), (0, 1), (1, 0), (1, 1))]
        fine = np.stack([_rule(density, quarter, size) for quarter in quarters])
        done = np.abs(fine.sum(axis=0) - coarse) <= 15 * TOLERANCE / (rows * columns)
        if depth == DEEPEST - 1:
            done[:] = True
        np.add.at(total, cell[done], fine.sum(axis=0)[done])
        low = np.concatenate([quarter[:, ~done] for quarter in quarters], axis=1)
        coarse, cell = fine[:, ~done].ravel(), np.tile(cell[~done], 4)
        if not len(cell):
            break
    return total


def _rule(density: Callable[[np.ndarray, np.ndarray], np.ndarray], low: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Return Simpson's rule in both directions over cells with a lower corner, (m,)."""
    total = np.zeros(low.shape[1])
    for i, a in enumerate(_SIMPSON):
        for j, b in enumerate(_SIMPSON):
            total += a * b * density(low[0] + size[0] * i / 2, low[1] + size[1] * j / 2)
    return total * size[0] * size[1]


def pooled(observed: np.ndarray, expectation: np.ndarray) -> float:
    """Return the p-value of Pearson's statistic after small cells have been put together."""
    from scipy.stats import chi2

    n = observed.sum()
    statistic, cells, waiting, awaited = 0.0, 0, 0.0, 0.0
    for index in np.argsort(expectation, kind="stable"):
        o, e = float(observed[index]), float(expectation[index])
        if e == 0:
            if o > n * 1e-5:
                return 0.0
        elif e < FEWEST or (0 < awaited < FEWEST):
            waiting, awaited = waiting + o, awaited + e
            if awaited > FEWEST:
                statistic, cells, waiting, awaited = statistic + (waiting - awaited) ** 2 / awaited, cells + 1, 0.0, 0.0
        else:
            statistic, cells = statistic + (o - e) ** 2 / e, cells + 1
    return float(chi2.sf(statistic, cells - 1)) if cells > 1 else float("nan")


_LEVEL = several_runs(0.01, 5)
TESTS = (
    OtherTest(
        "nori", "Nori: chi-square, 10 x 20 cells", "Nori, chi2test.cpp", _LEVEL, SAMPLES, on_the_sphere,
        partial(chi_square, rows=10, columns=20, polar=False),
    ),
    OtherTest(
        "pbrt-v4", "pbrt-v4: chi-square, 80 x 160 cells", "pbrt-v4, bsdfs_test.cpp", _LEVEL, SAMPLES, on_the_sphere,
        partial(chi_square, rows=80, columns=160, polar=True),
    ),
)  # fmt: skip
