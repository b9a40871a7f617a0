"""The mean of a function over each pixel of an image, with an estimate of its error.

Where the function is smooth on the scale of pixels, its mean over one follows from the values at the centres of its neighbours,

    mean = f + d2/24 - 17 d4/5760 + 367 d6/967680 - 27859 d8/464486400,    d2k the central differences,

one axis after the other: one evaluation a pixel, and none is passed over unseen. Twice the largest last term around is the
error. Where that is too much, the pixel is cut into quarters until Gauss-Legendre rules of 4 x 4 and 6 x 6 nodes agree in each of
them: twice checked, and what has jumps or a pole is narrowed down. A cell left unresolved brings its area times its range into the
error.
Features smaller than a pixel that no centre meets cannot be seen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS

PAD = 4
TERMS = (1 / 24, -17 / 5760, 367 / 967680, -27859 / 464486400)
BLOCK = 1 << 16
CELLS = 48
"""Unresolved cells of one pixel, at most: an edge through it is followed to about 1/50 of its width, a pole much further."""

LEVELS = 24

Evaluate = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Places x, y (n,) on the film [pixels] -> values and errors (n, channels)."""


@dataclass(frozen=True)
class Means:
    """Means over pixels and their errors, (rows, columns, channels) each, and how often the function was evaluated."""

    value: np.ndarray
    error: np.ndarray
    evaluations: int


def pixel_means(
    evaluate: Evaluate, window: tuple[int, int, int, int], channels: int, tolerance: float, most: int
) -> Means:
    """Return the mean over each pixel of a window (x, y, width, height).

    tolerance  relative to the pixel, or to a millionth of the brightest
    most       evaluations for pixels that are cut, about; what is left unresolved stands in the error
    """
    x0, y0, width, height = window
    values, errors = _centres(evaluate, (x0 - PAD, y0 - PAD, width + 2 * PAD, height + 2 * PAD), channels)
    mean, last = values, np.zeros_like(values)
    with np.errstate(all="ignore"):
        for axis in (0, 1):
            mean, remainder = _along(mean, axis)
            last = (np.abs(last[PAD:-PAD]) if axis == 0 else np.abs(last[:, PAD:-PAD])) + np.abs(remainder)
        error = 2 * _largest_around(last) + _largest_around(errors[PAD:-PAD, PAD:-PAD])
        centre = values[PAD:-PAD, PAD:-PAD]
        error = error + 8 * EPS * _largest_around(np.abs(centre))
        floor = 1e-6 * np.max(np.abs(centre[np.isfinite(centre)]), initial=0.0)
        allowed = tolerance * np.maximum(np.abs(mean), floor)
        own = 2 * _largest_around(last)
        bad = ~((own <= allowed) & np.isfinite(mean)).all(axis=2)
    spent = values.size // channels
    rows, columns = np.nonzero(bad)
    if len(rows):
        fine, off, more = _cut(evaluate, columns + x0, rows + y0, channels, tolerance, floor, most)
        mean[rows, columns], error[rows, columns] = fine, off
        spent += more
    return Means(np.ascontiguousarray(mean), np.ascontiguousarray(error), spent)


def _centres(evaluate: Evaluate, window: tuple[int, int, int, int], channels: int) -> tuple[np.ndarray, np.ndarray]:
    x0, y0, width, height = window
    value, error = np.empty((2, height, width, channels))
    step = max(1, BLOCK // width)
    for row in range(0, height, step):
        rows = np.arange(row, min(row + step, height))
        y, x = np.meshgrid(y0 + rows + 0.5, x0 + np.arange(width) + 0.5, indexing="ij")
        found = evaluate(x.ravel(), y.ravel())
        value[rows], error[rows] = (part.reshape(*y.shape, channels) for part in found)
    return value, error


def _along(f: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Return means along one axis, shorter by PAD at each end, and the last term of the expansion."""
    f = np.moveaxis(f, axis, 0)
    difference, total = f, f[PAD:-PAD].copy()
    term = total
    for k, factor in enumerate(TERMS, start=1):
        difference = difference[2:] - 2 * difference[1:-1] + difference[:-2]
        inner = difference[PAD - k : len(difference) - (PAD - k)]
        term = factor * inner
        total += term
    return np.moveaxis(total, 0, axis), np.moveaxis(term, 0, axis)


def _largest_around(x: np.ndarray) -> np.ndarray:
    """Return the largest value of each pixel and its eight neighbours."""
    rows = np.pad(x, ((1, 1), (1, 1), (0, 0)), mode="edge")
    rows = np.maximum(np.maximum(rows[:-2], rows[1:-1]), rows[2:])
    return np.maximum(np.maximum(rows[:, :-2], rows[:, 1:-1]), rows[:, 2:])


def _rule(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the nodes x, y and weights of the tensor rule on the unit square."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    x, y = np.meshgrid(0.5 * (nodes + 1), 0.5 * (nodes + 1))
    return x.ravel(), y.ravel(), 0.25 * np.outer(weights, weights).ravel()


def _cut(
    evaluate: Evaluate, x: np.ndarray, y: np.ndarray, channels: int, tolerance: float, floor: float, most: int
) -> tuple[np.ndarray, np.ndarray, int]:
    """Return means (p, channels) and errors over unit squares at corners x, y (p,), cut where they need it."""
    pixels, spent = len(x), 0
    value, error = np.zeros((2, pixels, channels))
    owner, corner, side = np.arange(pixels), np.stack([x, y], axis=1).astype(float), 1.0
    (ax, ay, aw), (bx, by, bw) = _rule(4), _rule(6)
    nx, ny, size = np.concatenate([ax, bx]), np.concatenate([ay, by]), len(aw)
    for level in range(LEVELS + 1):
        parts: list[tuple[np.ndarray, ...]] = []
        step = max(1, BLOCK // len(nx))
        for i in range(0, len(owner), step):
            at = corner[i : i + step]
            places = at[:, :1] + side * nx, at[:, 1:] + side * ny
            f, noise = (part.reshape(len(at), -1, channels) for part in evaluate(*(p.ravel() for p in places)))
            f = np.where(np.isfinite(f), f, 0.0)
            coarse, fine = (np.einsum("n,mnc->mc", w, g) for w, g in ((aw, f[:, :size]), (bw, f[:, size:])))
            span = f.max(axis=1) - f.min(axis=1)
            noise = np.einsum("n,mnc->mc", bw, np.where(np.isfinite(noise[:, size:]), noise[:, size:], 0.0))
            parts.append((fine, np.abs(fine - coarse), span, noise))
        mean, gap, span, noise = (np.concatenate(column) for column in zip(*parts, strict=True))
        spent += len(owner) * len(nx)
        area = side * side
        known = value.copy()
        np.add.at(known, owner, area * mean)
        allowed = tolerance * np.maximum(np.abs(known), floor)[owner] * (0.25 if level else 1.0) * side
        open_ = np.any(area * gap > allowed, axis=1)
        crowded = np.asarray(np.bincount(owner, open_, pixels) > CELLS, bool)
        last = level == LEVELS or spent + 4 * int(open_.sum()) * len(nx) > most
        stop = np.full(len(owner), last) | np.take(crowded, owner)
        done = ~open_ | stop
        np.add.at(value, owner[done], area * mean[done])
        off = area * (np.where(open_[:, None], np.maximum(gap, 0.25 * span), gap) + noise)
        np.add.at(error, owner[done], off[done])
        left = ~done
        if not left.any():
            break
        side *= 0.5
        quarters = np.array([[0, 0], [side, 0], [0, side], [side, side]])
        owner = np.repeat(owner[left], 4)
        corner = (corner[left][:, None] + quarters).reshape(-1, 2)
    return value, error, spent
