"""Bugs of uniforms, streams and state."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.domains import Interval, UnitDisk, UnitSquare
from fogproof.zoo.bug import Bug, sampler_bug
from fogproof.zoo.laws import Array, directions, even, hg, ones

UNIT = Interval(0, 1)
OWN: dict[str, Any] = {"dimensions": None}


GENERATOR = np.random.default_rng(1)


class Stale:
    """Samples with the parameter of the call before."""

    def __init__(self) -> None:
        self.g = 0.5

    def __call__(self, u: Array) -> Array:
        """Return directions with the old g."""
        g, self.g = self.g, 0.3 + 0.4 * float(u[-1, 0])
        return hg(g)[0](u)


def _own_generator(u: Array) -> Array:
    return directions(2 * GENERATOR.random(len(u)) - 1, GENERATOR.random(len(u)))


def _disk_of_15_bits(u: Array) -> Array:
    v = (np.floor(u * 2**15) + 0.5) / 2**15
    return np.sqrt(v[:, :1]) * directions(0 * v[:, 0], v[:, 1])[:, :2]


def _threads(rng: np.random.Generator, n: int) -> Array:
    return np.tile(rng.random(-(-n // 16)), 16)[:n]


def _overlapping(rng: np.random.Generator, n: int) -> Array:
    fresh = rng.random(n - n * 3 // 10)
    return np.concatenate([fresh, fresh[: n * 3 // 10]])


def _short_stride(rng: np.random.Generator, n: int) -> Array:
    v = rng.random(n + 1)
    return np.stack([v[:-1], v[1:]], axis=-1)


def _jitter_once(rng: np.random.Generator, n: int) -> Array:
    return np.stack([rng.random(n), np.full(n, rng.random())], axis=-1)


def _wrapped(rng: np.random.Generator, n: int) -> Array:
    v = rng.random(n)
    return np.stack([v, np.concatenate([rng.random(min(40, n)), v[:-40]])[:n]], axis=-1)


def bugs() -> list[Bug]:
    """Return them."""
    return [
        sampler_bug(
            "parameter set after it is used",
            "celeritas#430",
            Stale(),
            hg(0.5)[1],
            ("hidden state", "order of the rows", "size of the call"),
        ),
        sampler_bug(
            "15-bit rand()",
            "mcx#26",
            _disk_of_15_bits,
            lambda x: np.full(len(x), 1 / np.pi),
            ("coarse numbers",),
            UnitDisk(),
        ),
        sampler_bug("every thread the same seed", "SORT#35", _threads, ones, ("repeated samples",), UNIT, OWN),
        sampler_bug("neighbouring seeds overlap", "qmcpack#1068", _overlapping, ones, ("repeated samples",), UNIT, OWN),
        sampler_bug(
            "stride too short: numbers used twice",
            "openmc#3067",
            _short_stride,
            ones,
            ("dependent samples",),
            UnitSquare(),
            OWN,
        ),
        sampler_bug(
            "second coordinate drawn once",
            "raytracing.github.io#1097",
            _jitter_once,
            ones,
            ("coarse numbers", "dependent samples"),
            UnitSquare(),
            OWN,
        ),
        sampler_bug("dimensions wrap round", "pbrt-v3#237", _wrapped, ones, ("dependent samples",), UnitSquare(), OWN),
        sampler_bug("generator hidden in the sampler", "field", _own_generator, even, ("hidden state",)),
    ]
