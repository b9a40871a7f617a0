"""What goes wrong with points of a triangle: two uniforms without the square root that evens out their areas."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting
from fogproof.domains import Triangle

_LEAST = 1e-9  # of a triangle's height


def hypotheses(triangle: Triangle) -> Iterator[Hypothesis]:
    """Yield for each corner that its barycentric coordinate is even: strips across the triangle get as much as longer ones.

    The strip where that coordinate is b has the length 1 - b of the opposite side (Pharr, Jakob & Humphreys 2023, section 6.5.4).
    """
    corners = [np.asarray(corner, dtype=float) for corner in (triangle.a, triangle.b, triangle.c)]
    for name, corner, first, second in zip(
        "abc", corners, corners[1:] + corners[:1], corners[2:] + corners[:2], strict=True
    ):
        words = f"a square root is missing: the share of corner {name} is even, and so most points lie by it"
        yield Hypothesis("missing square root", words, partial(_even, corner, first, second))


def _even(corner: np.ndarray, first: np.ndarray, second: np.ndarray, setting: Setting, _: float) -> Density:
    side = second - first
    up = corner - first
    up = up - side * (up @ side) / (side @ side)

    def density(x: np.ndarray) -> np.ndarray:
        share = (x - first) @ up / (up @ up)
        return setting.p(x) / np.maximum(1 - share, _LEAST)

    return density
