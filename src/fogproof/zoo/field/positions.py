"""Bugs of positions: radii, areas, tables over the square."""

from __future__ import annotations

import numpy as np

from fogproof.domains import Ball, Interval, Triangle, UnitDisk, UnitSquare
from fogproof.zoo.bug import Bug, sampler_bug
from fogproof.zoo.laws import Array, Function, directions, hg, ones

H, W = 12, 20
TABLE = np.random.default_rng(5).gamma(2.0, 1.0, (H, W))
TABLE /= TABLE.sum()
FLAT = np.cumsum(TABLE.ravel())


def _table(u: Array) -> Array:
    j = np.minimum(np.searchsorted(FLAT, u[:, 0] * FLAT[-1], side="right"), H * W - 1)
    return np.stack([(j // W + u[:, 1]) / H, (j % W + u[:, 2]) / W], axis=-1)


def _looked_up(x: Array) -> Array:
    return TABLE[np.minimum((x[:, 0] * H).astype(int), H - 1), np.minimum((x[:, 1] * W).astype(int), W - 1)] * H * W


def _shifted(d: float) -> Function:
    return lambda x: _looked_up(np.stack([x[:, 0], (x[:, 1] + d / W) % 1], axis=-1))


POWERS = np.array([1.0, 3.0, 6.0, 2.0, 1.5, 4.0, 2.0, 5.0])


def _nearest(u: Array) -> Array:
    """A table for each of eight brackets of the first coordinate: that of the nearer end is taken, where the lower one is meant."""
    power = POWERS[np.rint(8 * u[:, 0]).astype(int) % 8]
    return np.stack([u[:, 0], u[:, 1] ** (1 / power)], axis=-1)


def _lower(x: Array) -> Array:
    power = POWERS[np.minimum((8 * x[:, 0]).astype(int), 7)]
    return power * x[:, 1] ** (power - 1)


def _torus(u: Array) -> Array:
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return 3 + r * np.cos(phi)


def _torus_pdf(x: Array) -> Array:
    return x / 3 * 2 / np.pi * np.sqrt(np.maximum(1 - (x - 3) ** 2, 0))


def _triangle(u: Array) -> Array:
    return np.where((u.sum(axis=1) > 1)[:, None], 1 - u, u)


def bugs() -> list[Bug]:
    """Return them."""
    return [
        sampler_bug(
            "ball with sqrt for the cube root",
            "Coollab#84",
            lambda u: directions(2 * u[:, 0] - 1, u[:, 1]) * np.sqrt(u[:, 2:]),
            lambda x: np.full(len(x), 0.75 / np.pi),
            ("missing Jacobian",),
            Ball(1.0),
            {"dimensions": 3},
        ),
        sampler_bug(
            "disk with r = u",
            "field",
            lambda u: u[:, :1] * directions(0 * u[:, 0], u[:, 1])[:, :2],
            lambda x: np.full(len(x), 1 / np.pi),
            ("missing Jacobian",),
            UnitDisk(),
        ),
        sampler_bug(
            "torus without its radius",
            "SKIRT9#281",
            _torus,
            _torus_pdf,
            ("missing Jacobian",),
            Interval(2, 4),
            {"dimensions": 2},
        ),
        sampler_bug(
            "map half a texel off", "pbrt-v3#62", _table, _shifted(0.5), ("shifted",), UnitSquare(), {"dimensions": 3}
        ),
        sampler_bug(
            "map a texel off", "openmc#1081", _table, _shifted(1.0), ("shifted",), UnitSquare(), {"dimensions": 3}
        ),
        sampler_bug(
            "map transposed",
            "field",
            lambda u: np.stack([u[:, 0], np.sqrt(u[:, 1])], axis=-1),
            lambda x: 2 * x[:, 0],
            ("swapped axes",),
            UnitSquare(),
        ),
        sampler_bug("nearest table for the lower one", "openmc#1821", _nearest, _lower, ("shifted",), UnitSquare()),
        sampler_bug(
            "area missing in the pdf of a mesh",
            "mitsuba3#42",
            _triangle,
            ones,
            ("normalisation", "wrong measure"),
            Triangle((0, 0), (1, 0), (0, 1)),
        ),
        sampler_bug(
            "disk's area missing",
            "field",
            lambda u: np.sqrt(u[:, :1]) * directions(0 * u[:, 0], u[:, 1])[:, :2],
            ones,
            ("normalisation", "wrong measure"),
            UnitDisk(),
        ),
        sampler_bug(
            "lobe's probability missing in the pdf",
            "GLSL-PathTracer#24",
            lambda u: np.where(u[:, 2:] < 0.5, hg(0.8)[0](u), hg(-0.3)[0](u)),
            lambda x: hg(0.8)[1](x) + hg(-0.3)[1](x),
            ("normalisation", "wrong measure"),
            options={"dimensions": 3},
        ),
        sampler_bug(
            "positions of 24 bits on a large source",
            "EGSnrc#10",
            lambda u: (np.floor(u * 2**24) + 0.5) / 2**24,
            ones,
            ("coarse numbers",),
            UnitSquare(),
        ),
    ]
