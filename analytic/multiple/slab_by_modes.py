"""Slabs of isotropic scattering by their modes: how many nodes it takes, and what the error is."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal

import numpy as np

from fogproof.analytic.arithmetic.double_double import divide, pair
from fogproof.analytic.arithmetic.error_free import EPS, TINY, exp_minus
from fogproof.analytic.multiple.scattering_arguments import DEEPEST, seen_at
from fogproof.analytic.multiple.slab_isotropic import (
    THIN,
    Slabs,
    View,
    absorbed,
    reflected,
    scattered_through,
    solve_slabs,
    unscattered,
    view_from,
)
from fogproof.analytic.multiple.slab_nodes import nodes_inside

SOURCE = "Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988"

Quantity = Literal["reflected", "transmitted", "absorbed"]
LEVELS = (16, 20, 28, 40, 56, 80, 112)
"""Half the number of nodes of a solution: the next ones are used where the last two differ."""

ENOUGH = 2e-13
"""Relative difference of two solutions with which the finer one is taken."""

ROUNDING = 32 * EPS
"""What rounding adds to the error, relative, and 4 eps for each factor e below 1."""

BLOCK = 65_536
"""Numbers in the matrices evaluated at a time: they stay in the cache."""


def isotropic_values(
    c: np.ndarray, tau: np.ndarray, mu0: np.ndarray | None, index: float, quantity: Quantity
) -> tuple[np.ndarray, np.ndarray]:
    """Return the quantity and its error for albedos, thicknesses and cosines (v,); for diffuse light if mu0 is None."""
    beam, whole = mu0, tau
    tau = np.minimum(tau, DEEPEST)
    if mu0 is not None and index == 1:  # behind a boundary no direction grazes inside
        mu0 = seen_at(mu0, tau)
    pairs, which = np.unique(np.stack([c, tau], axis=1), axis=0, return_inverse=True)
    which = which.reshape(len(c))
    value, error = np.zeros(c.shape), np.zeros(c.shape)
    todo = np.arange(len(c))
    with np.errstate(under="ignore", over="ignore"):
        before = _solution(pairs, which, mu0, index, quantity, todo, LEVELS[0])
        for _, n in pairwise(LEVELS):
            if not len(todo):
                break
            found = _solution(pairs, which, mu0, index, quantity, todo, n)
            value[todo] = found
            rounding = (ROUNDING + 4 * EPS * np.abs(np.log(np.clip(found, TINY, 1)))) * found
            difference = np.abs(found - before)
            error[todo] = difference + rounding + 2 * TINY
            if beam is not None:  # both so small that their quotient is lost where tau is raised to THIN
                error[todo] += (tau[todo] < THIN) & (beam[todo] < 1e16 * tau[todo])
            more = difference > ENOUGH * found + rounding
            todo, before = todo[more], found[more]
        if quantity == "transmitted" and beam is not None and index == 1:
            straight, its_error = exp_minus(*divide(pair(whole), pair(beam)))
            value, error = value + straight, error + its_error + EPS * (value + straight)
        if quantity == "absorbed":
            nothing = (c == 1) | (tau == 0)
            value, error = np.where(nothing, 0.0, value), np.where(nothing, 0.0, error)
        if quantity == "transmitted":
            thicker = np.maximum(whole, TINY)
            value, error = (
                np.where(whole > tau, value * (tau / thicker), value),
                np.where(whole > tau, error * (tau / thicker) + TINY, error),
            )
    return value, error


def _solution(
    pairs: np.ndarray,
    which: np.ndarray,
    mu0: np.ndarray | None,
    index: float,
    quantity: Quantity,
    todo: np.ndarray,
    n: int,
) -> np.ndarray:
    """Return what nodes of that number give for the elements `todo`; pairs alike in the nodes they need are solved together."""
    value = np.empty(len(todo))
    needed, mine = np.unique(which[todo], return_inverse=True)
    smallest = np.full(len(needed), 1.0)
    if mu0 is not None:
        np.minimum.at(smallest, mine, mu0[todo])
    tau = pairs[needed, 1]
    panels = np.ceil(-np.log(np.clip(np.minimum(tau, 10 * smallest) * 3, 1e-20, 1)) / math.log(6))
    for kind in np.unique(panels):
        alike = np.flatnonzero(panels == kind)
        nodes = nodes_inside(float(tau[alike].min()), float(smallest[alike].min()), n, index, float(tau[alike].max()))
        size = max(1, BLOCK // len(nodes.mu) ** 2)
        for start in range(0, len(alike), size):
            block = alike[start : start + size]
            position = np.full(len(needed), -1)
            position[block] = np.arange(len(block))
            here = np.flatnonzero(position[mine] >= 0)
            slabs = solve_slabs(pairs[needed[block], 0], tau[block], nodes, index)
            if mu0 is None:
                above = nodes.outside > 0
                seen = np.flatnonzero(above)
                b, m = len(block), len(seen)
                view = View(np.repeat(np.arange(b), m), np.tile(nodes.mu[seen], b), np.tile(nodes.outside[seen], b))
                value[here] = (_seen(slabs, view, quantity, True).reshape(b, m) @ nodes.sky[seen])[position[mine[here]]]
                continue
            step = max(1, BLOCK // len(nodes.mu))
            for first in range(0, len(here), step):
                some = here[first : first + step]
                view = view_from(position[mine[some]], mu0[todo[some]], index)
                value[some] = _seen(slabs, view, quantity, index > 1)
    return value


def _seen(slabs: Slabs, view: View, quantity: Quantity, straight: bool) -> np.ndarray:
    """Return the quantity for directions of view; what passes unscattered is part of it, or added later to more digits."""
    match quantity:
        case "reflected":
            return reflected(slabs, view)
        case "absorbed":
            return absorbed(slabs, view)
    return scattered_through(slabs, view) + (unscattered(slabs, view) if straight else 0.0)
