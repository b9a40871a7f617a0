"""What comparisons of images promise, measured: false alarms, planted errors, time and memory, broken files.

python tools/image_promises.py false-alarms [N]   N right images of each law of noise at alpha 1e-3
python tools/image_promises.py planted            errors that have to be found and named
python tools/image_promises.py size               1920 x 1080 pixels of single scattering: seconds and memory
python tools/image_promises.py fuzz [N]           N broken files of each format: errors with a name, and nothing else
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from fogproof import Film, HenyeyGreenstein, ImageScene, Medium, Perspective, PointLight, Schlick
from fogproof.analytic import image
from fogproof.checks import fresh_seed
from fogproof.checks.statistics.tails import binomial_at_least
from fogproof.errors import FogproofError
from fogproof.images.compare import compare_image
from fogproof.images.formats import format_of, layers

ALPHA = 1e-3
SECOND = 100
"""Paths a pixel of the second order of scattering that is planted."""

Law = Callable[[np.random.Generator, tuple[int, ...]], np.ndarray]

LAWS: dict[str, Law] = {
    "normal": lambda rng, shape: 0.2 * rng.standard_normal(shape),
    "hits and misses": lambda rng, shape: (rng.random(shape) < 0.2) / 0.2 - 1,
    "sixteen hits or misses": lambda rng, shape: rng.binomial(16, 0.1, shape) / 1.6 - 1,
    "exponential": lambda rng, shape: rng.exponential(size=shape) - 1,
    "lognormal": lambda rng, shape: np.exp(rng.standard_normal(shape) - 0.5) - 1,
    "pareto, index 2.5": lambda rng, shape: (rng.pareto(2.5, shape) + 1) * (1.5 / 2.5) - 1,
    "unequal variances": lambda rng, shape: rng.standard_normal(shape) * np.exp(np.linspace(-3, 1, shape[1]))[None, :],
    "rounding of half floats": lambda rng, shape: np.zeros(shape),
    "filtered": lambda rng, shape: _filtered(rng.standard_normal(shape)),
}


def scene(width: int, height: int) -> ImageScene:
    """Return single scattering from a lamp in fog."""
    camera = Perspective((0, 0, 0), (0, 0, 1), 0.7, Film(width, height), wall=10.0)
    return ImageScene(Medium(0.02, 0.08, HenyeyGreenstein(0.6)), camera, "single", PointLight((0.6, 0.8, 4.0), 5.0))


def _filtered(noise: np.ndarray) -> np.ndarray:
    from scipy.ndimage import gaussian_filter

    return np.asarray(gaussian_filter(noise, 0.8))


def false_alarms(count: int) -> bool:
    """Compare right images; say how many of each law were rejected, and whether that is within the promise."""
    given, seed, good = scene(48, 36), fresh_seed(), True
    truth, rng = image(given), np.random.default_rng(seed)
    print(f"{count} right images of each law at alpha {ALPHA:g}, seed {seed}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.npy"
        for name, law in LAWS.items():
            outcomes = {"rejected": 0, "not rejected": 0, "inconclusive": 0}
            for _ in range(count):
                value = truth.value * (1 + law(rng, truth.value.shape))
                np.save(path, value.astype(np.float16 if "half" in name else np.float32))
                done = compare_image([path], given, reference=truth, alpha=ALPHA, explain=False)
                outcomes[done.verdict.outcome] += 1
            chance = binomial_at_least(outcomes["rejected"], count, ALPHA)
            good &= chance > 1e-6
            print(f"{name:26} {outcomes}  P(so many or more) = {chance:.2g}", flush=True)
    return good


def planted() -> Iterator[tuple[str, str, Callable[[np.ndarray], np.ndarray]]]:
    """Yield what is wrong, the cause that has to be named, and the image that shows it."""
    given = scene(96, 72)
    k = 1.55 * 0.6 - 0.55 * 0.6**3
    for name, cause, phase in (
        ("Schlick for Henyey-Greenstein", "schlick-for-henyey-greenstein", Schlick(k)),
        ("wrong sign of g", "wrong-sign-of-g", HenyeyGreenstein(-0.6)),
        ("g = 0.55", "wrong-g", HenyeyGreenstein(0.55)),
        ("g = 0", "isotropic", HenyeyGreenstein(0.0)),
    ):
        other = replace(given, medium=replace(given.medium, phase=phase))
        yield name, cause, lambda _, other=other: image(other).value
    yield "bias of 1e-3", "factor", lambda x: 1.001 * x
    yield "1/(4 pi)", "factor", lambda x: x / (4 * np.pi)
    yield "sigma_s missing", "factor", lambda x: x / 0.08
    yield "shifted by a pixel", "shifted", lambda x: np.roll(x, 1, axis=1)
    yield "upside down", "flipped-rows", lambda x: x[::-1]
    yield "sRGB", "tone-curve", lambda x: np.clip(1.055 * np.maximum(x, 0.0031308) ** (1 / 2.4) - 0.055, 0, 1)
    yield "black", "black", lambda x: 0 * x
    yield "one order too many", "one-order-too-many", _twice


def _twice(x: np.ndarray) -> np.ndarray:
    """Add the second order of scattering by a Monte Carlo of its own: a collision placed uniformly, a direction, a lamp."""
    given, rng = scene(96, 72), np.random.default_rng(fresh_seed())
    from fogproof.analytic import phase_pdf, single_scattering
    from fogproof.analytic.cameras.perspective import rays
    from fogproof.scene import Ray

    total = np.zeros(x.size)
    column, row = np.meshgrid(np.arange(96), np.arange(72))
    for _ in range(SECOND):
        ray = rays(given.camera, (column + rng.random(column.shape)).ravel(), (row + rng.random(row.shape)).ravel())
        t = ray.length * rng.random(x.size)
        at = ray.origin + t[:, None] * ray.direction
        w = rng.normal(size=at.shape)
        w /= np.linalg.norm(w, axis=1)[:, None]
        with np.errstate(divide="ignore"):
            wall = (10 - at[:, 2]) / w[:, 2]
        once = single_scattering(given.medium, Ray(at, w, np.where(wall > 0, wall, np.inf)), given.light).value
        mu = np.clip(np.sum(w * ray.direction, axis=1), -1, 1)
        total += ray.length * np.exp(-0.1 * t) * 0.08 * 4 * np.pi * phase_pdf(given.medium.phase, mu).value * once
    return x + total.reshape(x.shape) / SECOND


def find_planted() -> bool:
    """Compare images with planted errors, with noise and without."""
    given, rng, good = scene(96, 72), np.random.default_rng(fresh_seed()), True
    truth = image(given)
    with tempfile.TemporaryDirectory() as folder:
        for name, cause, make in planted():
            for noise in (0.0, 0.003 if "1e-3" in name else 0.01):
                value = make(truth.value)
                value = value * (1 + noise * rng.standard_normal(value.shape))
                path = Path(folder) / "a.npy"
                np.save(path, value.astype(np.float32))
                verdict = compare_image([path], given, reference=truth).verdict
                named = verdict.outcome == "rejected" and verdict.cause == cause
                good &= named
                mark = "named" if named else "NOT NAMED"
                print(
                    f"{mark:10} {name:30} noise {noise:<6} {verdict.outcome}, {verdict.cause}: {verdict.diagnosis}",
                    flush=True,
                )
    return good


def size() -> bool:
    """Compare an image of 1920 x 1080 pixels in full."""
    given = scene(1920, 1080)
    rng = np.random.default_rng(0)
    clock, used = time.perf_counter(), time.process_time()
    truth = image(given)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        format_of(path).write(path, layers(truth.value * (1 + 0.05 * rng.standard_normal(truth.value.shape))))
        made, spent = time.perf_counter() - clock, time.process_time() - used
        clock, used = time.perf_counter(), time.process_time()
        done = compare_image([path], given)
        seconds, cpu = time.perf_counter() - clock, time.process_time() - used
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"the oracle's image: {made:.1f} s ({spent:.1f} s of one core)")
    print(f"compared, oracle included: {seconds:.1f} s ({cpu:.1f} s of one core), {memory:.2f} GiB at most")
    print(done.verdict)
    return cpu <= 20 and memory < 2


def fuzz(count: int) -> bool:
    """Read broken files: each is a named error, or still an image."""
    seed = fresh_seed()
    rng, good = np.random.default_rng(seed), True
    print(f"seed {seed}")
    value = {name: rng.random((9, 11), np.float32) for name in "RGB"}
    with tempfile.TemporaryDirectory() as folder:
        for suffix in ("exr", "npy", "pfm"):
            path, counts = Path(folder) / f"a.{suffix}", {"image": 0, "named error": 0, "other": 0}
            format_of(path).write(path, value)
            whole = path.read_bytes()
            for _ in range(count):
                bad = bytearray(whole)
                for _ in range(rng.integers(1, 8)):
                    bad[rng.integers(min(500, len(bad)) if rng.random() < 0.7 else len(bad))] = rng.integers(256)
                path.write_bytes(bytes(bad[: rng.integers(len(bad) + 1)] if rng.random() < 0.3 else bad))
                try:
                    format_of(path).read(path)
                    counts["image"] += 1
                except FogproofError:
                    counts["named error"] += 1
                except Exception as error:
                    counts["other"] += 1
                    print(f"{suffix}: {type(error).__name__}: {error}")
            good &= counts["other"] == 0
            print(suffix, counts, flush=True)
    return good


def main() -> int:
    """Measure what is asked for."""
    what, *rest = sys.argv[1:] or ["planted"]
    count = int(rest[0]) if rest else 1000
    runs = {
        "false-alarms": lambda: false_alarms(count),
        "planted": find_planted,
        "size": size,
        "fuzz": lambda: fuzz(count),
    }
    return 0 if runs[what]() else 1


if __name__ == "__main__":
    sys.exit(main())
