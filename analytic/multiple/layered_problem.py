"""What is asked of layers over a ground, how many nodes that takes, and what the error is; see `slab_by_doubling`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.multiple.layer_stacks import Below, LayerMedium
from fogproof.analytic.multiple.scattering_arguments import DEEPEST
from fogproof.analytic.multiple.slab_by_doubling import (
    ENOUGH_OF_PEAKED,
    LEVELS,
    MOMENTS,
    PEAKED,
    POWER,
    SAFETY,
    SURE,
    decays_slowly,
    levels_for,
    phase_moments,
)
from fogproof.scene.grounds import require_ground
from fogproof.scene.slab_layers import SlabLayer, require_layers

ENOUGH = 1e-12
"""Relative difference of two solutions with which the finer one is taken."""

THINNEST = 1e-200
"""Optical thickness below which a layer is left out; what it would have done counts as error."""


class Problem(NamedTuple):
    """The layers that are not empty, one at least, what is below, the optical thickness left out, and the levels of solutions.

    change  what phase functions whose first moments are off by their errors differ by, at most (moments,)
    slow    whether the moments of a layer that scatters, or of grains of the ground, fall so slowly that two solutions do not
            tell the error
    """

    layers: list[LayerMedium]
    below: Below
    left_out: float
    levels: tuple[int, ...]
    change: np.ndarray
    slow: bool


def problem_of(layers: Any, ground: Any, ground_emission: float, levels: tuple[int, ...] | None) -> Problem:
    """Return what is asked; the levels are chosen by the phase functions unless they are given."""
    layers = require_layers("layers", layers)
    if ground is not None:
        require_ground("ground", ground)
    seen = [one for one in layers if one.tau >= THINNEST] or [SlabLayer(THINNEST, 0.0)]
    moments, chosen = levels_for([one.phase for one in seen])
    if levels is not None:
        moments, chosen = [phase_moments(one.phase) for one in seen], levels
    data = [
        LayerMedium(one.albedo, min(one.tau, DEEPEST), one.phase, its.chi, one.emission)
        for one, its in zip(seen, moments, strict=True)
    ]
    left_out = sum(one.tau for one in layers if one.tau < THINNEST)
    grains = getattr(ground, "phase", None)
    known = [one.chi for one in data if one.albedo > 0] + ([phase_moments(grains).chi] if grains is not None else [])
    slow = chosen[-1] == LEVELS[-1] and any(map(decays_slowly, known))
    change = np.max([its.change for its in moments], axis=0)
    return Problem(data, Below(ground, ground_emission), left_out, chosen, change, slow)


def settled(
    solve: Callable[[int], np.ndarray], rounding: Callable[[int, np.ndarray], np.ndarray], problem: Problem
) -> tuple[np.ndarray, np.ndarray]:
    """Return the finest solution needed and its error: levels are gone through until two agree."""
    before: list[tuple[int, np.ndarray]] = []
    value = error = np.empty(0)
    for n in problem.levels:
        value = solve(n)
        if before:
            difference = np.abs(value - before[-1][1])
            noise = rounding(n, value)
            enough = ENOUGH_OF_PEAKED if n >= PEAKED[0] else ENOUGH
            done = bool(np.all(difference <= np.maximum(enough * np.abs(value), noise)))
            peak = max(abs(float(one.chi[MOMENTS * n])) for one in problem.layers)
            if problem.slow or (problem.levels[-1] > LEVELS[-1] and peak > SURE):
                difference = np.max([SAFETY * (m / n) ** POWER * np.abs(value - f) for m, f in before], axis=0)
            error = difference + noise + 2 * TINY
            if done:
                break
        before.append((n, value))
    return value, error


def collisions(data: list[LayerMedium]) -> float:
    """Return how many collisions a beam has at most, on average, for what errors of the phase function are worth."""
    return sum(one.albedo * min(one.tau, 1 / max(1 - one.albedo, EPS)) for one in data) + 1
