"""Errors of a given size, one for each kind of finding, and the right samplers that they are planted in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from planted_samplers import (
    box,
    few,
    line,
    line_with_cdf,
    lobe,
    peak_with_cdf,
    peak_with_inverse,
    square,
    stream,
    table,
    volume,
    wedge,
    weighted,
    with_atoms,
    with_events,
)
from planted_smooth import few_entries, in_uniforms, least_seen, polynomials, products, straight_and_bent, with_density

from fogproof.checks import Subject
from fogproof.contracts import Draw

Right = Callable[[], Subject]
Wrong = Callable[[Subject, float, int, bool], Subject]


def _shifted(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    """Move a share `size` of the samples across the middle."""
    near = lambda x: (x >= 0.5 - size) & (x < 0.5) if up else (x >= 0.5) & (x < 0.5 + size)  # noqa: E731
    return in_uniforms(subject, lambda x: np.where(near(x), x + (size if up else -size), x))


def _two_level(size: float, up: bool) -> tuple[float, float, float]:
    """Return a share of cells and the ratios in those and in the others, of mean 1 and root mean square deviation `size`."""
    if size < 0.9:
        return 0.5, (1 + size if up else 1 - size), (1 - size if up else 1 + size)
    share = 1 / (1 + size * size)
    return share, 1 / share, 0.0


def _uneven_line(subject: Subject, size: float, trial: int, up: bool, cells: int) -> Subject:
    share, high, low = _two_level(size, up)
    chosen = np.random.default_rng(trial).permutation(cells) < share * cells
    return in_uniforms(
        subject, with_density(lambda x: np.where(chosen[np.minimum((x * cells).astype(int), cells - 1)], high, low))
    )


def _uneven_axis(subject: Subject, size: float, trial: int, up: bool, cells: int) -> Subject:
    share, high, low = _two_level(size, up)
    chosen = np.random.default_rng(trial).permutation(cells) < share * cells
    along = with_density(lambda x: np.where(chosen[np.minimum((x * cells).astype(int), cells - 1)], high, low))

    def sample(u: np.ndarray) -> np.ndarray:
        x = u.copy()
        x[:, trial % 3] = along(u[:, trial % 3])
        return x

    return replace(subject, sample=sample)


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
    return in_uniforms(
        subject, with_density(lambda x: 1 + size * np.sqrt(2) * np.sin(2 * np.pi * (turns * x + 0.5 * up)))
    )


def _missing(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    start = np.random.default_rng(trial).random() * (1 - size)
    return in_uniforms(subject, lambda x: np.where(x * (1 - size) < start, x * (1 - size), x * (1 - size) + size))


def _tail(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    return in_uniforms(subject, lambda x: (1 - size) * x + (size if up else 0))


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
    return in_uniforms(subject, with_density(lambda x: np.where(inside(x), ratio, (cells - ratio) / (cells - 1))))


def _other_atom(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    q = 0.05 + (size if up else -size)
    return replace(subject, sample=lambda u: np.where(u[:, 0] < q, 0.5, u[:, 1]))


def _other_event(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    q = 0.3 + (size if up else -size)
    return replace(subject, sample=lambda u: Draw(u[:, 0], event=(u[:, 1] < q) * 1.0))


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
    return in_uniforms(subject, lambda x: (np.floor(x * values) + 0.5) / values)


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


def _scaled(subject: Subject, size: float, trial: int, up: bool) -> Subject:
    factor, pdf = 1 + (size if up else -size) * 1.001, subject.pdf
    return replace(subject, pdf=lambda x: factor * pdf(x))


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
    Plant("distribution", line, _shifted),
    Plant("distribution", table, _shifted),
    Plant("smooth components", line, polynomials),
    Plant("smooth components", few, few_entries),
    *(
        plant
        for right in (line_with_cdf, peak_with_cdf, peak_with_inverse)
        for plant in (
            Plant("distribution", right, _shifted),
            Plant("smooth components", right, polynomials),
            Plant("chi-square", right, _uneven_line, True),
        )
    ),
    Plant("chi-square", line, _uneven_line, True),
    Plant("scan", line, _missing),
    Plant("ends", line, _tail),
    Plant("chi-square, joint", square, _uneven_plane, True),
    Plant("dependence of the axes", square, products),
    Plant("scan for patches", square, _patch),
    Plant("chi-square, fine joint", square, _uneven_plane, True),
    Plant("labels", box, _factor),
    Plant("labels in cells", box, _ripple),
    Plant("labels along smooth functions", box, straight_and_bent),
    Plant("labels along smooth functions", wedge, least_seen),
    Plant("labels along the axes", volume, _uneven_axis, True),
    Plant("labels by level of the pdf", box, _factor),
    Plant("labels, largest cell", box, _one_cell, True),
    Plant("atom", with_atoms, _other_atom),
    Plant("continuous part", with_atoms, _other_atom),
    Plant("declared event", with_events, _other_event),
    Plant("mean weight", weighted, _other_weight),
    Plant("serial correlation", stream, _correlated),
    Plant("independence within a call", stream, _even),
    Plant("size of the call", stream, _small_calls),
    Plant("repeated points", line, _with_atom),
    Plant("different values of x", square, _few),
    Plant("normalisation", line, _scaled, sure=True),
    Plant("normalisation", lobe, _scaled, sure=True),
)
