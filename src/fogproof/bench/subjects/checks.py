"""Verdicts on a million samples in units of drawing them: by quadrature in one and two dimensions, by labels, of a mean."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.catalogue import all_cases
from fogproof.checks import check_estimator, check_sampler
from fogproof.domains import HalfLine, UnitSphere
from fogproof.estimators import Directions
from fogproof.scene import HenyeyGreenstein

SAMPLES, BLOCK = 1_000_000, 1 << 16


def _drawing(sample: Callable[[np.ndarray], Any], dimensions: int) -> None:
    rng = np.random.default_rng(1)
    for start in range(0, SAMPLES, BLOCK):
        sample(rng.random((min(BLOCK, SAMPLES - start), dimensions)))


def _line() -> dict[str, Way]:
    def sample(u: np.ndarray) -> np.ndarray:
        return np.asarray(-np.log1p(-u[:, 0]))

    def verdict() -> Any:
        return check_sampler(sample, lambda x: np.exp(-x), HalfLine(0), dimensions=1, samples=SAMPLES, seed=1)

    return {"drawing": Way(lambda: _drawing(sample, 1)), "verdict": Way(verdict)}


def _sphere() -> dict[str, Way]:
    hg = Directions(HenyeyGreenstein(0.8))

    def verdict() -> Any:
        return check_sampler(hg.sample, hg.pdf, UnitSphere(), dimensions=2, samples=SAMPLES, seed=1)

    return {"drawing": Way(lambda: _drawing(hg.sample, 2)), "verdict": Way(verdict)}


def _labels() -> dict[str, Way]:
    sun: Any = next(case for case in all_cases() if case.name == "outsiders/lights/cone/0.2665/0").make()

    def verdict() -> Any:
        return check_sampler(sun.sample, sun.pdf, sun.domain, dimensions=2, samples=SAMPLES, seed=1)

    return {"drawing": Way(lambda: _drawing(sun.sample, 2)), "verdict": Way(verdict)}


def _mean() -> dict[str, Way]:
    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        return rng.exponential(size=n)

    rng = np.random.default_rng(1)
    verdict = Way(lambda: check_estimator(draw, 1.0, samples=SAMPLES, seed=1))
    return {"drawing": Way(lambda: draw(rng, SAMPLES)), "verdict": verdict}


def benchmarks() -> list[Benchmark]:
    """Return them."""
    rows = (
        ("check-line", "A verdict in one dimension", _line, 30.0),
        ("check-sphere", "A verdict on the sphere", _sphere, 30.0),
        ("check-labels", "A verdict by labels", _labels, 60.0),
        ("check-mean", "A verdict on a mean", _mean, 30.0),
    )
    return [
        Benchmark(name, f"{title}, a million samples", "check", "drawing", ways, {"verdict": Goal("<=", most)})
        for name, title, ways, most in rows
    ]
