"""What a jump or a kink inside a panel can cost, from the panel's own nodes and its two edges.

A panel and its halves may agree on a wrong value: where a jump hides between the nodes next to a common edge, and for a kink at
one place in seven. What a function with one jump or kink cannot hide is that no polynomial follows it: the last Legendre
coefficients of the polynomial through the nodes stay as large as the first, or it misses the values at the edges.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legvander

from fogproof.analytic.arithmetic.panel_rule import NODES

_COEFFICIENTS = np.linalg.inv(legvander(2 * NODES - 1, len(NODES) - 1))
BEFORE, TAIL = _COEFFICIENTS[8:12], _COEFFICIENTS[12:]
"""(4, 16) times the nodes' values: Legendre coefficients 8 to 11 and 12 to 15 of the polynomial through them."""

INSIDE = 1e-9
"""How far inside its edges a panel is looked at, as a share of its width: a rounded place must not be on the other side."""

AT_EDGES = legvander(np.array([2 * INSIDE - 1, 1 - 2 * INSIDE]), len(NODES) - 1) @ _COEFFICIENTS
"""(2, 16) times the nodes' values: that polynomial there."""

PER_TAIL, PER_EDGE = 0.2, 0.0106
"""Error of the rule on [0, 1] for a given tail and for a given miss at an edge, twice the largest for a jump anywhere on it.

For kinks and square roots that is enough as well; the factor two is for what the smooth part has of its own.
"""


def of_a_jump(nodes: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return the error bound of the panel rule on [0, 1] for a smooth function plus at most one jump, kink or root.

    nodes  (..., 16) values at `NODES`
    edges  (..., 2) values at `INSIDE` and 1 - `INSIDE`

    Measured over all places of one jump: the bound is 1.8 to 40 times the error where the jump is between the nodes, at least
    twice the error where it is beyond them. For an analytic function the bound is far above the error.
    """
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        tail = np.sqrt(np.square(nodes @ TAIL.T).sum(axis=-1))
        missed = np.abs(edges - nodes @ AT_EDGES.T).sum(axis=-1)
        bound: np.ndarray = PER_TAIL * tail + PER_EDGE * missed
    return bound


def of_a_kink(nodes: np.ndarray) -> np.ndarray:
    """Return the error bound of the panel rule on [0, 1] for one kink between the nodes, and far less where there is none.

    nodes  (..., 16) values at `NODES`

    Four more coefficients of an analytic function are smaller by a factor: as often as it takes to reach those of degree 32,
    which are the first that the rule gets wrong, that factor is believed, less a reserve of four. At a kink it is one.
    """
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        before, tail = (np.sqrt(np.square(nodes @ rows.T).sum(axis=-1)) for rows in (BEFORE, TAIL))
        falls = np.divide(4 * tail, before, out=np.ones_like(tail), where=4 * tail < before)
        bound: np.ndarray = PER_TAIL * tail * falls**4
    return bound
