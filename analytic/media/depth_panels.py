"""Panels of rays: each is summed up by its optical thickness and the radiance that its own source sends to its start.

Both come from the same 16 Gauss-Legendre nodes: the running integral of sigma_t gives tau at every node. A user's function may jump
where nobody says so; its panels are looked at on their edges too, and held to what one jump in a panel can cost (`jump_bound`).
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.arithmetic.jump_bound import INSIDE, of_a_jump
from fogproof.analytic.arithmetic.panel_rule import NODES, RUNNING, WEIGHTS

CUTS = np.concatenate([[0.0], NODES, [1.0]])
"""Where a panel may be cut beside a jump, as shares of its width."""

BESIDE, CROSSED = np.array([0.02, 0.1, 0.5, 0.9, 0.98]), np.array([0.2, 0.8, 1.0, 0.8, 0.2])
"""Places in a panel, as shares, and what of its width a jump may be moved over that crosses them, twice over."""


class Look(Protocol):
    """What gives sigma_t and the source on rays (p,) at distances (p, nodes), (p, nodes) or (p, nodes, channels).

    moved  (p, nodes, 3) added to the places [m]
    """

    def __call__(
        self, which: np.ndarray, t: np.ndarray, moved: np.ndarray | float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return both."""
        ...


class DepthPanels(NamedTuple):
    """Panels of all rays, (p,) or (p, channels) each; the errors are estimates for this panel.

    jumps   sum of |differences| between neighbouring nodes, of sigma_t and of the source, (p, 2) or (p, channels, 2)
    ends    their values at the first and the last node, (p, 2, 2) or (p, channels, 2, 2)
    hidden  least error of tau and of gain by what one jump in the panel would cost, (p, 2) or (p, channels, 2)
    cuts    where the panel is cut next, as shares of its width, (p, 2): the middle twice, or both sides of a jump
    """

    ray: np.ndarray
    start: np.ndarray
    width: np.ndarray
    tau: np.ndarray
    gain: np.ndarray
    tau_error: np.ndarray
    gain_error: np.ndarray
    jumps: np.ndarray
    ends: np.ndarray
    hidden: np.ndarray
    cuts: np.ndarray


def measured(
    look: Look, which: np.ndarray, start: np.ndarray, width: np.ndarray, reach: np.ndarray | None
) -> DepthPanels:
    """Return the panels; where the rays' reach from the origin of space is given [m], held to what one jump would cost."""
    t = start[:, None] + width[:, None] * NODES
    if reach is not None:  # the edges too, from inside by more than a place is rounded by
        inside = np.minimum(np.maximum(INSIDE * width, 8 * EPS * (reach[which] + start + width)), width * NODES[0] / 2)
        t = np.concatenate([(start + inside)[:, None], t, (start + width - inside)[:, None]], axis=1)
    every = np.stack([np.moveaxis(a, 1, -1) for a in look(which, t)], axis=-2)  # sigma_t and source, then nodes
    sigma, q = np.moveaxis(every if reach is None else every[..., 1:-1], -2, 0)
    scale = width.reshape(-1, *[1] * (sigma.ndim - 1))
    with np.errstate(under="ignore", over="ignore"):
        tau = (scale * (sigma * WEIGHTS)).sum(axis=-1)
        dimmed = np.exp(-scale * (sigma @ RUNNING.T)) * q
        gain = (scale * (dimmed * WEIGHTS)).sum(axis=-1)
    ends, none = every[..., [0, -1]], np.zeros_like(tau)
    steps = np.abs(np.diff(every, axis=-1))
    jumps, hidden, cuts = steps.sum(axis=-1), np.zeros(ends.shape[:-1]), np.full((len(which), 2), 0.5)
    if reach is not None:
        edges = ends.copy()
        with np.errstate(under="ignore", over="ignore"):
            before = inside.reshape(scale.shape) * ends[..., 0, :]  # optical depth between an edge and its place inside
            edges[..., 1, :] *= np.exp(-np.stack([before[..., 0], tau - before[..., 1]], axis=-1))
            hidden = scale * of_a_jump(np.stack([sigma, dimmed], axis=-2), edges)
        # The cuts of the one that changes at the same place everywhere, as a jump does.
        kinds = int(np.prod(jumps.shape[1:]))
        steps, total = steps.reshape(len(which), kinds, len(CUTS) - 1), jumps.reshape(len(which), kinds)
        lone = ((steps > total[..., None] / 2) | (total[..., None] == 0)).all(axis=1) & (total > 0).any(axis=-1)[
            :, None
        ]
        at = np.argmax(lone, axis=1)
        alone = lone.any(axis=1)[:, None] & (width[:, None] > 256 * EPS * (reach[which] + start + width)[:, None])
        cuts = np.where(alone, np.stack([CUTS[at], CUTS[at + 1]], axis=1), cuts)
    return DepthPanels(which, start, width, tau, gain, none, none, jumps, ends, hidden, cuts)


def joined(*parts: DepthPanels) -> DepthPanels:
    """Return the panels of all parts, in order along each ray."""
    together = DepthPanels(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    order = np.lexsort((together.start, together.ray))
    return DepthPanels(*(column[order] for column in together))


def with_jumps_beside(look: Look, panels: DepthPanels, origin: np.ndarray, direction: np.ndarray) -> DepthPanels:
    """Return the panels with the errors of places that are rounded across the ray, where a function may jump as well.

    A ray that meets a jump at an angle alpha meets it 1 / sin(alpha) times as far away as the place was moved by.
    """
    t = panels.start[:, None] + panels.width[:, None] * BESIDE
    at = np.abs(origin[panels.ray])[:, None] + np.abs(t[..., None] * direction[panels.ray][:, None])
    here = look(panels.ray, t)
    off = [np.zeros_like(panels.tau), np.zeros_like(panels.gain)]
    for axis in np.eye(3):
        for sign in (-2 * EPS, 2 * EPS):
            there = look(panels.ray, t, sign * at * axis)
            for total, new, old in zip(off, there, here, strict=True):
                total += np.tensordot(CROSSED, np.abs(new - old), axes=(0, 1))
    width = panels.width.reshape(-1, *[1] * (panels.tau.ndim - 1))
    return panels._replace(tau_error=panels.tau_error + width * off[0], gain_error=panels.gain_error + width * off[1])


def starts_of(rays: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return where each ray's panels begin in the sorted list, and how many it has."""
    number = np.bincount(rays, minlength=count)
    return np.minimum(np.cumsum(number) - number, max(len(rays) - 1, 0)), number
