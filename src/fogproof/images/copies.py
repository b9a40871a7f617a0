"""Are two renders one, stored twice? Independent ones differ by their noise; copies by what storing them rounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fogproof.errors import InvalidInputError
from fogproof.images.picture import RenderedImage

NEAR = 1e-5
"""Relative difference that sums in another order and numbers printed with few digits make."""

_FAR = 10.0
"""Times what storing rounds, beyond which a pixel differs from its neighbours by noise."""

_MOST = 0.99
"""Share of pixels that are as close as that; the rest may be no numbers."""

_HALF, _SINGLE = np.finfo(np.float16), np.finfo(np.float32)

_LAGS = (1, 2, 3, 4)
"""Pixels apart, of which the noise of one is opposed to that of the other, also under a filter a few pixels wide."""


def require_other_files(paths: Sequence[str | Path]) -> None:
    """Refuse one file that is given twice, by its name or by a link."""
    seen: dict[tuple[int, int], str | Path] = {}
    for path in paths:
        try:
            found = Path(path).stat()
        except (OSError, ValueError):  # told when it is read
            continue
        which_file = found.st_dev, found.st_ino
        first = seen.get(which_file)
        if first is not None:
            which = f"{first} is given twice" if str(first) == str(path) else f"{first} and {path} are one file"
            raise InvalidInputError(
                f"{which}: a render says nothing about itself; render again with another seed", str(path)
            )
        seen[which_file] = path


def distinct(picture: RenderedImage, smooth: np.ndarray | float) -> tuple[RenderedImage, tuple[str, ...]]:
    """Return a picture without renders that are nearly copies of earlier ones, and what is to be said of those.

    smooth  what the image would be without noise, as far as that is known
    """
    kept: list[int] = []
    said = []
    for n, one in enumerate(picture.renders):
        first = next((k for k in kept if nearly_copies(picture.renders[k], one, smooth)), None)
        if first is None:
            kept.append(n)
        else:
            said.append(
                f"{_name(picture, first)} and {_name(picture, n)} differ by rounding alone: they count as one render"
            )
    if not said:
        return picture, ()
    paths = tuple(picture.paths[n] for n in kept) if picture.paths else ()
    return replace(picture, renders=picture.renders[kept], paths=paths), tuple(said)


def one_render(first: RenderedImage, second: RenderedImage) -> str:
    """Return what is to be said of a render that stands on both sides, equal or stored another way; "" if there is none."""
    if first.renders.shape[1:] != second.renders.shape[1:]:
        return ""
    for i, one in enumerate(first.renders):
        for j, other in enumerate(second.renders):
            equal = np.array_equal(one, other, equal_nan=True) and has_noise(one, 0.0, _bound(one, one, _SINGLE))
            if equal or nearly_copies(one, other):
                how = "are the same pixel by pixel" if equal else "differ by rounding alone"
                what = f"{_name(first, i)} and {_name(second, j)} {how}, though each has noise: one render, or one seed"
                return f"{what}, which says nothing of either; render with another seed"
    return ""


def nearly_copies(one: np.ndarray, other: np.ndarray, smooth: np.ndarray | float = 0.0) -> bool:
    """Return whether two renders (rows, columns, channels) differ, by far less than their noise.

    Equal ones do not differ: whether they have noise at all is for others to say.
    """
    thin = (slice(None, None, max(1, one.shape[0] // 32)), slice(None, None, max(1, one.shape[1] // 32)))
    return _close(one[thin], other[thin], _HALF) and _copies(one, other, smooth)


def _copies(one: np.ndarray, other: np.ndarray, smooth: np.ndarray | float) -> bool:
    step = max((_stored(one), _stored(other)), key=lambda kind: kind.eps)
    bound = _bound(one, other, step)
    return bool(np.any(one != other)) and _close(one, other, step) and has_noise(one, smooth, bound)


def _close(one: np.ndarray, other: np.ndarray, kind: np.finfo) -> bool:
    with np.errstate(invalid="ignore"):
        gap = np.where(one == other, 0.0, np.abs(one - other))  # infinities are equal, too
    return bool(np.mean(gap <= _bound(one, other, kind)) >= _MOST)


def _bound(one: np.ndarray, other: np.ndarray, kind: np.finfo) -> np.ndarray:
    """Return what storing may change: a unit in the last place, since writers of half floats may cut them off."""
    largest = np.maximum(np.abs(one), np.abs(other))
    return np.asarray(max(NEAR, float(kind.eps)) * largest + float(kind.smallest_subnormal))


def has_noise(one: np.ndarray, smooth: np.ndarray | float, bound: np.ndarray) -> bool:
    """Return whether neighbouring pixels differ by much more than `bound`, and at random.

    What is smooth bends the same way from pixel to pixel, and an edge is seldom; noise differs from its neighbours in most pixels
    that are not black, as often one way as the other.
    """
    rough = _crossed(np.where(np.isfinite(one), one, 0.0) - smooth)
    lit = _largest(bound) > 0
    far = lit & (np.abs(rough) > _FAR * _largest(bound))
    if np.count_nonzero(far) < max(30, 0.25 * np.count_nonzero(lit)):
        return False
    return any(_opposed(rough, far, lag) for lag in _LAGS if lag < rough.shape[1])


def _opposed(rough: np.ndarray, far: np.ndarray, lag: int) -> bool:
    """Return whether of pixels so far apart significantly more than half are opposed, as of noise two thirds are."""
    both = far[:, lag:] & far[:, :-lag]
    count = np.count_nonzero(both)
    opposed = np.count_nonzero(both & (rough[:, lag:] * rough[:, :-lag] < 0))
    return bool(count >= 30 and opposed > 0.5 * count + 1.5 * np.sqrt(count))


def _crossed(x: np.ndarray) -> np.ndarray:
    """Return the difference of differences of four pixels around each corner: nothing where an image is a plane."""
    return np.asarray(x[1:, 1:] - x[1:, :-1] - x[:-1, 1:] + x[:-1, :-1])


def _largest(x: np.ndarray) -> np.ndarray:
    return np.asarray(np.maximum.reduce([x[1:, 1:], x[1:, :-1], x[:-1, 1:], x[:-1, :-1]]))


def _stored(value: np.ndarray) -> np.finfo:
    """Return the coarsest of the usual kinds of numbers that holds all values."""
    with np.errstate(over="ignore"):
        return _HALF if np.array_equal(value.astype(np.float16), value, equal_nan=True) else _SINGLE


def _name(picture: RenderedImage, n: int) -> str:
    return picture.paths[n] if picture.paths else f"render {n + 1}"
