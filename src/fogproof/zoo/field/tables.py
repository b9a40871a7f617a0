"""Bugs of discrete tables."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.stats import hypergeom

from fogproof.domains import Discrete
from fogproof.zoo.bug import Bug, sampler_bug
from fogproof.zoo.laws import Array, Function

WEIGHTS = np.random.default_rng(3).gamma(3.0, 1.0, 40)
WEIGHTS /= WEIGHTS.sum()
SIX = np.array([0.10, 0.25, 0.05, 0.30, 0.20, 0.10])
HYPER = hypergeom(100, 50, 49).pmf(np.arange(50))
ONE: dict[str, Any] = {"dimensions": 1}


def _chosen(p: Array) -> Function:
    table = np.cumsum(p)
    return lambda u: np.minimum(np.searchsorted(table, u[:, 0] * table[-1], side="right"), len(p) - 1)


def _weighing(p: Array) -> Function:
    return lambda i: p[i.astype(int)]


def _alias(u: Array) -> Array:
    """An alias table whose last entry took too much: one weight became another's."""
    wrong = SIX.copy()
    wrong[[1, 3]] += (0.12, -0.12)
    return _chosen(wrong)(u)


def _unnormalised(u: Array) -> Array:
    return np.minimum(np.searchsorted(np.cumsum(4 * WEIGHTS), u[:, 0], side="right"), 39)


def _race(rng: np.random.Generator, n: int) -> Array:
    p = np.append(np.full(50, 0.02), np.zeros(1000))
    with np.errstate(invalid="ignore", divide="ignore"):
        q = rng.exponential(size=(n, 50))
    x = np.argmin(q, axis=1)
    return np.where(rng.random(n) < 2e-4, 50 + rng.integers(0, 1000, n), x) if len(p) else x


def _flat_mode(u: Array) -> Array:
    p = HYPER.copy()
    middle = slice(22, 27)
    p[middle] = p[middle].mean()
    p[20:22] *= 1.1
    return _chosen(p)(u)


def _zipf(u: Array) -> Array:
    return np.where(u[:, 0] > 1 - 1e-15, 5, np.floor(5 * u[:, 0]))


def _floored(u: Array) -> Array:
    return 4 * np.floor(10 * u[:, 0])


def bugs() -> list[Bug]:
    """Return them."""
    return [
        sampler_bug(
            "bin index one too high",
            "openmc#1081",
            lambda u: (_chosen(WEIGHTS)(u) + 1) % 40,
            _weighing(WEIGHTS),
            ("shifted",),
            Discrete(40),
            ONE,
        ),
        sampler_bug("alias table built by ==", "EGSnrc#24", _alias, _weighing(SIX), ("few entries",), Discrete(6), ONE),
        sampler_bug(
            "weights that do not sum to 1",
            "Distributions.jl#832",
            _unnormalised,
            _weighing(WEIGHTS),
            ("missing tail", "skipped region", "never drawn"),
            Discrete(40),
            ONE,
        ),
        sampler_bug(
            "entries of probability 0 win the race",
            "pytorch#192812",
            _race,
            lambda i: np.where(i < 50, 0.02, 0.0),
            ("claimed hole",),
            Discrete(1050),
            {"dimensions": None},
        ),
        sampler_bug(
            "Zipf beyond its support",
            "rand_distr#54",
            _zipf,
            lambda i: np.full(len(i), 0.2),
            ("edge of the uniforms", "outside the domain"),
            Discrete(5),
            ONE,
        ),
        sampler_bug(
            "mode of a hypergeometric law flattened",
            "rand#1508",
            _flat_mode,
            _weighing(HYPER),
            ("few entries",),
            Discrete(50),
            ONE,
        ),
        sampler_bug(
            "floor before division",
            "SKIRT9#281",
            _floored,
            lambda i: np.full(len(i), 1 / 40),
            ("skipped region", "never drawn", "skipped band"),
            Discrete(40),
            ONE,
        ),
    ]
