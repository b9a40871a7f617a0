"""Airlight integral, transmittance and fog on 10^5 hard cases against many-digit arithmetic: every stated error must hold.

    python tools/oracle_hard.py [CASES] [SEED]

sigma_t 1e-9 … 300 (and 0), h 1e-12 … 30, lights before, beside and behind the camera, optical thickness up to 645, one ray in
five endless, |g| <= .9999; fog and transmittance from tau = 1e-300 to 1e3. The truth (tests/truth/airlight_truth.py and
tests/truth/media_truth.py) uses other formulas. The error may be 1e-14 of the value, of transmittance and fog 1e-14 tau where
tau > 1. Exits with 1 if a promise is broken.
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

from fogproof.analytic import (
    airlight_integral,
    ambient_fog,
    transmittance,
)
from fogproof.contracts import Reference
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, PhaseFunction, Ray, Rayleigh, Schlick

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "truth"))
from airlight_truth import airlight
from media_truth import fog

BATCH = 50
LIMIT = 1e-14
LIGHT = ("isotropic", "hg", "schlick", "rayleigh")
KINDS = (*LIGHT, "fog", "transmittance")
TINY = mp.mpf(2) ** -970  # below, errors are absolute

Found = tuple[float, float, float, str]
"""Relative error, error / stated, stated relative error over what it may be, the case."""


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


def judge(job: tuple[str, int, int]) -> tuple[str, list[Found]]:
    """Return what became of each case of a batch."""
    kind, seed, number = job
    rng = np.random.default_rng([seed, number])
    return kind, airlights(kind, rng) if kind in LIGHT else fogs(kind, rng)


def airlights(kind: str, rng: np.random.Generator) -> list[Found]:
    """Judge single scattering along rays by a point light."""
    phase = phase_function(kind, rng)
    given = cases(BATCH, rng)
    reference = airlight_integral(*given, phase)
    found = []
    for one, value, error in zip(zip(*given, strict=True), reference.value, reference.error, strict=True):
        case = [float(x) for x in one]
        found.append(judged(float(value), float(error), airlight(*case, phase), LIMIT, f"{case} {phase}"))
    return found


def fogs(kind: str, rng: np.random.Generator) -> list[Found]:
    """Judge fog with ambient light and emission, or transmittance (of a background of 1, nothing else)."""
    found = []
    for _ in range(BATCH):
        tau, s, share = 10 ** rng.uniform(rng.choice([-300, -6]), 3), 10 ** rng.uniform(-8, 8), rng.random()
        sigma_a, sigma_s = share * tau / s, (1 - share) * tau / s
        emission, ambient, background = 10 ** rng.uniform(-6, 6, 3) * (rng.random(3) < 0.8)
        ray = Ray((0, 0, 0), (0, 0, 1), s)
        reference: Reference
        if kind == "fog":
            reference = ambient_fog(Medium(sigma_a, sigma_s, emission=emission), ray, ambient, background)
        else:
            emission, ambient, background = 0.0, 0.0, 1.0
            reference = transmittance(Medium(sigma_a, sigma_s), ray)
        case = tuple(float(x) for x in (sigma_a, sigma_s, emission, s, ambient, background))
        limit = LIMIT * max(1.0, tau)
        found.append(judged(float(reference.value), float(reference.error), fog(*case), limit, f"{kind} {case}"))
    return found


def judged(value: float, error: float, truth: mp.mpf, limit: float, case: str) -> Found:
    """Compare a value with the truth and its stated error with what it may be."""
    off = abs(mp.mpf(value) - truth)
    size = max(truth, TINY)
    share = float(off / mp.mpf(error)) if error else float(off and mp.inf)
    return float(off / size), share, float(error / size) / limit if truth > TINY else 0.0, case


def main() -> None:
    """Judge all batches in all processors and print the worst of each kind."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int.from_bytes(os.urandom(4))
    jobs = [(KINDS[i % len(KINDS)], seed, i) for i in range(math.ceil(count / BATCH))]
    print(f"{len(jobs) * BATCH} cases, seed {seed}")
    results = defaultdict(list)
    start = time.perf_counter()
    with ProcessPoolExecutor() as pool:
        for kind, found in pool.map(judge, jobs):
            results[kind] += found
    broken = 0
    for kind, found in results.items():
        relative, share, stated = (np.array(column) for column in list(zip(*found, strict=True))[:3])
        bad = (share > 1) | (stated > 1)
        broken += int(bad.sum())
        print(
            f"{kind:13} {len(found):6} cases: relative error median {np.median(relative):.1e}, 99.9 % "
            f"{np.quantile(relative, 0.999):.1e}, worst {relative.max():.1e} = {share.max():.2f} of the stated error; stated <= "
            f"{stated.max():.2f} of the limit; broken promises {bad.sum()}"
        )
        for i in np.flatnonzero(bad)[:5]:
            print(f"    {found[i]}")
    print(f"{time.perf_counter() - start:.0f} s")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
