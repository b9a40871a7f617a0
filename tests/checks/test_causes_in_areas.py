"""What people do wrong with points of squares, disks and balls is named."""

import numpy as np
import pytest
from laws_by_hand import TURN, about, even, hold

from fogproof import Ball, Triangle, UnitDisk, UnitSquare

N = 30_000
MORE = 80_000  # pin a power
SLANTLESS = Triangle((0, 0, 1), (0, 1, 1), (1, 0, 1))
CASES = {  # sampler, pdf, domain, dimensions; the cause and words of what explains it
    "a square without its root": (
        (lambda u: u, lambda x: 2 * x[:, 0], UnitSquare(), 2),
        "missing Jacobian",
        "square root",
    ),
    "a triangle without its root": (
        (
            lambda u: np.column_stack([1 + 3 * u[:, 0], 2 + u[:, 1] * (1 - u[:, 0])]),
            even(1.5),
            Triangle((1, 2), (4, 2), (1, 3)),
            2,
        ),
        "missing square root",
        "corner b is even",
    ),
    "a triangle in space without its root": (
        (lambda u: np.column_stack([u[:, 0], u[:, 1] * (1 - u[:, 0]), np.ones(len(u))]), even(0.5), SLANTLESS, 2),
        "missing square root",
        "corner c is even",
    ),
    "half a turn of a disk": (
        (lambda u: np.sqrt(u[:, :1]) * about(0 * u[:, 0], np.pi * u[:, 1])[:, :2], even(np.pi), UnitDisk(), 2),
        "skipped band",
        "azimuth over pi",
    ),
    "a ball's sine": (
        (
            lambda u: np.cbrt(u[:, :1]) * about(np.cos(np.pi * u[:, 1]), TURN * u[:, 2]),
            even(2 / 3 * TURN),
            Ball(),
            3,
        ),
        "missing Jacobian",
        "sine",
    ),
    "a ball's radius, off the origin": (
        (
            lambda u: [1, 2, 3] + u[:, :1] * about(2 * u[:, 1] - 1, TURN * u[:, 2]),
            even(2 / 3 * TURN),
            Ball(1, (1, 2, 3)),
            3,
        ),
        "missing Jacobian",
        "r^2 is missing",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_cause_is(name):
    hold(CASES[name], MORE if "r^2" in CASES[name][2] else N)
