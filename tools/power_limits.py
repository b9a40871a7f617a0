"""From how many samples on is a planted error rejected, and how many would the best of all tests need?

    python tools/power_limits.py [--seeds 10] [--only TEXT]

Errors that jump, hide in dependence or in the order of the samples. The best test of one known error against none (Neyman and
Pearson's) needs about (z_alpha + z_miss)^2 / D samples, with D the chi-square distance of the two laws; where a few samples are
enough, or where an error shows in pairs, the number says so. The limit is the least power of two at which all seeds reject.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fogproof.catalogue.outsiders.subjects import Outsider
from fogproof.checks import check_sampler, fresh_seed
from fogproof.domains import Box, Discrete, Domain, Interval, UnitSphere, UnitSquare
from fogproof.estimators import Directions
from fogproof.scene import HenyeyGreenstein
from fogproof.verify import select

ALPHA, MISS = 1e-6, 0.01
MOST = 1 << 21
ALLOWED = 4.0
"""Times the best test's count; powers of two may double it."""

_SPREAD = "spread over hundreds of cells, none of which is known beforehand"


@dataclass(frozen=True)
class Row:
    """An error: what is drawn, what is claimed, and how many samples the best test needs; `told` says why the check needs more."""

    name: str
    sample: Callable[..., Any]
    pdf: Callable[[np.ndarray], np.ndarray]
    domain: Domain
    dimensions: int | None
    needed: float
    told: str = ""


def needed(distance: float) -> float:
    """Return how many samples the best test needs at a chi-square distance; log(1/alpha) events at least where it is large."""
    from scipy.special import ndtri

    normal = float((ndtri(ALPHA) + ndtri(MISS)) ** 2) / distance
    return max(normal, math.log(1 / ALPHA) / math.log1p(distance))


def _outsider(name: str) -> Outsider:
    return select([f"outsiders/{name}"])[0].make()


def _of(name: str, subject: Outsider, count: float, told: str = "") -> Row:
    return Row(name, subject.sample, subject.pdf, subject.domain, subject.dimensions, count, told)


def _sun() -> Row:
    sun = _outsider("lights/cone/0.2665/0")
    wrong = replace(sun, pdf=lambda x: 0.98 * sun.pdf(x))
    # the claim is no density: samples alone never tell; points of a known law do, and half of the coins are theirs
    return _of("sun disk, pdf x .98", wrong, 2 * needed(0.02**2), "counted as coins of the label test")


def _map(change: Callable[[np.ndarray], np.ndarray]) -> tuple[Outsider, float]:
    height, width = 64, 128
    weight = np.random.default_rng(7).random((height, width)) ** 2 + 0.01
    weight[12, 42:45] = 1000.0
    weight /= weight.sum()
    drawn = change(weight)
    drawn = drawn / drawn.sum()
    cumulated = np.cumsum(drawn.ravel())
    distance = float(np.sum((drawn - weight) ** 2 / weight))

    def sample(u: np.ndarray) -> np.ndarray:
        j = np.minimum(np.searchsorted(cumulated, u[:, 0] * cumulated[-1], side="right"), drawn.size - 1)
        return np.stack([(j // width + u[:, 1]) / height, (j % width + u[:, 2]) / width], axis=-1)

    def pdf(x: np.ndarray) -> np.ndarray:
        row, column = (np.minimum((x[:, k] * size).astype(int), size - 1) for k, size in enumerate((height, width)))
        return weight[row, column] * weight.size

    return Outsider(sample, pdf, UnitSquare(), 3), distance


def _one_sun_texel(weight: np.ndarray) -> np.ndarray:
    changed = weight.copy()
    changed[12, 43] *= 0.8
    return changed


def _table() -> Row:
    n = 100_000
    weight = np.random.default_rng(20).random(n) + 0.5
    weight /= weight.sum()
    moved = np.roll(weight, 1)
    cumulated = np.cumsum(moved)
    sample = lambda u: np.minimum(np.searchsorted(cumulated, u[:, 0], side="right"), n - 1) * 1.0  # noqa: E731
    count = needed(float(np.sum((moved - weight) ** 2 / weight)))
    return Row("Discrete(1e5), weights off by one", sample, lambda k: weight[k.astype(int)], Discrete(n), 1, count)


def _ripple() -> Row:
    axis = np.array([2.0, -3.0, 6.0]) / 7
    lobe = Directions(HenyeyGreenstein(0.8), tuple(axis.tolist()))
    size, turns = 0.3, 6

    def sample(u: np.ndarray) -> np.ndarray:
        x = lobe.sample(np.stack([u[:, 0], _unrippled(u[:, 1], size, turns)], axis=-1)).x
        return np.asarray(x)

    return Row(
        "tilted lobe, ripple of 30 % in azimuth", sample, lobe.pdf, UnitSphere(), 2, needed(size * size / 2), _SPREAD
    )


def _unrippled(v: np.ndarray, size: float, turns: int) -> np.ndarray:
    """Return numbers of density 1 + size sin(2 pi turns t) on [0, 1]."""
    t = np.linspace(0, 1, 1 << 16)
    cdf = t + size * (1 - np.cos(2 * np.pi * turns * t)) / (2 * np.pi * turns)
    return np.interp(v, cdf, t)


def _one_uniform() -> Row:
    lobe = Directions(HenyeyGreenstein(0.5))

    def sample(u: np.ndarray) -> np.ndarray:
        return np.asarray(lobe.sample(np.stack([u[:, 0], (37 * u[:, 0]) % 1], axis=-1)).x)

    return Row(
        "mu and phi from one uniform", sample, lobe.pdf, UnitSphere(), 1, 2, "a curve: the best test sees it at once"
    )


def _hole() -> Row:
    radius = 0.02

    def sample(u: np.ndarray) -> np.ndarray:
        x = _uniform(u[:, :2])
        again = (x @ np.array([0.6, 0.0, 0.8])) > np.cos(radius)
        return np.where(again[:, None], _uniform(u[:, 2:]) * [1, 1, -1], x)

    mass = math.sin(radius / 2) ** 2
    return Row(
        "disk of .02 rad never drawn", sample, lambda x: np.full(len(x), 1 / (4 * np.pi)), UnitSphere(), 4,
        math.log(1 / ALPHA) / mass, "a place not known beforehand pays for all places there are",
    )  # fmt: skip


def _uniform(u: np.ndarray) -> np.ndarray:
    z, phi = 1 - 2 * u[:, 0], 2 * np.pi * u[:, 1]
    s = np.sqrt(np.maximum(1 - z * z, 0))
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


def _five() -> Row:
    from scipy.special import ndtr, ndtri

    r = 0.1

    def sample(u: np.ndarray) -> np.ndarray:
        z = ndtri(np.clip(u, 1e-16, 1 - 1e-16))
        z[:, 1] = r * z[:, 0] + math.sqrt(1 - r * r) * z[:, 1]
        return ndtr(z)

    distance = 1 / (1 - r * r) - 1
    return Row(
        "5-D box, correlation of .1",
        sample,
        lambda x: np.ones(len(x)),
        Box((0.0,) * 5, (1.0,) * 5),
        5,
        needed(distance),
    )


def _lagged() -> Row:
    from scipy.signal import lfilter
    from scipy.special import ndtr

    r = 0.05

    def sample(rng: np.random.Generator, n: int) -> np.ndarray:
        return np.asarray(ndtr(lfilter([math.sqrt(1 - r * r)], [1, 0, -r], rng.normal(size=n + 40))[40:]))

    return Row(
        "correlation of .05 two samples later", sample, lambda x: np.ones(len(x)), Interval(0, 1), None, needed(r * r)
    )


def _pairs() -> Row:
    def sample(rng: np.random.Generator, n: int) -> np.ndarray:
        return np.repeat(rng.random((n + 1) // 2), 2)[:n]

    return Row("every point returned twice", sample, lambda x: np.ones(len(x)), Interval(0, 1), None, 2, "seen at once")


def rows() -> list[Row]:
    """Return all errors."""
    shifted, far = _map(lambda weight: np.roll(weight, 1, axis=1))
    texel, near = _map(_one_sun_texel)
    return [
        _sun(),
        _of("map shifted by a texel", shifted, needed(far)),
        _of("one sun texel x .8", texel, needed(near), "one of thousands of cells, which pay for each other"),
        _table(),
        _ripple(),
        _one_uniform(),
        _hole(),
        _five(),
        _lagged(),
        _pairs(),
    ]


def limit(row: Row, seeds: int) -> int | None:
    """Return the least power of two of samples at which all seeds reject, from 128 on; None if there is none."""
    n = 128
    while n <= MOST:
        if all(_rejected(row, n) for _ in range(seeds)):
            return n
        n *= 2
    return None


def _rejected(row: Row, n: int) -> bool:
    options: dict[str, Any] = {"dimensions": row.dimensions, "samples": n, "alpha": ALPHA, "seed": fresh_seed()}
    return check_sampler(row.sample, row.pdf, row.domain, **options).outcome == "rejected"


def main() -> None:
    """Print the table; exit 1 if an error is never rejected, or far above the best test's count without a word why."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    good = True
    print("| error | best test | this check | times | |\n|---|--:|--:|--:|---|")
    for row in rows():
        if arguments.only in row.name:
            found = limit(row, arguments.seeds)
            times = math.inf if found is None else found / row.needed
            good &= found is not None and (times <= 2 * ALLOWED or bool(row.told))
            print(f"| {row.name} | {row.needed:.0f} | {found} | {times:.2g} | {row.told} |", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
