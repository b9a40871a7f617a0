"""A comparison of an image with the oracle's, in units of reading it: per megapixel."""

from __future__ import annotations

import atexit
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.contracts import Reference
from fogproof.images.compare import compare_image
from fogproof.images.picture import read_picture
from fogproof.scene import HenyeyGreenstein, ImageScene, Medium, PointLight
from fogproof.scene.cameras import Film, Perspective

SIZE = 256


def _ways() -> dict[str, Way]:
    camera = Perspective((0, 0, 0), (0, 0, 1), 0.7, Film(SIZE, SIZE), wall=10.0)
    scene = ImageScene(Medium(0.02, 0.08, HenyeyGreenstein(0.6)), camera, "single", PointLight((0.6, 0.8, 4.0), 5.0))
    folder = tempfile.TemporaryDirectory()
    atexit.register(folder.cleanup)
    rng, truth = np.random.default_rng(1), np.full((SIZE, SIZE), 0.5)
    paths = [Path(folder.name) / f"{i}.npy" for i in range(4)]
    for path in paths:
        np.save(path, (truth * (1 + 0.1 * rng.standard_normal(truth.shape))).astype(np.float32))
    reference = Reference(truth, np.asarray(1e-9))
    megapixels = SIZE * SIZE / 1e6

    def compare() -> Any:
        return compare_image(paths, scene, reference=reference, explain=False)

    def read() -> Any:
        return read_picture(paths, camera.film, None, "", None)

    return {"reading": Way(read, megapixels), "comparing": Way(compare, megapixels)}


def benchmarks() -> list[Benchmark]:
    """Return it."""
    goal = {"comparing": Goal("<=", 200.0)}
    return [Benchmark("images", "Comparing four renders", "megapixel", "reading", _ways, goal)]
