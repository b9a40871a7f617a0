"""Environment maps: tables of texels sampled by their cumulated weights, on the square and on the sphere."""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.outsiders.subjects import Outsider, case
from fogproof.domains import Discrete, UnitSphere, UnitSquare

_SIZES = ((4, 8, 3.0), (16, 32, 100.0), (64, 128, 1e3), (256, 512, 1e4), (512, 1024, 1e5))


@cache
def table(height: int, width: int, sun: float) -> np.ndarray:
    """Return (height, width) weights: speckled, three texels of sun, three rows of black."""
    rng = np.random.default_rng(7)
    weight = rng.random((height, width)) ** 2 + 0.01
    weight[height // 5, width // 3 : width // 3 + 3] = sun
    weight[height // 2 : height // 2 + max(height // 100, 1)] = 0.0
    return np.asarray(weight / weight.sum())


def _texel(cumulated: np.ndarray, u: np.ndarray) -> np.ndarray:
    return np.minimum(np.searchsorted(cumulated, u * cumulated[-1], side="right"), len(cumulated) - 1)


def square(height: int, width: int, sun: float) -> Outsider:
    """Return a map on the unit square, (row, column)."""
    weight = table(height, width, sun)
    cumulated = np.cumsum(weight.ravel())

    def sample(u: np.ndarray) -> np.ndarray:
        j = _texel(cumulated, u[:, 0])
        return np.stack([(j // width + u[:, 1]) / height, (j % width + u[:, 2]) / width], axis=-1)

    def pdf(x: np.ndarray) -> np.ndarray:
        row = np.minimum((x[:, 0] * height).astype(int), height - 1)
        return weight[row, np.minimum((x[:, 1] * width).astype(int), width - 1)] * weight.size

    return Outsider(sample, pdf, UnitSquare(), 3)


def sphere(height: int, width: int, sun: float) -> Outsider:
    """Return a map on the sphere, rows by the angle from +z; in a texel, the angle and the azimuth are uniform."""
    flat = square(height, width, sun)

    def sample(u: np.ndarray) -> np.ndarray:
        y = flat.sample(u)
        theta, phi = np.pi * y[:, 0], 2 * np.pi * y[:, 1]
        s = np.sin(theta)
        return np.stack([s * np.cos(phi), s * np.sin(phi), np.cos(theta)], axis=-1)

    def pdf(x: np.ndarray) -> np.ndarray:
        s = np.hypot(x[:, 0], x[:, 1])
        theta, phi = np.arctan2(s, x[:, 2]), np.arctan2(x[:, 1], x[:, 0])
        y = np.stack([theta / np.pi, np.where(phi < 0, phi + 2 * np.pi, phi) / (2 * np.pi)], axis=-1)
        return flat.pdf(y) / (2 * np.pi**2 * np.maximum(s, 1e-300))

    return Outsider(sample, pdf, UnitSphere(), 3)


def entries(n: int) -> Outsider:
    """Return a table of n weights alone."""
    weight = np.random.default_rng(20).random(n) + 0.5
    weight /= weight.sum()
    cumulated = np.cumsum(weight)
    pmf = lambda k: weight[np.asarray(k).astype(int)]  # noqa: E731
    return Outsider(lambda u: _texel(cumulated, u[:, 0]), pmf, Discrete(n), 1)


def cases() -> list[SamplerCase]:
    """Return the maps and tables."""
    found = []
    source = "Pharr, Jakob & Humphreys 2016, 14.2.4"
    for height, width, sun in _SIZES:
        for name, make in (("square", square), ("sphere", sphere)):
            by_name = (height, name) not in ((64, "sphere"), (512, "square"))
            title = f"Environment map of {height} x {width} on the {name}"
            make_it = partial(make, height, width, sun)
            found.append(case(f"maps/{name}/{height}x{width}", title, make_it, source, by_name=by_name))
    for n in (2, 1000, 100_000):
        found.append(
            case(f"maps/table/{n}", f"Table of {n} weights", partial(entries, n), source, by_name=n != 100_000)
        )
    return found
