"""What goes wrong with a density that is a table: shifted by columns or rows, mirrored, transposed, without the areas of its rows.

A table of few cells jumps by much where it is shifted by one: whole cells of tables of up to 12 or of 16 columns are tried, and
small shares. On the sphere rows follow theta from +z, columns phi from +x, as in an environment map (Pharr, Jakob & Humphreys 2023,
section 12.5).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, of_points

_CELLS = (0.5, 1 / 3, 0.25, 0.2, 1 / 6, 0.125, 0.1, 1 / 12, 1 / 16)
_SMALL = (0.05, 0.02, 0.01, 0.003)
SHIFTS = tuple(sorted({sign * share for share in (*_CELLS, *_SMALL) for sign in (-1, 1)} - {-0.5}))
"""Shares of an axis that a table may be shifted round by: whole cells of small ones, and what lies between those of large ones."""

_ROWS = (2, 3, 4, 5, 6, 8, 10, 12)  # more are as good as a sine at every point


def of_directions(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to a table of directions by theta and phi."""
    for axis, name in enumerate("xy"):
        sign = np.where(np.arange(3) == axis, -1.0, 1.0)
        words = f"these samples fit the pdf with {name} mirrored"
        yield Hypothesis("sign convention", words, of_points(partial(np.multiply, sign)))
    yield Hypothesis(
        "rotated frame",
        "these samples fit the pdf turned about z by {value} of a turn, as a table shifted by columns is",
        lambda s, d: lambda x: s.p(_placed(*_rolled(x, 0.0, d))),
        SHIFTS,
        null=0.0,
    )
    yield Hypothesis(
        "shifted",
        "these samples fit the pdf shifted round by {value} of pi in theta, as a table shifted by rows is",
        lambda s, d: lambda x: s.p(_placed(*_rolled(x, d, 0.0))),
        SHIFTS,
        null=0.0,
    )
    for weight in (lambda x, y: 1.0, lambda x, y: _sine(y) / _sine(x)):
        words = "these samples fit the pdf with theta / pi and phi / (2 pi) swapped: its table is transposed"
        yield Hypothesis("swapped axes", words, partial(_transposed, weight))
    for rows in _ROWS:
        words = f"a sine is missing: the weight of each of {rows} rows leaves out its area"
        yield Hypothesis("missing Jacobian", words, partial(_of_rows, rows, -1))
        words = f"these samples have a sine too many: the area of each of {rows} rows counts twice"
        yield Hypothesis("missing Jacobian", words, partial(_of_rows, rows, 1))


def _angles(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return theta / pi and phi / (2 pi), (n,) each, of directions (n, 3)."""
    theta = np.arctan2(np.hypot(x[:, 0], x[:, 1]), x[:, 2]) / np.pi
    return theta, np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) % 1.0


def _placed(theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return the directions of theta / pi and phi / (2 pi)."""
    t, f = np.pi * theta, 2 * np.pi * phi
    return np.stack([np.sin(t) * np.cos(f), np.sin(t) * np.sin(f), np.cos(t)], axis=-1)


def _rolled(x: np.ndarray, rows: float, columns: float) -> tuple[np.ndarray, np.ndarray]:
    theta, phi = _angles(x)
    return (theta - rows) % 1.0 if rows else theta, (phi - columns) % 1.0


def _transposed(
    weight: Callable[[np.ndarray, np.ndarray], np.ndarray | float], setting: Setting, _: float
) -> Callable[[np.ndarray], np.ndarray]:
    def density(x: np.ndarray) -> np.ndarray:
        y = _placed(*_angles(x)[::-1])
        return setting.p(y) * weight(x, y)

    return density


def _of_rows(rows: int, power: int, setting: Setting, _: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return the density that has a power too many of the sine in the middle of each row, to which its area is proportional."""

    def density(x: np.ndarray) -> np.ndarray:
        row = np.minimum((_angles(x)[0] * rows).astype(np.intp), rows - 1)
        return setting.p(x) * np.sin(np.pi * (row + 0.5) / rows) ** float(power)

    return density


def _sine(x: np.ndarray) -> np.ndarray:
    return np.asarray(np.maximum(np.hypot(x[:, 0], x[:, 1]), 1e-12))
