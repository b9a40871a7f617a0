"""Trackers: compiled against masked NumPy, two threads against one, the first result, look-ups against theory, bias of marching.

    python benchmarks/trackers.py

Speeds are ratios of interleaved runs (median and quartiles); only the first result is in seconds, because nobody waits in ratios:
seconds of the processor, which is what a machine with nothing else to do would take.
"""

from __future__ import annotations

import hashlib
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from fogproof.analytic import optical_thickness, transmittance_lookups
from fogproof.estimators import (
    DeltaTransmittance,
    FractalNoise,
    MajorantGrid,
    RatioTransmittance,
    RayMarch,
    delta_tracking,
    feature_size,
    ratio_tracking,
    regular_tracking,
)
from fogproof.scene import Procedural, Ray, VoxelGrid

RAYS = 32_768
VOXELS = 128
REPEATS = 9


def main() -> None:
    """Print everything."""
    rng = np.random.default_rng(1)
    speed(rng)
    threads()
    first_results()
    look_ups(rng)
    marching()


def speed(rng: np.random.Generator) -> None:
    """Print compiled against masked NumPy."""
    trilinear, nearest, rays = cloud("trilinear"), cloud("nearest"), through_the_cube(rng)
    by_hand = Procedural(interpolation(trilinear), 10.0, lower=(0, 0, 0), upper=(1, 1, 1))
    print(f"{RAYS} rays through a cube of {VOXELS}^3 voxels; how many times faster the compiled tracker is")
    for name, tracking in (("delta", delta_tracking), ("ratio", ratio_tracking)):
        cost = np.mean(tracking(trilinear, rays, rng, 10.0).cost)
        compare(
            f"{name} tracking, trilinear, {cost:.1f} look-ups",
            lambda tracking=tracking: tracking(trilinear, rays, rng, 10.0),
            lambda tracking=tracking: tracking(by_hand, rays, rng, 10.0),
        )
    walk = regular_tracking(nearest, rays)
    assert np.allclose(walk.tau, masked_walk(nearest, rays), rtol=1e-10)
    name = f"regular tracking, nearest, {walk.cells.mean():.0f} cells"
    compare(name, lambda: regular_tracking(nearest, rays), lambda: masked_walk(nearest, rays))


def threads() -> None:
    """Print two threads against one, and what hashing, which needs no lock either, gains on this machine now."""
    trilinear, buffer = cloud("trilinear"), bytes(1 << 24)
    print("\nhow many times faster two threads are than one, on 8 batches")
    for name, draw in (
        ("hashing, for comparison", lambda rng, n: hashlib.blake2b(buffer)),
        ("delta tracking", DeltaTransmittance(trilinear, single_ray(), 10.0).draw),
        ("ratio tracking", RatioTransmittance(trilinear, single_ray(), 10.0).draw),
    ):
        compare(name, lambda draw=draw: in_threads(draw, 2), lambda draw=draw: in_threads(draw, 1))


def first_results() -> None:
    """Print how long somebody waits for the first result."""
    print("\nfirst result in a fresh process, imports included [s of one processor]: nothing compiled before; cached")
    for name, code in FIRST.items():
        with tempfile.TemporaryDirectory() as empty:
            cold, cached = first_result(code, empty), [first_result(code, empty) for _ in range(5)]
        print(f"  {name:46s} {cold:5.2f} {statistics.median(cached):5.2f}")


def look_ups(rng: np.random.Generator) -> None:
    """Print what a loose majorant costs, and what blocks save."""
    print("\nlook-ups of a realisation: measured, and what the oracle says; the transmittance is the same")
    noise, ray = FractalNoise(2.0, 3.0, seed=1).medium(), single_ray()
    for majorant in (2.0, 4.0, 8.0):
        for name, make in (("delta", DeltaTransmittance), ("ratio", RatioTransmittance)):
            draws = make(noise, ray, majorant).draw(rng, 200_000)
            theory = float(transmittance_lookups(noise, ray, name, majorant).value)
            print(
                f"  {name}, majorant {majorant:g}: {draws.cost.mean():.3f} {theory:.3f}  T = {draws.value.mean():.4f}"
            )
    sparse = cloud("trilinear", emptiness=6.0)
    for block in (128, 32, 8):
        cost = RatioTransmittance(sparse, ray, MajorantGrid.of(sparse, block)).draw(rng, 20_000).cost.mean()
        print(f"  ratio, a sparse grid, blocks of {block} voxels: {cost:.3f}")


def marching() -> None:
    """Print the bias of ray marching against the oracle."""
    print("\nray marching through noise: error of the optical depth, and the order at which it falls")
    noise, ray = FractalNoise(2.0, 3.0, seed=1).medium(), single_ray()
    truth = float(optical_thickness(noise, ray).value)
    for rule in ("midpoint", "right"):
        before = np.nan
        for steps_a_feature in (0.5, 1, 2, 4, 8, 16):
            march = RayMarch(noise, ray, feature_size(noise, ray) / steps_a_feature, rule)
            off = float(march.depths[-1, 0]) - truth
            order = np.log2(abs(before / off))
            print(
                f"  {rule:8s} {len(march.edges) - 1:5d} steps, {steps_a_feature:4g} a feature: {off:+.2e} {order:6.2f}"
            )
            before = off


def cloud(kind: str, emptiness: float = 0.0) -> VoxelGrid:
    """Return waves in the unit cube, at most 10/m."""
    x = (np.arange(VOXELS) + 0.5) / VOXELS
    wave = np.sin(5 * x)[:, None, None] ** 2 * np.sin(7 * x)[None, :, None] ** 2 * np.sin(6 * x) ** 2
    return VoxelGrid(10 * wave ** (1 + emptiness), (0, 0, 0), (1, 1, 1), kind)  # type: ignore[arg-type]


def through_the_cube(rng: np.random.Generator) -> Ray:
    """Return rays from all sides, most of which meet the unit cube."""
    direction = rng.normal(size=(RAYS, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return Ray(rng.random((RAYS, 3)) - 2 * direction, direction, 6.0)


def single_ray() -> Ray:
    """Return one ray inside the unit cube."""
    return Ray((0.1, 0.2, 0.05), (0.48, 0.6, 0.64), 1.2)


def interpolation(grid: VoxelGrid) -> Callable[[np.ndarray], np.ndarray]:
    """Return trilinear interpolation as a NumPy programmer writes it."""
    values, last = grid.sigma_t, np.array(grid.sigma_t.shape) - 1

    def sigma_t(x: np.ndarray) -> np.ndarray:
        u = np.clip(x * VOXELS - 0.5, 0, last)
        low = u.astype(np.int64)
        high, (a, b, c) = np.minimum(low + 1, last), (u - low).T
        (i, j, k), (p, q, r) = low.T, high.T
        near = (1 - b) * ((1 - a) * values[i, j, k] + a * values[p, j, k])
        near += b * ((1 - a) * values[i, q, k] + a * values[p, q, k])
        far = (1 - b) * ((1 - a) * values[i, j, r] + a * values[p, j, r])
        far += b * ((1 - a) * values[i, q, r] + a * values[p, q, r])
        return (1 - c) * near + c * far

    return sigma_t


def masked_walk(grid: VoxelGrid, rays: Ray) -> np.ndarray:
    """Return the optical depth by regular tracking with masks: all rays take one cell at a time, the finished drop out."""
    result = np.zeros(len(rays.length))
    for first in range(0, len(result), 16_384):
        part = slice(first, first + 16_384)
        o, inverse = rays.origin[part], 1 / rays.direction[part]
        one, two = -o * inverse, (1 - o) * inverse
        t, stop = np.maximum(np.minimum(one, two).max(axis=1), 0), np.maximum(one, two).min(axis=1)
        which = np.flatnonzero(t < stop)
        o, inverse, t, stop = o[which], inverse[which], t[which], stop[which]
        cell = np.clip(((o + t[:, None] / inverse) * VOXELS).astype(np.int64), 0, VOXELS - 1)
        step, ahead = np.where(inverse > 0, 1, -1), np.where(inverse > 0, 1, 0)
        crossing = ((cell + ahead) / VOXELS - o) * inverse
        tau = result[part]
        while len(which):
            axis = np.argmin(crossing, axis=1)
            rows = np.arange(len(which))
            end = crossing[rows, axis]
            tau[which] += grid.sigma_t[cell[:, 0], cell[:, 1], cell[:, 2]] * np.maximum(end - t, 0)
            t = end
            cell[rows, axis] += step[rows, axis]
            moved = cell[rows, axis]
            crossing[rows, axis] = ((moved + ahead[rows, axis]) / VOXELS - o[rows, axis]) * inverse[rows, axis]
            alive = (moved >= 0) & (moved < VOXELS)
            if not alive.all():
                which, o, inverse, t, cell = which[alive], o[alive], inverse[alive], t[alive], cell[alive]
                step, ahead, crossing = step[alive], ahead[alive], crossing[alive]
    return result


def in_threads(draw: Callable[[np.random.Generator, int], object], workers: int) -> None:
    """Draw 8 batches."""
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(lambda i: draw(np.random.default_rng(i), 1 << 16), range(8)))


def compare(name: str, fast: Callable[[], object], slow: Callable[[], object]) -> None:
    """Print how many times longer `slow` takes, in interleaved runs."""
    seconds(fast), seconds(slow)
    ratios = []
    for _ in range(REPEATS):
        a, b = seconds(fast), seconds(slow)
        ratios.append(b / a)
    low, middle, high = statistics.quantiles(ratios, n=4)
    print(f"  {name:46s} {middle:5.2f} (quartiles {low:.2f} and {high:.2f})", flush=True)


def seconds(run: Callable[[], object]) -> float:
    """Return the wall time of one run."""
    started = time.perf_counter()
    run()
    return time.perf_counter() - started


_SETTING = """import numpy as np
from fogproof.estimators import {0}
from fogproof.scene import ExponentialMedium, LinearMedium, Ray, VoxelGrid
ray, rng = Ray((0.1, 0.1, 0.1), (0.48, 0.6, 0.64), 1.0), np.random.default_rng(1)
"""
FIRST = {
    "delta tracking, exponential": _SETTING.format("DeltaTransmittance")
    + "DeltaTransmittance(ExponentialMedium(1.0, (0, 0, 1)), ray).draw(rng, 1000)",
    "ratio tracking, trilinear": _SETTING.format("RatioTransmittance")
    + "RatioTransmittance(VoxelGrid(np.ones((4, 4, 4)), (0, 0, 0), (1, 1, 1)), ray).draw(rng, 1000)",
    "regular tracking, trilinear": _SETTING.format("RegularTransmittance")
    + "RegularTransmittance(VoxelGrid(np.ones((4, 4, 4)), (0, 0, 0), (1, 1, 1)), ray).draw(rng, 1000)",
    "spectral tracking, linear": _SETTING.format("SpectralFog")
    + "SpectralFog(LinearMedium((1.0, 2.0), (0, 0, 1)), ray, 0.0, 1.0).draw(rng, 1000)",
}


def first_result(code: str, cache: str) -> float:
    """Return the processor time of a fresh interpreter that runs `code`, with kernels kept in `cache`."""
    script = f"import time\n{code}\nprint(time.process_time())"
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, env=environment)
    return float(done.stdout)


if __name__ == "__main__":
    main()
