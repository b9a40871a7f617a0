"""Samplers in units of drawing their uniforms, beside a logarithm; directions in units of drawing two and storing three numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.estimators import Cosines, Directions, Equiangular, FreePath
from fogproof.scene import CornetteShanks, DoubleHenyeyGreenstein, Hazy, HenyeyGreenstein, Isotropic, Rayleigh, Schlick

N = 1 << 16
HG = HenyeyGreenstein(0.6)
TILTED = (2 / 7, -3 / 7, 6 / 7)

ONE: dict[str, Callable[[np.ndarray], Any]] = {
    "log1p": np.log1p,
    "HG cosine": Cosines(HG).sample,
    "free path": FreePath(2.5).distances,
    "free path, with density": FreePath(2.5).sample,
    "free path to a surface, with density": FreePath(2.5, 0.5).sample,
    "equiangular, with density": Equiangular(0.5, -1.0, 3.0).sample,
    "isotropic cosine": Cosines(Isotropic()).sample,
    "Rayleigh cosine": Cosines(Rayleigh()).sample,
    "hazy cosine": Cosines(Hazy()).sample,
    "Schlick cosine": Cosines(Schlick(0.7)).sample,
    "Cornette-Shanks cosine": Cosines(CornetteShanks(0.6)).sample,
}
TWO: dict[str, Callable[[np.ndarray], Any]] = {
    "HG directions, with density": Directions(HG).sample,
    "HG directions about a tilted axis": Directions(HG, TILTED).sample,
    "two HG lobes, directions": Directions(DoubleHenyeyGreenstein(0.8, -0.3, 0.6)).sample,
}
GOALS = {
    "HG cosine": Goal("<=", 1.7),
    "free path": Goal("<=", 1.7),
    "equiangular, with density": Goal("<=", 1.7),
    "Rayleigh cosine": Goal("<=", 3.0),
    "hazy cosine": Goal("<=", 3.0),
    "HG directions, with density": Goal("<=", 3.0),
    "HG directions about a tilted axis": Goal("<=", 3.0),
}


def _ways(samplers: dict[str, Callable[[np.ndarray], Any]], dimensions: int) -> dict[str, Way]:
    np.zeros(
        1 << 21
    ).sum()  # freeing one large array makes the C library keep freed memory, in place of faulting it in again
    rng, stored = np.random.default_rng(1), np.empty((N, 3))
    u = rng.random((N, dimensions))

    def draw() -> np.ndarray:
        return rng.random((N, dimensions))

    def draw_and_store() -> None:
        v = draw()
        for i in range(3):
            stored[:, i] = v[:, i % dimensions]

    base = Way(draw if dimensions == 1 else draw_and_store, N)
    return {"uniforms": base} | {name: Way(lambda sample=sample: sample(u), N) for name, sample in samplers.items()}  # type: ignore[misc]


def benchmarks() -> list[Benchmark]:
    """Return them."""
    one = {name: goal for name, goal in GOALS.items() if name in ONE}
    two = {name: goal for name, goal in GOALS.items() if name in TWO}
    return [
        Benchmark("samplers", "Samplers of one uniform", "sample", "uniforms", lambda: _ways(ONE, 1), one),
        Benchmark("directions", "Samplers of directions", "sample", "uniforms", lambda: _ways(TWO, 2), two),
    ]
