"""What a feature costs those who do not use it: each scene beside a program that never had the feature, or beside one that uses it.

    python benchmarks/unused_features.py [ROUNDS]

The lean programs stand below: they know one scene and nothing else. Both sides of a pair run in turn in one process, and
processor time is counted; a ratio is the median over the rounds, with its quartiles. Within 3 % of 1 a feature costs nothing;
anything else is said.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable

import numba
import numpy as np

from fogproof.estimators import AnalogFog, FreePath, HomogeneousSpectralFreePath, PathTracer
from fogproof.estimators.paths.spectral import SpectralPathTracer
from fogproof.scene import Ball, Medium, PointLight, Ray, Scene, VoxelGrid
from fogproof.scene_estimator import estimator_for

N = 1 << 15
PATHS = 1 << 13
ALONG = Ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 2.0)
LAMP = PointLight((0.4, 0.9, 1.1), 3.0)
BALL, ASIDE, ABOVE = (
    Ball((0.0, 0.0, 0.0), 1.0),
    Ray((0.3, 0.0, 3.0), (0.0, 0.0, -1.0)),
    PointLight((0.0, 2.0, 0.5), 3.0),
)
SIGMA_A, SIGMA_S = 0.5, 4.5

Program = Callable[[np.random.Generator], object]

# --- programs that never had the feature -----------------------------------------------------------------------------------------


def lean_fog(rng: np.random.Generator) -> np.ndarray:
    """Ambient fog by free paths: no emission, no channels, no cost."""
    t = np.log1p(-rng.random(N))
    t *= -1 / 0.8
    return np.where(t >= 2.0, 1.0, 0.3 / 0.8 * 0.5)


def lean_lamp(rng: np.random.Generator) -> np.ndarray:
    """One event placed around a lamp: isotropic, homogeneous, no shape, no occluder, nothing but the lamp's light."""
    sigma_t, sigma_s = 0.8, 0.3
    h, a = np.hypot(0.4, 0.9), -1.1
    angle = np.arctan2(h * 2.0, h * h + a * (a + 2.0))
    tangent = np.tan(angle * rng.random(N))
    t = (a + h * tangent) / (1 - a / h * tangent)
    square = h * h + t * t
    path = (t - a) + np.sqrt(square)
    return sigma_s * 3.0 / (4 * np.pi) * np.exp(-sigma_t * path) * (angle / h)


@numba.njit(error_model="numpy")
def _lean_paths(rng, out, sigma_t, albedo, lx, ly, lz, intensity):
    """Paths in a homogeneous isotropic ball lit by a lamp outside: nothing else is known here."""
    for i in range(len(out)):
        x, y, z = 0.3, 0.0, 3.0
        dx, dy, dz = 0.0, 0.0, -1.0
        value, throughput, order = 0.0, 1.0, 0
        b = x * dx + y * dy + z * dz
        px, py, pz = x - b * dx, y - b * dy, z - b * dz
        half = np.sqrt(1.0 - (px * px + py * py + pz * pz))
        enter, leave = -b - half, -b + half
        x, y, z = x + enter * dx, y + enter * dy, z + enter * dz
        leave -= enter
        while True:
            t = rng.standard_exponential() / sigma_t
            if t >= leave:
                break
            x, y, z = x + t * dx, y + t * dy, z + t * dz
            throughput *= albedo
            order += 1
            wx, wy, wz = lx - x, ly - y, lz - z
            square = wx * wx + wy * wy + wz * wz
            far = np.sqrt(square)
            wx, wy, wz = wx / far, wy / far, wz / far
            b = x * wx + y * wy + z * wz
            px, py, pz = x - b * wx, y - b * wy, z - b * wz
            way = -b + np.sqrt(max(0.0, 1.0 - (px * px + py * py + pz * pz)))
            value += throughput * intensity / (4.0 * np.pi * square) * np.exp(-sigma_t * min(way, far))
            if order >= 5:
                if rng.random() >= throughput:
                    break
                throughput = 1.0
            while True:
                u, v = 2.0 * rng.random() - 1.0, 2.0 * rng.random() - 1.0
                s = u * u + v * v
                if s < 1.0:
                    break
            root = 2.0 * np.sqrt(1.0 - s)
            dx, dy, dz = u * root, v * root, 1.0 - 2.0 * s
            b = x * dx + y * dy + z * dz
            px, py, pz = x - b * dx, y - b * dy, z - b * dz
            leave = -b + np.sqrt(max(0.0, 1.0 - (px * px + py * py + pz * pz)))
        out[i] = value


def lean_paths(rng: np.random.Generator) -> np.ndarray:
    """Radiance of the ball by the loop above."""
    out = np.empty(PATHS)
    _lean_paths(rng, out, SIGMA_A + SIGMA_S, SIGMA_S / (SIGMA_A + SIGMA_S), 0.0, 2.0, 0.5, 3.0)
    return out


# --- ours ------------------------------------------------------------------------------------------------------------------------


def drawing(estimator: object, n: int) -> Program:
    """Return what draws n realisations."""
    return lambda rng: estimator.draw(rng, n).value  # type: ignore[attr-defined]


def traced(medium: object, **options: object) -> Program:
    """Return what follows paths through the ball."""
    return drawing(PathTracer(medium, BALL, ASIDE, ABOVE, **options), PATHS)  # type: ignore[arg-type]


def lit(**sources: float) -> Program:
    """Return single scattering along a ray beside a lamp."""
    return drawing(estimator_for(Scene(Medium(0.5, 0.3, **sources), ALONG, "single", LAMP)), N)


HOMOGENEOUS = Medium(SIGMA_A, SIGMA_S)
CONSTANT = VoxelGrid(np.full((4, 4, 4), SIGMA_A + SIGMA_S), (-1, -1, -1), (1, 1, 1), "nearest", albedo=0.9)
THREE = Medium((SIGMA_A,) * 3, (SIGMA_S,) * 3)

PAIRS: dict[str, tuple[Program, Program]] = {
    "fog without emission / a program without emission": (
        drawing(AnalogFog(Medium(0.5, 0.3), ALONG, 0.5, 1.0), N),
        lean_fog,
    ),
    "fog with emission 0 / fog without emission": (
        drawing(AnalogFog(Medium(0.5, 0.3, emission=0.0), ALONG, 0.5, 1.0), N),
        drawing(AnalogFog(Medium(0.5, 0.3), ALONG, 0.5, 1.0), N),
    ),
    "a lamp, single scattering / a program for lamps alone": (lit(), lean_lamp),
    "a lamp, emission 0 / without emission": (lit(emission=0.0), lit()),
    "paths in a ball / a program for this ball alone": (traced(HOMOGENEOUS), lean_paths),
    "paths, emission 0 / without emission": (traced(Medium(SIGMA_A, SIGMA_S, emission=0.0)), traced(HOMOGENEOUS)),
    "paths, columns for 8 orders / the sum alone": (traced(HOMOGENEOUS, columns=8), traced(HOMOGENEOUS)),
    "paths, constant grid / homogeneous": (traced(CONSTANT), traced(HOMOGENEOUS)),
    "paths, three equal channels / grey": (
        drawing(SpectralPathTracer(THREE, BALL, ASIDE, ABOVE), PATHS),
        traced(HOMOGENEOUS),
    ),
    "free path of three equal channels / of one": (
        lambda rng: HomogeneousSpectralFreePath((0.8, 0.8, 0.8)).sample(rng.random((N, 2))).x,
        lambda rng: FreePath(0.8).sample(rng.random((N, 1))).x,
    ),
    "single scattering by paths / paths of all orders": (traced(HOMOGENEOUS, deepest=1), traced(HOMOGENEOUS)),
    "scattering none / single": (
        drawing(estimator_for(Scene(Medium(0.5, 0.3), ALONG, background=1.0)), N),
        drawing(estimator_for(Scene(Medium(0.5, 0.3), ALONG, "single", LAMP, background=1.0)), N),
    ),
}
"""What is timed over what it is compared with."""


def ratio(first: Program, second: Program, rounds: int) -> tuple[float, float, float]:
    """Return quartiles of time over time, both in turn, the first of each round by turns."""
    rng = np.random.default_rng(1)
    found = []
    for k in range(-2, rounds):
        took = [0.0, 0.0]
        for side in (0, 1) if k % 2 else (1, 0):
            start = time.process_time()
            (first, second)[side](rng)
            took[side] = time.process_time() - start
        if k >= 0:
            found.append(took[0] / took[1])
    low, middle, high = statistics.quantiles(found, n=4)
    return low, middle, high


def main() -> None:
    """Print the ratios."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 101
    np.zeros(1 << 21).sum()  # freed memory is kept from here on: page faults would cost more than what is measured
    print(f"{'what / beside what':58} {'ratio':>6}  quartiles      within 3 %")
    for name, (first, second) in PAIRS.items():
        low, middle, high = ratio(first, second, rounds)
        print(f"{name:58} {middle:6.3f}  {low:.3f} {high:.3f}   {'yes' if middle <= 1.03 else 'no'}")


if __name__ == "__main__":
    main()
