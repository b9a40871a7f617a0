"""Adaptive Gauss-Legendre quadrature of many integrals at once, with an error carried by the integrand itself.

A panel of 16 nodes is compared with its halves, which replace it; the difference is the error estimate, far above the error
of the halves where the integrand is smooth. Where it is too large the halves are halved again, those of all integrals together.

Where the integrand has a kink, halves and whole may agree on a wrong value; the Legendre coefficients then do not fall off, and
`of_a_kink` is the least error. Integrands that may jump anywhere are looked at on the edges of the panels too (`of_a_jump`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fogproof.analytic.arithmetic.budget import may_refine, of_bounded_variation
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.arithmetic.jump_bound import INSIDE, of_a_jump, of_a_kink
from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS

TOLERANCE = 1e-11
"""Relative error aimed at for each integral."""

ROUNDS = 40
PANELS = 1024
"""Most panels of one integral; what is left undone by then stands in the error."""

BLOCK = 2048
"""Panels evaluated at a time."""

SPARE = 64.0
"""Times as small as its share is what a jump would cost in a panel without one: halving a smooth one is cheap."""

WIDEST, FIRST = 4.0, 32
"""Width of the widest panel to begin with, if that needs no more than so many in a piece."""


class Panels(NamedTuple):
    """Parts of pieces, from `low` over `width` of their variable, (p,), with value and errors, (p, channels).

    variation  sum of |differences| between neighbouring nodes, (p, channels)
    hidden     least error by what one kink, or jump, in the panel would cost, (p, channels)
    """

    piece: np.ndarray
    low: np.ndarray
    width: np.ndarray
    value: np.ndarray
    noise: np.ndarray
    off: np.ndarray
    variation: np.ndarray
    hidden: np.ndarray


Look = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""(pieces (p,), places in their variable (p, nodes)) -> integrand and its error, (p, nodes, channels)."""


def integrate_panels(
    span: np.ndarray, look: Look, owner: np.ndarray, weight: np.ndarray, count: int, jumps: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integrals over the pieces of each owner and their estimated errors, (count, channels).

    span    (p,) length of each piece in its variable, which starts at 0
    look    the integrand
    owner   (p,) which of the `count` results a piece belongs to
    weight  (p,) of the pieces; what is missing to 1 counts as error
    jumps   whether the integrand may jump within pieces
    """
    # A length that has left binary64 gives no number, which the caller refuses by name.
    parts = np.where(np.isnan(span), 1, np.clip(np.ceil(span / WIDEST), 1, FIRST)).astype(int)
    piece = np.repeat(np.arange(len(span)), parts)
    width = span[piece] / parts[piece]
    step = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    panels = _evaluate(look, piece, step * width, width, jumps)
    done = Panels(*(x[:0] for x in panels))
    totals = np.zeros((count, panels.value.shape[1]))
    for turn in range(ROUNDS):
        if not len(panels.piece):
            break
        if turn and not may_refine():
            rough = of_bounded_variation(panels.width[:, None], panels.variation)
            panels = panels._replace(off=np.maximum(panels.off, rough))
            break
        half = panels.width / 2
        left = _evaluate(look, panels.piece, panels.low, half, jumps)
        right = _evaluate(look, panels.piece, panels.low + half, half, jumps)
        off = np.abs(left.value + right.value - panels.value) / 2
        sides = [side._replace(off=np.maximum(off, side.hidden)) for side in (left, right)]
        both = Panels(*(np.concatenate(x) for x in zip(*sides, strict=True)))
        done = Panels(*(np.concatenate(x) for x in zip(done, both, strict=True)))
        rays = owner[done.piece]
        number = np.bincount(rays, minlength=count)
        totals = np.zeros_like(totals)
        np.add.at(totals, rays, done.value)
        share = TOLERANCE / number[rays][:, None] * totals[rays]
        # Halves of a panel whose integrand is uncertain by more would not be more certain.
        bad = ((done.off > np.maximum(share, 4 * EPS * done.value)) & (done.off > 0.25 * done.noise)).any(axis=1)
        least = np.maximum(np.maximum(share / SPARE, 64 * EPS * done.value), 0.25 * done.noise)
        bad |= (done.hidden > least).any(axis=1)
        bad &= (number[rays] < PANELS) & (done.width > 1e-13 * (done.low + done.width))
        panels, done = Panels(*(x[bad] for x in done)), Panels(*(x[~bad] for x in done))
    panels = Panels(*(np.concatenate(x) for x in zip(done, panels, strict=True)))
    certain = weight[panels.piece][:, None]
    value, error = np.zeros_like(totals), np.zeros_like(totals)
    np.add.at(value, owner[panels.piece], certain * panels.value)
    np.add.at(error, owner[panels.piece], panels.off + panels.noise + (1 - certain) * panels.value)
    return value, error + 64 * EPS * value


def _evaluate(look: Look, piece: np.ndarray, low: np.ndarray, width: np.ndarray, jumps: bool) -> Panels:
    places = np.concatenate([[INSIDE], NODES, [1 - INSIDE]]) if jumps else NODES
    found = []
    for i in range(0, max(len(piece), 1), BLOCK):
        block = slice(i, i + BLOCK)
        f, noise = look(piece[block], low[block, None] + width[block, None] * places)
        scale, variation = width[block, None], np.abs(np.diff(f, axis=1)).sum(axis=1)
        edges = np.moveaxis(f[:, [0, -1]], 1, -1)
        if jumps:
            f, noise = f[:, 1:-1], noise[:, 1:-1]
        nodes = np.moveaxis(f, 1, -1)
        hidden = scale * (of_a_jump(nodes, edges) if jumps else of_a_kink(nodes))
        sums = (scale * np.einsum("k,pkc->pc", WEIGHTS, x) for x in (f, noise))
        found.append((*sums, variation, hidden))
    value, noise, variation, hidden = (np.concatenate(x) for x in zip(*found, strict=True))
    return Panels(piece, low, width, value, noise, np.zeros_like(value), variation, hidden)
