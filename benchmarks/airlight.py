"""Single scattering of typical rays against scipy.integrate.quad, and the accuracy of every named method.

    python benchmarks/airlight.py [RAYS]

Speed: both programs in turns on the same rays, as a ratio of CPU times per ray. Typical means sigma_t and the distance h of the
light from the ray log-uniform in 0.01 … 10, the camera -10 … 5 m from the foot, rays of 0.1 … 20 m. quad is asked for 13 digits
and integrates a function of points in space, as one writes it first, or of scalars, by NumPy's functions or those of `math`.
Accuracy: relative errors against ball arithmetic (tests/truth/airlight_truth.py) on typical and on hard segments. `delivered`
counts segments with a stated error below 1 %; a lie is an error larger than stated, and must not happen.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
from scipy.integrate import quad

from fogproof.analytic import single_scattering
from fogproof.analytic.airlight.integral import ALTERNATIVES
from fogproof.analytic.airlight.integral import integrate as by_method
from fogproof.analytic.airlight.segments import whole
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, PhaseFunction, PointLight, Ray

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "truth"))
from airlight_truth import airlight

ROUNDS = 5
QUADS = 200
"""Rays that quad does in each round."""

MEDIA = 10
LIGHT = PointLight((0.3, 1.0, 4.0), 10.0)
PHASES: tuple[PhaseFunction, ...] = (Isotropic(), HenyeyGreenstein(0.8))


def typical_rays(n: int, rng: np.random.Generator) -> Ray:
    """Return rays around the light, at h and a drawn as said above."""
    axes = rng.normal(size=(2, n, 3))
    d = axes[0] / np.linalg.norm(axes[0], axis=1, keepdims=True)
    across = axes[1] - np.sum(axes[1] * d, axis=1, keepdims=True) * d
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    h, a = 10 ** rng.uniform(-2, 1, (n, 1)), rng.uniform(-10, 5, (n, 1))
    return Ray(np.array(LIGHT.position) + h * across + a * d, d, 10 ** rng.uniform(-1, 1.3, n))


Integrand = Callable[[float], float]


def with_vectors(medium: Medium, origin: np.ndarray, direction: np.ndarray) -> Integrand:
    """The textbook integrand on points in space."""
    sigma_t, position, g = float(medium.sigma_t), np.array(LIGHT.position), getattr(medium.phase, "g", 0.0)

    def f(t: float) -> float:
        to_light = position - (origin + t * direction)
        r = np.linalg.norm(to_light)
        value = np.exp(-sigma_t * (t + r)) / r**2
        mu = np.dot(to_light, direction) / r
        return value * (1 - g * g) / (1 + g * g - 2 * g * mu) ** 1.5 if g else value

    return f


def with_scalars(functions: Any) -> Callable[[Medium, np.ndarray, np.ndarray], Integrand]:
    """The integrand in the two coordinates of the plane through ray and light, by NumPy's functions or those of `math`."""

    def build(medium: Medium, origin: np.ndarray, direction: np.ndarray) -> Integrand:
        exp, sqrt, sigma_t, g = functions.exp, functions.sqrt, float(medium.sigma_t), getattr(medium.phase, "g", 0.0)
        q = np.array(LIGHT.position) - origin
        along = float(q @ direction)
        h2 = float(np.sum((q - along * direction) ** 2))

        def f(t: float) -> float:
            x = t - along
            r2 = x * x + h2
            r = sqrt(r2)
            value = exp(-sigma_t * (t + r)) / r2
            return value * (1 - g * g) / (1 + g * g + 2 * g * x / r) ** 1.5 if g else value

        return f

    return build


STYLES = {"vectors": with_vectors, "numpy scalars": with_scalars(np), "math scalars": with_scalars(math)}


def by_quad(medium: Medium, style: str, origin: np.ndarray, direction: np.ndarray, length: float) -> float:
    """Return the radiance of one ray, 13 digits asked, split at the foot of the perpendicular."""
    f, along = STYLES[style](medium, origin, direction), float((np.array(LIGHT.position) - origin) @ direction)
    points = [along] if 0 < along < length else None
    total = quad(f, 0, length, epsabs=0, epsrel=1e-13, limit=200, points=points)[0]
    return float(medium.sigma_s) * float(LIGHT.intensity) * total / (4 * math.pi)


def speed(n: int) -> None:
    """Print times per ray and their ratios, median and range of interleaved rounds."""
    rng = np.random.default_rng(1)
    ray = typical_rays(n, rng)
    parts = [slice(i * n // MEDIA, (i + 1) * n // MEDIA) for i in range(MEDIA)]
    rays = [Ray(ray.origin[part], ray.direction[part], ray.length[part]) for part in parts]
    for phase in PHASES:
        media = [Medium(0.0, 10.0**e, phase) for e in np.linspace(-2, 1, MEDIA)]
        single_scattering(media[0], typical_rays(100, rng), LIGHT)
        ours, theirs, off = [], {style: [] for style in STYLES}, 0.0
        for k in range(ROUNDS):
            start = time.process_time()
            found = [single_scattering(medium, some, LIGHT) for medium, some in zip(media, rays, strict=True)]
            ours.append((time.process_time() - start) / n)
            which = [(i % MEDIA, k * QUADS + i) for i in range(QUADS)]
            for style, times in theirs.items():
                start = time.process_time()
                for m, i in which:
                    some = rays[m]
                    value = by_quad(media[m], style, some.origin[i], some.direction[i], float(some.length[i]))
                    off = max(off, abs(value / found[m].value[i] - 1))
                times.append((time.process_time() - start) / QUADS)
        stated = np.concatenate([x.error / x.value for x in found])
        print(
            f"{phase!s:26} {n} rays, {np.median(ours) * 1e6:.2f} us a ray, stated error {np.median(stated):.0e} (median)"
        )
        for name, times in theirs.items():
            ratios = np.array(times) / np.array(ours)
            print(
                f"    quad with {name:5} {np.median(times) * 1e6:4.0f} us a ray: ratio {np.median(ratios):.0f} "
                f"({ratios.min():.0f} … {ratios.max():.0f})"
            )
        print(f"    largest difference {off:.1e}")


def segments(kind: str, n: int, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Return sigma_t, h, a, b."""
    if kind == "typical":
        a = rng.uniform(-10, 5, n)
        return 10 ** rng.uniform(-2, 1, n), 10 ** rng.uniform(-2, 1, n), a, a + 10 ** rng.uniform(-1, 1.3, n)
    h = 10 ** rng.uniform(-12, 1.5, n)
    a = np.where(rng.random(n) < 0.5, h * 10 ** rng.uniform(-1, 2, n), 10 ** rng.uniform(-6, 2, n))
    a *= rng.choice([-1, -1, 1], n)
    b = np.where(rng.random(n) < 0.2, np.inf, a + 10 ** rng.uniform(-6, 2, n))
    return np.minimum(10 ** rng.uniform(-9, 2.5, n), 645 / np.hypot(a, h)), h, a, b


def accuracy(n: int) -> None:
    """Print how right, and how honest, each method is."""
    rng = np.random.default_rng(2)
    print(
        f"{'':40} {'median':>8} {'99 %':>8} {'worst':>8} {'< 1e-14':>8} {'< 1e-10':>8} {'delivered':>9} {'lies':>5} us"
    )
    for kind in ("typical", "hard"):
        given = segments(kind, n, rng)
        for phase in PHASES:
            truth = [airlight(*(float(x) for x in one), phase) for one in zip(*given, strict=True)]
            for method in ("asinh", *ALTERNATIVES):
                if method in ("sun2005", "pegoraro2009") and not isinstance(phase, Isotropic):
                    continue
                by_method(whole(*(x[:2] for x in given)), phase, method)  # tables and imports
                start = time.process_time()
                value, error, _, _ = by_method(whole(*given), phase, method)
                took = (time.process_time() - start) / n * 1e6
                with np.errstate(all="ignore"):
                    off = np.array([float(abs(mp.mpf(float(v)) - t)) for v, t in zip(value, truth, strict=True)])
                    size = np.array([float(t) for t in truth])
                    relative, lies = off / size, int(np.sum(off > error))
                    delivered = np.mean(error < 0.01 * size)
                print(
                    f"{kind:8}{phase!s:26}{method:13}{np.median(relative):8.1e} {np.quantile(relative, 0.99):8.1e} "
                    f"{relative.max():8.1e} {np.mean(relative < 1e-14):8.3f} {np.mean(relative < 1e-10):8.3f} "
                    f"{delivered:9.3f} {lies:5} {took:.2f}"
                )


if __name__ == "__main__":
    speed(int(sys.argv[1]) if len(sys.argv) > 1 else 100_000)
    if len(sys.argv) < 3:
        accuracy(1000)
