"""Is every stated resolution true? An error of exactly that size is planted, and must be caught as often as stated.

    python tools/planted.py [--trials 300] [--samples 30000] [--only TEXT]

For each kind of finding a right sampler passes and says what it would have caught; then the same sampler with that very error is
judged again and again. What is counted is that finding alone, whatever else rejects. A part of `make calibrate`.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fogproof.checks import Finding, SamplerCheck, Subject, fresh_seed
from fogproof.contracts import Draw
from fogproof.domains import Box, Discrete, Interval, UnitSphere, UnitSquare

ALPHA = 1e-4
Right = Callable[[], Subject]
Wrong = Callable[[Subject, float, int, bool], Subject]


def ones(x: np.ndarray) -> np.ndarray:
    """Return the uniform density on a domain of measure 1."""
    return np.ones(len(x))


def _line() -> Subject:
    return Subject(lambda u: u[:, 0].copy(), ones, Interval(0, 1), 1)


def _square() -> Subject:
    return Subject(lambda u: u.copy(), ones, UnitSquare(), 2)


def _labelled() -> Subject:
    return Subject(lambda u: u.copy(), ones, Box((0.0,), (1.0,)), 1)


def _stream() -> Subject:
    return Subject(lambda rng, n: rng.random(n), ones, Interval(0, 1), None)


def _by_line(subject: Subject, move: Callable[[np.ndarray], np.ndarray], axis: int = 0) -> Subject:
    """Return the subject with one coordinate of its points moved by a map of [0, 1] to itself."""
    sample = subject.sample

    def moved(u: np.ndarray) -> np.ndarray:
        x = np.array(sample(u))
        column = x if x.ndim == 1 else x[:, axis]
        column[...] = move(column)
        return x

    return replace(subject, sample=moved)


def _shifted(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """Move a share `size` of the samples across the middle."""
    near = lambda x: (x >= 0.5 - size) & (x < 0.5) if up else (x >= 0.5) & (x < 0.5 + size)  # noqa: E731
    return _by_line(subject, lambda x: np.where(near(x), x + (size if up else -size), x))


def _with_density(density: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    """Return the map from uniform numbers to numbers of a density on [0, 1], by its numerical cdf."""
    edges = np.linspace(0, 1, 1 << 16)
    mass = np.maximum(density(0.5 * (edges[1:] + edges[:-1])), 0.0)
    cdf = np.concatenate([[0.0], np.cumsum(mass)]) / mass.sum()
    return lambda u: np.interp(u, cdf, edges)


def _smooth(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    from numpy.polynomial.legendre import Legendre

    k = 1 + trial % 4
    p = Legendre.basis(k)
    sign = 1 if up else -1
    return _by_line(subject, _with_density(lambda x: 1 + sign * size * np.sqrt(2 * k + 1) * p(2 * x - 1)))


def _two_level(size: float, up: bool) -> tuple[float, float, float]:
    """Return a share of cells and the ratios in those and in the others, of mean 1 and root mean square deviation `size`."""
    if size < 0.9:
        return 0.5, (1 + size if up else 1 - size), (1 - size if up else 1 + size)
    share = 1 / (1 + size * size)
    return share, 1 / share, 0.0


def _uneven_line(subject: Subject, size: float, trial: int, up: bool, cells: int) -> Subject:
    share, high, low = _two_level(size, up)
    chosen = np.random.default_rng(trial).permutation(cells) < share * cells
    return _by_line(
        subject, _with_density(lambda x: np.where(chosen[np.minimum((x * cells).astype(int), cells - 1)], high, low))
    )


def _uneven_plane(subject: Subject, size: float, trial: int, up: bool, cells: int) -> Subject:
    side = round(np.sqrt(cells))
    share, high, low = _two_level(size, up)
    chosen = np.random.default_rng(trial).permutation(cells) < share * cells
    mass = np.where(chosen, high, low)
    cdf = np.cumsum(mass) / mass.sum()

    def sample(u: np.ndarray) -> np.ndarray:
        cell = np.minimum(np.searchsorted(cdf, u[:, 2]), cells - 1)
        return (np.stack([cell // side, cell % side], axis=-1) + u[:, :2]) / side

    return replace(subject, sample=sample, dimensions=3)


def _ripple(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    turns = 1 + trial % 3
    return _by_line(
        subject, _with_density(lambda x: 1 + size * np.sqrt(2) * np.sin(2 * np.pi * (turns * x + 0.5 * up)))
    )


def _dependent(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    sign = 1 if up else -1

    def sample(u: np.ndarray) -> np.ndarray:
        tilt = sign * 3 * size * (2 * u[:, 0] - 1)  # density of y given x: 1 + tilt (2 y - 1)
        v = u[:, 1]
        root = np.sqrt((1 - tilt) ** 2 + 4 * tilt * v)
        y = np.where(np.abs(tilt) < 1e-9, v, (tilt - 1 + root) / np.where(tilt == 0, 1, 2 * tilt))
        return np.stack([u[:, 0], np.clip(y, 0, 1)], axis=-1)

    return replace(subject, sample=sample)


def _missing(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    start = np.random.default_rng(trial).random() * (1 - size)
    return _by_line(subject, lambda x: np.where(x * (1 - size) < start, x * (1 - size), x * (1 - size) + size))


def _tail(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    return _by_line(subject, lambda x: (1 - size) * x + (size if up else 0))


def _patch(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    side = np.sqrt(size)
    at = np.random.default_rng(trial).random(2) * (1 - side)

    def sample(u: np.ndarray) -> np.ndarray:
        x, v = u[:, :2].copy(), u
        inside = ((x >= at) & (x < at + side)).all(axis=1)
        x[inside] = v[inside, 2:4]
        return x

    return replace(subject, sample=sample, dimensions=4)


def _factor(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    factor = 1 + size if up else 1 - size
    return replace(subject, pdf=lambda x: np.full(len(x), factor))


def _one_cell(subject: Subject, size: float, trial: int, up: bool, cells: int) -> Subject:
    """The pdf is too large, or too small, by the factor in one of so many cells of equal probability."""
    cell = np.random.default_rng(trial).integers(cells)
    ratio = 1 / (1 + size) if up else min(1 / max(1 - size, 1e-9), 0.5 * cells)
    inside = lambda x: (x * cells).astype(int) == cell  # noqa: E731
    return _by_line(subject, _with_density(lambda x: np.where(inside(x), ratio, (cells - ratio) / (cells - 1))))


def _atoms() -> Subject:
    def sample(u: np.ndarray) -> np.ndarray:
        return np.where(u[:, 0] < 0.05, 0.5, u[:, 1])

    return Subject(sample, lambda x: 0.95 * ones(x), Interval(0, 1), 2, {0.5: 0.05})


def _other_atom(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    q = 0.05 + (size if up else -size)
    return replace(subject, sample=lambda u: np.where(u[:, 0] < q, 0.5, u[:, 1]))


def _labels() -> Subject:
    return Subject(
        lambda u: Draw(u[:, 0], event=(u[:, 1] < 0.3) * 1.0), ones, Interval(0, 1), 2, events={1: 0.3, 0: 0.7}
    )


def _other_event(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    q = 0.3 + (size if up else -size)
    return replace(subject, sample=lambda u: Draw(u[:, 0], event=(u[:, 1] < q) * 1.0))


def _weighted() -> Subject:
    return Subject(lambda u: Draw(u[:, 0], weight=1.2 * u[:, 0]), ones, Interval(0, 1), 1, albedo=0.6)


def _other_weight(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    return replace(subject, sample=lambda u: Draw(u[:, 0], weight=1.2 * u[:, 0] + (size if up else -size)))


def _correlated(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    lag = (1, 2, 40, 64)[trial % 4]
    r = 2 * np.sin(np.pi / 6 * size) * (1 if up else -1)  # of normal numbers, whose ranks have the wanted correlation

    def sample(rng: np.random.Generator, n: int) -> np.ndarray:
        from scipy.signal import lfilter
        from scipy.special import ndtr

        feedback = np.zeros(lag + 1)
        feedback[[0, lag]] = 1, -r
        return ndtr(lfilter([np.sqrt(1 - r * r)], feedback, rng.normal(size=n + 20 * lag))[20 * lag :])

    return replace(subject, sample=sample)


def _with_atom(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    return replace(subject, sample=lambda u: np.where(u[:, 1] < size, 0.37, u[:, 0]), dimensions=2)


def _few(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    values = max(int(1 / size), 1)
    return _by_line(subject, lambda x: (np.floor(x * values) + 0.5) / values)


def _small_calls(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    def sample(rng: np.random.Generator, n: int) -> np.ndarray:
        x = rng.random(n)
        return (
            np.where((x >= 0.5 - 0.5 * size) & (x < 0.5 + 0.5 * size), 0.5 + 0.5 * size * (1 if up else -1), x)
            if n == 1
            else x
        )

    return replace(subject, sample=sample)


def _even(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    def sample(rng: np.random.Generator, n: int) -> np.ndarray:
        strata = int(size * n)  # a share of the call is stratified: so much of the variance is missing
        x = np.concatenate([(np.arange(strata) + rng.random(strata)) / max(strata, 1), rng.random(n - strata)])
        return rng.permutation(x)

    return replace(subject, sample=sample)


def _lobe() -> Subject:
    def sample(u: np.ndarray) -> np.ndarray:
        z, phi = 2 * np.sqrt(u[:, 0]) - 1, 2 * np.pi * u[:, 1]
        s = np.sqrt(np.maximum(1 - z * z, 0))
        return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)

    pdf = lambda x: (1 + x[:, 2]) / (4 * np.pi)  # noqa: E731
    return Subject(sample, pdf, UnitSphere(), 2, axis=(0.0, 0.0, 1.0), mean_cosine=1 / 3, eval=pdf, albedo=1.0)


def _scaled(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    factor, pdf = 1 + (size if up else -size) * 1.001, subject.pdf
    return replace(subject, pdf=lambda x: factor * pdf(x))


def _table() -> Subject:
    weights = np.arange(1.0, 1001.0) / 500500
    cdf = np.cumsum(weights)
    sample = lambda u: np.minimum(np.searchsorted(cdf, u[:, 0], side="right"), 999) * 1.0  # noqa: E731
    return Subject(sample, lambda i: weights[np.asarray(i).astype(int)], Discrete(1000), 1)


def _by_share(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """Move a share of the samples of a table across its middle."""
    sample, start, step = subject.sample, 0.5 - size * up, size if up else -size
    return replace(subject, sample=lambda u: sample(np.where((u >= start) & (u < start + size), u + step, u)))


@dataclass(frozen=True)
class Plant:
    """A kind of finding: its name, a right subject, and that subject with an error of a given size.

    cells  whether the error needs the number of cells that the resolution speaks of
    sure   whether no chance is involved
    """

    check: str
    right: Right
    wrong: Callable[..., Subject]
    cells: bool = False
    sure: bool = False


PLANTS = (
    Plant("distribution", _line, _shifted),
    Plant("distribution", _table, _by_share),
    Plant("smooth components", _line, _smooth),
    Plant("chi-square", _line, _uneven_line, True),
    Plant("scan", _line, _missing),
    Plant("ends", _line, _tail),
    Plant("chi-square, joint", _square, _uneven_plane, True),
    Plant("dependence of the axes", _square, _dependent),
    Plant("scan for patches", _square, _patch),
    Plant("chi-square, fine joint", _square, _uneven_plane, True),
    Plant("labels", _labelled, _factor),
    Plant("labels in cells", _labelled, _ripple),
    Plant("labels by level of the pdf", _labelled, _factor),
    Plant("labels, largest cell", _labelled, _one_cell, True),
    Plant("atom", _atoms, _other_atom),
    Plant("continuous part", _atoms, _other_atom),
    Plant("declared event", _labels, _other_event),
    Plant("mean weight", _weighted, _other_weight),
    Plant("serial correlation", _stream, _correlated),
    Plant("independence within a call", _stream, _even),
    Plant("size of the call", _stream, _small_calls),
    Plant("repeated points", _line, _with_atom),
    Plant("different values of x", _square, _few),
    Plant("normalisation", _line, _scaled, sure=True),
    Plant("normalisation", _lobe, _scaled, sure=True),
)


def _found(check: str, findings: tuple[Finding, ...]) -> Iterator[Finding]:
    for finding in findings:
        name = re.sub(r"labels in \d+ cells", "labels in cells", finding.check)
        if name == check or name.startswith((f"{check} of ", f"{check} in ")):
            yield finding


def _judged(subject: Subject, samples: int, seed: int) -> tuple[Finding, ...]:
    return SamplerCheck.of(subject, None, samples, ALPHA, seed).run().findings


def stated(plant: Plant, samples: int, seed: int) -> tuple[str, float]:
    """Return what the resolution of a right sampler's pass is of, and its value: the median of three."""
    found = [next(_found(plant.check, _judged(plant.right(), samples, seed + i))) for i in range(3)]
    resolutions = [f.resolution for f in found if f.resolution is not None]
    assert len(resolutions) == len(found), f"{plant.check} states no resolution"
    return resolutions[0].kind, float(np.median([r.value for r in resolutions]))


def caught(plant: Plant, kind: str, size: float, trials: int, samples: int, seed: int) -> int:
    """Return how many of so many errors of the given size were caught by that very finding."""
    extra: dict[str, Any] = {"cells": int(re.findall(r"(\d+) cells", kind)[0])} if plant.cells else {}
    hits = 0
    for trial in range(trials):
        subject = plant.wrong(plant.right(), size, trial, bool(trial % 2), **extra)
        findings = _judged(subject, samples, seed + trial)
        hits += any(f.outcome == "rejected" for f in _found(plant.check, findings))
    return hits


def least(plant: Plant, trials: int) -> int:
    """Return how many must be caught, if 99 of 100 are but for chance."""
    return trials if plant.sure else int(0.99 * trials - 4 * np.sqrt(trials * 0.0099))


def section(trials: int, samples: int, seed: int, only: str = "") -> tuple[str, bool]:
    """Return the part of the result page about resolutions, and whether all are true."""
    lines = [
        f"## Stated resolutions, alpha = {ALPHA:g}",
        "",
        f"Of each kind of finding, as stated for {samples} samples: an error of exactly that size is planted, in both directions",
        "and at changing places. 99 of 100 must be caught by that very finding; the last column is how many of half the size are.",
        "",
        "| kind of finding | resolution | value | caught | of | at least | of half |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]
    good = True
    for plant in PLANTS:
        if only in plant.check:
            kind, size = stated(plant, samples, seed)
            tried = 4 if plant.sure else trials
            hits = caught(plant, kind, size, tried, samples, seed + 10)
            halves = max(tried // 4, 1)
            half = caught(plant, kind, 0.5 * size, halves, samples, seed + 10 + tried) / halves
            good &= hits >= least(plant, tried)
            lines.append(
                f"| {plant.check} | {kind} | {size:.3g} | {hits} | {tried} | {least(plant, tried)} | {half:.0%} |"
            )
            print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines) + "\n", good


def main() -> None:
    """Print the table; exit 1 if a resolution is not true."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=300)
    parser.add_argument("--samples", type=int, default=30_000)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    text, good = section(arguments.trials, arguments.samples, fresh_seed() >> 2, arguments.only)
    print(text)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
