"""How often nested adaptive quadrature may look at a medium: counted places, never seconds, so that every run stops alike.

Quadrature inside quadrature multiplies: a jump that a ray finds in fifty halvings is looked for anew by the optical thickness at
each node of each halving. Whoever nests opens a `budget`; `coefficients` counts what is looked at; whoever refines asks
`may_refine` before each round after the first, and widens the error of what it leaves undone by `of_bounded_variation`. What no
refinement asked for, for example the panels that a small `detail` needs, is refused at `REFUSED` times as many.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

import numpy as np

from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS
from fogproof.errors import UnsupportedError

PLACES = 2**23
"""Places a ray at which the medium is looked up until refinement ends; a smooth medium needs one part in a hundred."""

REFUSED = 8
"""Times as many places until the ray is refused."""

_BELOW, _ENDS = np.concatenate([[0.0], np.cumsum(WEIGHTS)]), np.concatenate([[0.0], NODES, [1.0]])
STEP = float(np.max(np.abs([_BELOW - _ENDS[:-1], _BELOW - _ENDS[1:]])))
"""By how much the panel rule is off at most for a unit step on [0, 1]: where a step is moved up to a node."""


@dataclass
class Budget:
    """Places that may be looked up in all, and those that have been."""

    places: int
    spent: int = 0


_open: ContextVar[Budget | None] = ContextVar("budget", default=None)


@contextmanager
def budget(rays: int) -> Iterator[Budget]:
    """Count what is looked at in the block against a budget for so many rays; inside another, that one stays."""
    outer = _open.get()
    own = outer or Budget(PLACES * max(rays, 1))
    token = _open.set(own)
    try:
        yield own
    finally:
        _open.reset(token)


def spend(places: int) -> None:
    """Count places that are about to be looked at, or refuse to go on."""
    own = _open.get()
    if own is None:
        return
    own.spent += places
    if own.spent > REFUSED * own.places:
        raise _refusal(f"the medium was looked up at {own.spent} places and quadrature is not done")


def afford(places: float) -> None:
    """Refuse a ray that needs more than `PLACES` before it is refined at all, before memory is taken for them."""
    if places > PLACES:
        raise _refusal(f"quadrature would have to look the medium up at {places:.3g} places of one ray")


def _refusal(what: str) -> UnsupportedError:
    help_ = "give it a larger `detail`, or its values as a VoxelGrid or PiecewiseConstantMedium"
    return UnsupportedError(f"{what}: {help_}", "medium")


def may_refine() -> bool:
    """Return whether there is anything left of the budget, if there is one."""
    own = _open.get()
    return own is None or own.spent < own.places


def of_bounded_variation(width: np.ndarray, variation: np.ndarray) -> np.ndarray:
    """Return the error bound of the panel rule on a panel of that width for an integrand of that total variation.

    Such a function is an integral of steps, and for none of these is the rule off by more than `STEP`.
    """
    bound: np.ndarray = STEP * width * variation
    return bound
