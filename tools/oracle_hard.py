"""The airlight integral on 10^5 hard cases against ball arithmetic: every stated error must hold, and stay below 1e-14.

    python tools/oracle_hard.py [CASES] [SEED]

sigma_t 1e-9 … 300 (and 0), h 1e-12 … 30, lights before, beside and behind the camera, optical thickness up to 645, one ray in
five endless, |g| <= .9999. The truth (tests/airlight_truth.py) uses other formulas. Exits with 1 if a promise is broken.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import mpmath as mp
import numpy as np

from fogproof.analytic import airlight_integral
from fogproof.scene import HenyeyGreenstein, Isotropic, PhaseFunction, Rayleigh, Schlick

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from airlight_truth import airlight

BATCH = 50
LIMIT = 1e-14


def phase_function(kind: str, rng: np.random.Generator) -> PhaseFunction:
    """Return a phase function of the kind; g and k crowd towards 0 and +-1."""
    g = float(rng.choice([-1, 1]) * rng.choice([10 ** rng.uniform(-9, 0), 1 - 10 ** rng.uniform(-4, 0)]))
    g = math.copysign(min(abs(g), 0.9999), g)
    return {"isotropic": Isotropic(), "hg": HenyeyGreenstein(g), "schlick": Schlick(g), "rayleigh": Rayleigh()}[kind]


def cases(n: int, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Return sigma_t, h, a, b."""
    h = 10 ** rng.uniform(-12, 1.5, n)
    a = np.where(rng.random(n) < 0.5, h * 10 ** rng.uniform(-1, 2, n), 10 ** rng.uniform(-6, 2, n))
    a *= rng.choice([-1, -1, 1], n)
    b = np.where(rng.random(n) < 0.5, a + 10 ** rng.uniform(-6, 2, n), a + h * 10 ** rng.uniform(-3, 3, n))
    b = np.where(rng.random(n) < 0.2, np.inf, np.maximum(a, b))
    sigma = np.where(rng.random(n) < 0.02, 0.0, 10 ** rng.uniform(-9, 2.5, n))
    return np.minimum(sigma, 645 / np.hypot(a, h)), h, a, b


def judge(job: tuple[str, int, int]) -> tuple[str, list[tuple[float, float, float, str]]]:
    """Return (relative error, error / stated, stated relative error, the case) of each case of a batch."""
    kind, seed, number = job
    rng = np.random.default_rng([seed, number])
    phase = phase_function(kind, rng)
    found = []
    given = cases(BATCH, rng)
    reference = airlight_integral(*given, phase)
    for one, value, error in zip(zip(*given, strict=True), reference.value, reference.error, strict=True):
        case = [float(x) for x in one]
        truth = airlight(*case, phase)
        off = abs(mp.mpf(float(value)) - truth)
        size = max(truth, mp.mpf(2) ** -970)  # below, the error is absolute
        found.append((float(off / size), float(off / mp.mpf(float(error))), float(error / size), f"{case} {phase}"))
    return kind, found


def main() -> None:
    """Judge all batches in all processors and print the worst of each kind."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int.from_bytes(os.urandom(4))
    kinds = ["isotropic", "hg", "schlick", "rayleigh"]
    jobs = [(kinds[i % 4], seed, i) for i in range(math.ceil(count / BATCH))]
    print(f"{len(jobs) * BATCH} cases, seed {seed}")
    results = defaultdict(list)
    start = time.perf_counter()
    with ProcessPoolExecutor() as pool:
        for kind, found in pool.map(judge, jobs):
            results[kind] += found
    broken = 0
    for kind, found in results.items():
        relative, share, stated = (np.array(column) for column in list(zip(*found, strict=True))[:3])
        bad = (share > 1) | (stated > LIMIT)
        broken += int(bad.sum())
        print(
            f"{kind:10} {len(found):6} cases: relative error median {np.median(relative):.1e}, 99.9 % "
            f"{np.quantile(relative, 0.999):.1e}, worst {relative.max():.1e} = {share.max():.2f} of the stated error; stated <= "
            f"{stated.max():.1e}; broken promises {bad.sum()}"
        )
        for i in np.flatnonzero(bad)[:5]:
            print(f"    {found[i]}")
    print(f"{time.perf_counter() - start:.0f} s")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
