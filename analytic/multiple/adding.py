"""Layers of different kinds on one another, and a ground below them: the adding method.

All is held as in `doubling`. A stack of different layers is no longer the same from above and from below, but by reciprocity what
passes upwards is the transpose of what passes downwards, and both reflections are symmetric. Light between two stacks goes to
and fro by (1 - R_below R)^-1, of which energy tells the image of one vector from either side: its largest error, where little is
absorbed, is taken out by that.
Source: van de Hulst 1980, Multiple Light Scattering, section 4.3; de Haan, Bosma & Hovenier 1987.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fogproof.analytic.multiple.doubling import Layer


class Stack(NamedTuple):
    """Layers (b,) between n directions, lit from above and from below.

    R, below       (b, n, n) reflection of light from above, from below
    T              (b, n, n) diffuse transmission downwards; upwards it is the transpose
    ray            (b, n) straight transmission
    lost, lost_up  (b, n, s) share absorbed of light from above, from below, times W^(1/2): in the first column all of it, in the
                   others what is absorbed where counts by a weight. With L_e for a weight it is, by reciprocity, what is emitted
    """

    R: np.ndarray
    below: np.ndarray
    T: np.ndarray
    ray: np.ndarray
    lost: np.ndarray
    lost_up: np.ndarray


class Meeting(NamedTuple):
    """What passes the face between two stacks, downwards and upwards, when light comes from above; (b, n, n) each.

    Downwards it is what has been scattered: the straight beam comes on top of it.
    """

    down: np.ndarray
    up: np.ndarray


def stack_of(layer: Layer, absorbed: np.ndarray, weights: np.ndarray) -> Stack:
    """Return a single layer, of 1 - albedo = absorbed (b,); what it absorbs counts by weights (s,), the first of which is 1."""
    lost = (absorbed[:, None] * layer.glow)[..., None] * weights
    return Stack(layer.R, layer.R, layer.T, layer.ray, lost, lost)


def vacuum(batch: int, n: int, weights: int) -> Stack:
    """Return what changes nothing."""
    nothing, dark = np.zeros((batch, n, n)), np.zeros((batch, n, weights))
    return Stack(nothing, nothing, nothing, np.ones((batch, n)), dark, dark)


def opaque(R: np.ndarray, lost: np.ndarray) -> Stack:
    """Return a ground of reflection R (b, n, n) that absorbs lost (b, n, s)."""
    nothing = np.zeros_like(R)
    return Stack(R, nothing, nothing, np.zeros(lost.shape[:-1]), lost, np.zeros_like(lost))


def between(upper: Stack, lower: Stack, root: np.ndarray, balanced: np.ndarray) -> Meeting:
    """Return what passes the face between two stacks.

    root      (n,) W^(1/2)
    balanced  (b,) whether all that is not absorbed is scattered: the mean over azimuth, not a higher mode
    """
    to_and_fro = _to_and_fro(upper, lower, root, balanced)
    again = to_and_fro @ (upper.below @ lower.R)
    down = again * upper.ray[:, None, :] + to_and_fro @ upper.T
    return Meeting(down, lower.R * upper.ray[:, None, :] + lower.R @ down)


def added(upper: Stack, lower: Stack, root: np.ndarray, balanced: np.ndarray) -> Stack:
    """Return one stack on another; arguments as in `between`."""
    down, up = between(upper, lower, root, balanced)
    climbing, falling = between(_upside_down(lower), _upside_down(upper), root, balanced)
    through, above = lower.ray[..., None], upper.ray[..., None]
    lit = _turned(down) @ lower.lost + above * lower.lost + _turned(up) @ upper.lost_up
    lit_up = _turned(climbing) @ upper.lost_up + through * upper.lost_up + _turned(falling) @ lower.lost
    return Stack(
        _symmetric(upper.R + above * up + _turned(upper.T) @ up),
        _symmetric(lower.below + through * falling + lower.T @ falling),
        through * down + lower.T * upper.ray[:, None, :] + lower.T @ down,
        upper.ray * lower.ray,
        upper.lost + lit,
        lower.lost_up + lit_up,
    )


def _upside_down(stack: Stack) -> Stack:
    return Stack(stack.below, stack.R, _turned(stack.T), stack.ray, stack.lost_up, stack.lost)


def _to_and_fro(upper: Stack, lower: Stack, root: np.ndarray, balanced: np.ndarray) -> np.ndarray:
    """Return (1 - R_below R)^-1."""
    inverse = np.linalg.inv(np.eye(len(root)) - upper.below @ lower.R)
    if not np.any(balanced):
        return inverse
    # (1 - R) root: what is not reflected passes or is lost. All of it is positive.
    above = upper.ray * root + _apply(upper.T, root) + upper.lost_up[..., 0]
    under = lower.ray * root + _apply(_turned(lower.T), root) + lower.lost[..., 0]
    rest = root - _apply(inverse, above + _apply(upper.below, under))
    other = root - _apply(_turned(inverse), under + _apply(lower.R, above))
    along = np.sum(other * (above + _apply(upper.below, under)), axis=-1)
    size = np.linalg.norm(other, axis=-1) * np.linalg.norm(above + _apply(upper.below, under), axis=-1)
    clear = balanced & (np.abs(along) > 0.1 * size)
    scaled = other / np.where(clear, along, np.inf)[:, None]
    return inverse + rest[..., None] * scaled[:, None, :]


def _apply(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    return (matrix @ vector[..., None])[..., 0]


def _turned(matrix: np.ndarray) -> np.ndarray:
    return np.swapaxes(matrix, -1, -2)


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return (matrix + _turned(matrix)) / 2
