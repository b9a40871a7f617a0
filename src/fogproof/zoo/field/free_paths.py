"""Bugs of free paths, distances and exponentials."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import HalfLine, Interval, RealLine
from fogproof.zoo.bug import Bug, sampler_bug
from fogproof.zoo.laws import Array, ones

SIGMA = 1.4
EXP = lambda t: SIGMA * np.exp(-SIGMA * t)  # noqa: E731
LINE: dict[str, Any] = {"domain": HalfLine(0), "options": {"dimensions": 1}}


def _path(u: Array, sigma: Any = SIGMA) -> Array:
    return -np.log1p(-u) / sigma


def _channel(u: Array) -> Draw:
    sigma = np.array([0.5, 1.5])
    chosen = (u[:, 1] < 0.5).astype(int)
    t = _path(u[:, 0], sigma[chosen])
    return Draw(t, pdf=sigma[chosen] * np.exp(-sigma[chosen] * t))


def _channels(t: Array) -> Array:
    return 0.5 * (0.5 * np.exp(-0.5 * t) + 1.5 * np.exp(-1.5 * t))


def _clamped_majorant(rng: np.random.Generator, n: int) -> Array:
    """Delta tracking with the larger of two coefficients as majorant: probabilities above 1 are taken for 1."""
    t, alive = np.zeros(n), np.ones(n, dtype=bool)
    while alive.any():
        t[alive] += rng.exponential(1 / 0.7, int(alive.sum()))
        alive[alive] = rng.random(int(alive.sum())) >= min(SIGMA / 0.7, 1.0)
    return t


def _empty_start(u: Array) -> Array:
    return np.where(u[:, 0] == 0, 0.0, 1 + _path(u[:, 0]))


def _reused(u: Array) -> Array:
    k = np.where(u[:, 0] < 0.3, 0, 1)
    low = np.array([0.0, 0.3 - 1e-4])[k]
    return np.sqrt(1 - (u[:, 0] - low) / np.array([0.3, 0.7 - 1e-4])[k])


def _ziggurat(u: Array) -> Array:
    """The bottom layer is one step too low: what lies between is drawn from the tail's side of it."""
    t = -np.log1p(-u[:, 0])
    return np.where((t > 1.2) & (t < 1.3), t - 0.07, t)


def _absorbed(u: Array) -> Draw:
    t = _path(u[:, 0])
    return Draw(t, weight=np.where(t < 1, 1.0, 2.0))


def _squared(u: Array) -> Draw:
    x = u[:, 0]
    return Draw(x, weight=(2 * x) ** 2)


def _first_channel(u: Array) -> Draw:
    t = _path(u[:, 0], 1.0)
    return Draw(t, weight=np.stack([np.ones(len(t)), np.ones(len(t))], axis=-1))


def _roulette(u: Array) -> Draw:
    q = np.where(u[:, 1] < 0.01, 0.0, 0.5)
    with np.errstate(divide="ignore"):
        return Draw(u[:, 0], weight=1 / q)


def _over_weight(u: Array) -> Draw:
    w = np.where(u[:, 1] < 0.01, 0.0, 1.0)
    with np.errstate(divide="ignore"):
        return Draw(u[:, 0], pdf=1 / w)


def bugs() -> list[Bug]:
    """Return them."""
    return [
        sampler_bug(
            "t |d| for t / |d|",
            "pbrt-v3#159",
            lambda u: 2 * _path(u[:, 0], 2 * SIGMA) * 2,
            EXP,
            ("wrong scale",),
            **LINE,
        ),
        sampler_bug(
            "decimal logarithm",
            "raytracing-in-one-weekend#3",
            lambda u: _path(u[:, 0]) / np.log(10),
            EXP,
            ("wrong scale",),
            **LINE,
        ),
        sampler_bug(
            "pdf of the chosen channel alone",
            "mitsuba2#323",
            _channel,
            _channels,
            ("wrong pdf returned",),
            HalfLine(0),
            {"dimensions": 2},
        ),
        sampler_bug(
            "all channels weighted as the first",
            "pbrt-v4#83",
            _first_channel,
            lambda t: np.exp(-t),
            ("wrong weight",),
            HalfLine(0),
            {
                "dimensions": 1,
                "eval": lambda t: np.stack([np.exp(-t), 2 * np.exp(-2 * t)], axis=-1),
                "albedo": (1.0, 1.0),
            },
        ),
        sampler_bug(
            "majorant max instead of sum",
            "pbrt-v4#189",
            _clamped_majorant,
            EXP,
            ("wrong scale",),
            HalfLine(0),
            {"dimensions": None},
        ),
        sampler_bug(
            "log of 0", "EGSnrc#232", lambda u: -np.log(u[:, 0]) / SIGMA, EXP, ("edge of the uniforms",), **LINE
        ),
        sampler_bug(
            "u = 0 scatters in the vacuum before the grid",
            "SKIRT9#132",
            _empty_start,
            lambda t: np.where(t >= 1, SIGMA * np.exp(-SIGMA * (np.maximum(t, 1) - 1)), 0.0),
            ("edge of the uniforms",),
            **LINE,
        ),
        sampler_bug(
            "negative length near grazing incidence",
            "chunky#1862",
            lambda u: _path(u[:, 0]) - 1e-4,
            EXP,
            ("outside the domain",),
            **LINE,
        ),
        sampler_bug(
            "reused number leaves [0, 1]",
            "nori#32",
            _reused,
            lambda x: 2 * x,
            ("not a number", "outside the domain"),
            Interval(0, 1),
            {"dimensions": 1},
        ),
        sampler_bug(
            "one branch not divided by its probability",
            "Graphics#5754",
            _absorbed,
            EXP,
            ("wrong weight",),
            HalfLine(0),
            {"dimensions": 1, "eval": EXP, "albedo": 1.0},
        ),
        sampler_bug(
            "weight applied twice",
            "mcx#212",
            _squared,
            ones,
            ("wrong weight",),
            Interval(0, 1),
            {"dimensions": 1, "eval": lambda x: 2 * x, "albedo": 1.0},
        ),
        sampler_bug(
            "guided distance, pdf of the classical one",
            "appleseed#2027",
            lambda u: _path(u[:, 0], 0.6),
            EXP,
            ("wrong scale",),
            **LINE,
        ),
        sampler_bug(
            "survival probability 0",
            "Moer#77",
            _roulette,
            ones,
            ("not a number",),
            Interval(0, 1),
            {"dimensions": 2, "albedo": 1.0},
        ),
        sampler_bug(
            "pdf divided by a weight of 0",
            "appleseed#1324",
            _over_weight,
            ones,
            ("not a number", "wrong pdf returned"),
            Interval(0, 1),
            {"dimensions": 2},
        ),
        sampler_bug(
            "logistic of u = 0",
            "jax#3043",
            lambda u: np.log(u[:, 0] / (1 - u[:, 0])),
            lambda x: np.exp(-np.abs(x)) / (1 + np.exp(-np.abs(x))) ** 2,
            ("edge of the uniforms", "outside the domain"),
            RealLine(),
            {"dimensions": 1},
        ),
        sampler_bug(
            "exponential of 23-bit numbers",
            "jax#26974",
            lambda u: -np.log((np.floor(u[:, 0] * 2**23) + 1) / 2**23),
            lambda t: np.exp(-t),
            ("coarse numbers",),
            **LINE,
        ),
        sampler_bug(
            "one layer of a ziggurat off",
            "rust#10099",
            _ziggurat,
            lambda t: np.exp(-t),
            ("displaced stretch", "skipped band", "wrong layer"),
            **LINE,
        ),
    ]
