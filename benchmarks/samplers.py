"""What samplers cost, as ratios to drawing their uniforms: everything is measured in turn, in one run on one core.

    python benchmarks/samplers.py [ROUNDS]

Each round draws fresh uniforms with NumPy's PCG64 and then maps them by each sampler; a ratio is the median over the rounds of
sampling / drawing, `total` that of both together. Direction vectors are compared with drawing two uniforms and storing three
numbers.
Absolute times depend on the machine and on what else runs; the ratios hardly do.
"""

from __future__ import annotations

import json
import platform
import sys
import time
from collections.abc import Callable

import numpy as np

from fogproof.estimators import Cosines, Directions, Equiangular, FreePath
from fogproof.scene import CornetteShanks, DoubleHenyeyGreenstein, Hazy, HenyeyGreenstein, Isotropic, Rayleigh, Schlick

N = 1 << 16
HG = HenyeyGreenstein(0.6)
TILTED = (2 / 7, -3 / 7, 6 / 7)

SAMPLERS: dict[str, tuple[Callable[[np.ndarray], object], int, float | None]] = {
    "HG cosine": (Cosines(HG).sample, 1, 1.7),
    "free path": (FreePath(2.5).distances, 1, 1.7),
    "free path, with density": (FreePath(2.5).sample, 1, None),
    "free path to a surface, with density": (FreePath(2.5, 0.5).sample, 1, None),
    "equiangular, with density": (Equiangular(0.5, -1.0, 3.0).sample, 1, 1.7),
    "isotropic cosine": (Cosines(Isotropic()).sample, 1, None),
    "Rayleigh cosine": (Cosines(Rayleigh()).sample, 1, 3.0),
    "hazy cosine": (Cosines(Hazy()).sample, 1, 3.0),
    "Schlick cosine": (Cosines(Schlick(0.7)).sample, 1, None),
    "Cornette-Shanks cosine": (Cosines(CornetteShanks(0.6)).sample, 1, None),
    "HG directions, with density": (Directions(HG).sample, 2, 3.0),
    "HG directions about a tilted axis": (Directions(HG, TILTED).sample, 2, 3.0),
    "two HG lobes, directions": (Directions(DoubleHenyeyGreenstein(0.8, -0.3, 0.6)).sample, 2, None),
}
"""Name -> sampler, uniforms it takes, and the ratio that is aimed at."""


def measure(rounds: int) -> dict[str, tuple[float, ...]]:
    """Return sampling / drawing, (drawing and sampling) / drawing, and nanoseconds per sample of each sampler."""
    # Freeing one large array makes the C library keep freed memory: without that, arrays of half a megabyte go back to the
    # operating system at once, and faulting their pages in again costs more than most samplers.
    np.zeros(1 << 21).sum()
    rng = np.random.default_rng(1)
    stored = np.empty((N, 3))

    def draw(dimensions: int) -> np.ndarray:
        return rng.random((N, dimensions))

    def draw_and_store() -> None:
        u = draw(2)
        for i in range(3):
            stored[:, i] = u[:, i % 2]

    def seconds(function: Callable[[], object]) -> float:
        started = time.perf_counter()
        function()
        return time.perf_counter() - started

    times: dict[str, list[tuple[float, float, float]]] = {name: [] for name in SAMPLERS}
    for turn in range(rounds + 3):
        for name, (sample, dimensions, _) in SAMPLERS.items():
            bare = seconds(draw_and_store) if dimensions == 2 else seconds(lambda: draw(1))
            u = draw(dimensions)
            alone = seconds(lambda sample=sample, u=u: sample(u))
            full = seconds(lambda sample=sample, dimensions=dimensions: sample(draw(dimensions)))
            if turn >= 3:
                times[name].append((alone / bare, full / bare, alone / N * 1e9))
    return {name: tuple(map(float, np.median(measured, axis=0))) for name, measured in times.items()}


def main() -> None:
    """Print a table for people on stderr and JSON on stdout."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    found = measure(rounds)
    print(f"{'':40} {'alone':>6} {'total':>6}", file=sys.stderr)
    for name, (ratio, total, nanoseconds) in found.items():
        goal = SAMPLERS[name][2]
        verdict = "" if goal is None else f"  <= {goal:g}: {'yes' if ratio <= goal else 'NO'}"
        print(f"{name:40} {ratio:6.2f} {total:6.2f} {nanoseconds:8.2f} ns{verdict}", file=sys.stderr)
    environment = {"python": platform.python_version(), "numpy": np.__version__, "platform": platform.platform()}
    alone = {name: round(row[0], 3) for name, row in found.items()}
    totals = {name: round(row[1], 3) for name, row in found.items()}
    print(json.dumps({"benchmark": "samplers", "rounds": rounds, **environment, "ratios": alone, "totals": totals}))


if __name__ == "__main__":
    main()
