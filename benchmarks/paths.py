"""Path tracing: against Mitsuba 3's `volpath`, two threads against one, and how soon a bias of a thousandth is found.

    python benchmarks/paths.py

Ratios are of interleaved runs (median and quartiles). The measure of an estimator is the variance of one path times the processor's
time for it, all threads counted: twice that takes twice as long to the same error.
"""

from __future__ import annotations

import hashlib
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from fogproof import check_estimator
from fogproof.adapters.mitsuba import installed
from fogproof.analytic import slab_reflectance
from fogproof.estimators import PathTracer
from fogproof.scene import Medium, Ray
from fogproof.scene.lights import Environment, PointLight
from fogproof.scene.shapes import Ball, Slab
from fogproof.scene.surfaces import Plane, Surface

REPEATS = 7
PATHS = 1 << 20
SIDE, EACH = 256, 8  # pixels of Mitsuba's film, all of the same ray, and paths in each

UP = (0.0, 0.0, 1.0)
ASIDE, ABOVE = Ray((0.3, 0.0, 3.0), (0.0, 0.0, -1.0)), Ray((0.0, 0.0, 3.0), (np.sqrt(0.75), 0.0, -0.5))
BALL = PathTracer(Medium(0.5, 4.5), Ball((0.0, 0.0, 0.0), 1.0), ASIDE, PointLight((0.0, 2.0, 0.5), 3.0), roulette=None)
SLAB = PathTracer(
    Medium(0.1, 0.9), Slab((0.0, 0.0, 0.0), UP, 1.0), ABOVE, Environment(1.0), Surface(Plane((0.0, 0.0, -2.0), UP))
)


def main() -> None:
    """Print everything, or the comparison with one variant of Mitsuba."""
    if len(sys.argv) > 1:
        against_mitsuba(sys.argv[1])
        return
    print(
        "a ball of optical diameter 10 and albedo 0.9 lit by a point light, seen along one ray; against Mitsuba's volpath"
    )
    print("  [how many times the variance of a path times processor time]")
    for variant in ("scalar_rgb", "llvm_ad_rgb"):
        if not installed():
            print("  Mitsuba is not installed: python -m pip install mitsuba")
            break
        run = subprocess.run([sys.executable, __file__, variant], capture_output=True, text=True)  # LLVM may abort
        print(
            run.stdout.rstrip()
            if run.returncode == 0
            else f"  {variant}: does not run here, exit code {run.returncode}"
        )
    threads()
    small_bias()


def against_mitsuba(variant: str) -> None:
    """Print means, their difference, and the ratio of variance times time."""
    render = mitsuba_ball(variant)
    ours: list[tuple[float, float, float]] = []
    theirs: list[tuple[float, float, float]] = []
    for i in range(-1, REPEATS):
        both = measured(lambda i=i: traced(i)), measured(lambda i=i: render(i + 1))
        if i >= 0:  # the first run compiles
            ours.append(both[0])
            theirs.append(both[1])
    (mean, error), (other, other_error) = averaged(ours), averaged(theirs)
    z = (mean - other) / np.hypot(error, other_error)
    ratios = [b[1] * b[2] / (a[1] * a[2]) for a, b in zip(ours, theirs, strict=True)]
    print(
        f"  {variant}: {quartiles(ratios)}; means {mean:.6f} +- {error:.1g}, {other:.6f} +- {other_error:.1g}, z = {z:+.1f}"
    )


def traced(seed: int) -> tuple[np.ndarray, int]:
    """Return values of our paths, and how many paths there are in each."""
    return np.asarray(BALL.draw(np.random.default_rng(seed + 1), PATHS).value), 1


def mitsuba_ball(variant: str) -> Callable[[int], tuple[np.ndarray, int]]:
    """Return a function that renders the ball: pixels, and how many paths there are in each."""
    import mitsuba as mi

    mi.set_variant(variant)
    look = mi.ScalarTransform4f().look_at(origin=[0.3, 0, 3], target=[0.3, 0, 2], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}, "sample_border": False}
    film |= {"pixel_format": "luminance", "component_format": "float32"}
    sensor = {"type": "orthographic", "to_world": look @ mi.ScalarTransform4f().scale([1e-5, 1e-5, 1]), "film": film}
    sensor |= {"near_clip": 1e-4, "far_clip": 1e4, "sampler": {"type": "independent", "sample_count": EACH}}
    fog = {"type": "homogeneous", "sigma_t": 1.0, "scale": 5.0, "albedo": 0.9, "phase": {"type": "isotropic"}}
    lamp = {"type": "point", "position": [0, 2, 0.5], "intensity": {"type": "rgb", "value": [3.0] * 3}}
    scene: Any = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 5},
            "ball": {"type": "sphere", "bsdf": {"type": "null"}, "interior": fog},
            "lamp": lamp,
            "sensor": sensor,
        }
    )
    return lambda seed: (np.array(mi.render(scene, spp=EACH, seed=seed), dtype=float).ravel(), EACH)


def measured(draw: Callable[[], tuple[np.ndarray, int]]) -> tuple[float, float, float]:
    """Return the mean, the variance of one path, and the processor's time for one path [s]."""
    start = time.process_time()
    values, each = draw()
    spent = time.process_time() - start
    return float(values.mean()), float(values.var() * each), spent / (len(values) * each)


def averaged(runs: list[tuple[float, float, float]]) -> tuple[float, float]:
    """Return the mean of several runs and its standard error, from their scatter."""
    means = [mean for mean, _, _ in runs]
    return statistics.mean(means), statistics.stdev(means) / len(means) ** 0.5


def quartiles(ratios: list[float]) -> str:
    """Return median and quartiles."""
    low, middle, high = statistics.quantiles(ratios, n=4)
    return f"{middle:.2f} ({low:.2f} .. {high:.2f})"


def threads() -> None:
    """Print two threads against one, and what hashing, which needs no lock either, gains on this machine now.

    Where others compute as well, the fastest runs tell more than the usual ones.
    """
    buffer = bytes(1 << 23)
    print(f"\nhow many times faster two threads are than one, on 8 batches; {os.cpu_count()} cores")
    for name, draw in (
        ("hashing, for comparison", lambda rng, n: hashlib.blake2b(buffer)),
        ("path tracing", BALL.draw),
    ):
        runs = [[elapsed(lambda draw=draw, w=w: in_threads(draw, w)) for w in (1, 2)] for _ in range(4 * REPEATS)]
        one, two = (min(run[w] for run in runs) for w in (0, 1))
        print(f"  {name:24s} {quartiles([a / b for a, b in runs])}; the fastest runs {one / two:.2f}")
    many, one = (statistics.median(spent(n) for _ in range(50)) for n in (1 << 14, 1))
    print(f"  of a batch of {1 << 14} paths, all but {one / many:.2%} of the time runs without the interpreter's lock")


def in_threads(draw: Callable[[np.random.Generator, int], object], workers: int) -> None:
    """Draw 8 batches."""
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(lambda i: draw(np.random.default_rng(i), 1 << 14), range(8)))


def spent(paths: int) -> float:
    """Return the processor's time for a batch [s]; a batch of one path is next to nothing but what needs the interpreter."""
    start = time.process_time()
    BALL.draw(np.random.default_rng(1), paths)
    return time.process_time() - start


def elapsed(work: Callable[[], object]) -> float:
    """Return how long a piece of work takes [s]."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def small_bias() -> None:
    """Print how long it takes until reflectance that is wrong by 1e-3 is rejected."""
    print("\nreflectance of a slab, sought with 48 million paths by one thread [s of the processor]")
    reference = slab_reflectance(0.9, 1.0, 0.5)
    for name, factor in (("as it is", 1.0), ("1e-3 too large", 1.001), ("1e-3 too small", 0.999)):
        start = time.process_time()

        def draw(rng: np.random.Generator, n: int, factor: float = factor) -> np.ndarray:
            return factor * np.asarray(SLAB.draw(rng, n).value)

        verdict = check_estimator(draw, reference, samples=48_000_000)
        finding = next(f for f in verdict.findings if f.check == "mean")
        spent = time.process_time() - start
        print(f"  {name:16s} {verdict.outcome:14s} {spent:5.1f} s; {finding.message}")


if __name__ == "__main__":
    main()
