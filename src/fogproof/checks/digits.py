"""How many digits a program's numbers have: "%g" prints six, and looks wrong to who reads seventeen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

_LOOK = 200  # numbers that tell
_COUNTS = range(3, 11)  # of digits; fewer explain anything, and more are those of double precision for all that shows
_FEWEST = 3  # numbers, and different ones: two may be round by chance
_SPARE = 2.0  # times what rounding explains: a slope is not the same on both sides


@dataclass(frozen=True)
class Digits:
    """What rounding to a few digits may do to a number x: `relative` |x| + `absolute`."""

    relative: float
    absolute: float
    words: str

    def step(self, values: np.ndarray) -> np.ndarray:
        """Return how far each number may be from what it was."""
        return self.relative * np.abs(values) + self.absolute


def digits_of(numbers: np.ndarray) -> Digits | None:
    """Return how few digits all of some numbers have; None if they have those of double precision, or there are too few to tell."""
    values = np.ravel(numbers)[:_LOOK]
    values = np.unique(values[np.isfinite(values) & (values != 0)])
    if len(values) < _FEWEST or np.array_equal(values, np.round(values)):  # whole numbers are no rounded ones
        return None
    with np.errstate(over="ignore"):
        half, single = (np.array_equal(values, values.astype(kind)) for kind in (np.float16, np.float32))
    if half:
        return Digits(2.0**-11, 0.0, "all are of half precision: compute in more")
    if single:
        return Digits(2.0**-24, 0.0, 'all are of single precision: say precision = "float32"')
    fix = 'print seventeen, as %.17g does, or say precision = "float32" if they are of single precision'
    told = values.tolist()
    for count in _COUNTS:
        if all(float(f"{value:.{count}f}") == value for value in told):
            return Digits(0.0, 0.5 * 10.0**-count, f"no number has more than {count} decimals: {fix}")
        if count > _COUNTS[0] and all(float(f"{value:.{count - 1}e}") == value for value in told):
            return Digits(0.5 * 10.0 ** (1 - count), 0.0, f"no number has more than {count} digits: {fix}")
    return None


def rounded(
    f: Callable[[np.ndarray], np.ndarray], x: np.ndarray, got: np.ndarray, right: np.ndarray, shown: np.ndarray
) -> str:
    """Return in words that few digits alone make `got` differ from right = f(x) at all of the points x, "" if they do not.

    shown  all the points that there are, which tell how many digits coordinates have
    """
    of_points, of_values = digits_of(shown), digits_of(got)
    coarser = of_points or of_values
    if coarser is None:
        return ""
    allowed = np.zeros(len(got)) if of_values is None else of_values.step(got)
    flat = x.reshape(len(x), -1)
    with np.errstate(all="ignore"):
        for axis in range(flat.shape[1] if of_points else 0):
            assert of_points is not None
            moved = []
            for sign in (-1, 1):
                copy = flat.copy()
                copy[:, axis] += sign * of_points.step(flat[:, axis])
                moved.append(np.abs(f(copy.reshape(x.shape)) - right))
            allowed = allowed + np.maximum(*moved)
        explained = np.abs(got - right) <= _SPARE * allowed
    return f"; {coarser.words}" if bool(np.all(explained)) else ""
