"""What a tracker must know of a medium beforehand: bounds of its extinction, constant along the ray or in blocks of space.

Kernels walk through the pieces of a bound with `begin` and `onward`; `piece` says where the current one ends, its control
extinction and its majorant. The control is what residual ratio tracking handles in closed form; elsewhere it is 0.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba.extending import overload

from fogproof.estimators.kernels.compiling import KERNEL_OPTIONS
from fogproof.estimators.kernels.data import BlockBound, RayBound
from fogproof.estimators.kernels.lattice import Line, advance, clip, enter, leaves


class Whole(NamedTuple):
    """The single piece of a ray bound; none is left once t >= stop."""

    t: float
    stop: float


def begin(bound: Any, line: Line, length: float) -> Any:
    """Return the first piece."""
    raise NotImplementedError("runs inside kernels only")


def piece(bound: Any, j: int, at: Any) -> Any:
    """Return the end of the piece that ray j is in [m], its control and its majorant [1/m]."""
    raise NotImplementedError("runs inside kernels only")


def onward(bound: Any, line: Line, at: Any) -> Any:
    """Return the next piece."""
    raise NotImplementedError("runs inside kernels only")


def _begin_ray(bound: Any, line: Line, length: float) -> Any:
    lower, upper = bound.lower, bound.upper
    start, stop = clip(lower[0], upper[0], line.ox, line.rx, 0.0, length)
    start, stop = clip(lower[1], upper[1], line.oy, line.ry, start, stop)
    start, stop = clip(lower[2], upper[2], line.oz, line.rz, start, stop)
    return Whole(start, stop)


def _piece_of_ray(bound: Any, j: int, at: Any) -> Any:
    return at.stop, bound.control[j], bound.majorant[j]


def _after_ray(bound: Any, line: Line, at: Any) -> Any:
    return Whole(at.stop, at.stop)


def _begin_blocks(bound: Any, line: Line, length: float) -> Any:
    return enter(bound.lattice, line, length)


def _piece_of_blocks(bound: Any, j: int, at: Any) -> Any:
    return leaves(at), bound.control[at.ix, at.iy, at.iz], bound.majorant[at.ix, at.iy, at.iz]


def _after_block(bound: Any, line: Line, at: Any) -> Any:
    return advance(bound.lattice, line, at)


_CHOICE = {
    RayBound: {begin: _begin_ray, piece: _piece_of_ray, onward: _after_ray},
    BlockBound: {begin: _begin_blocks, piece: _piece_of_blocks, onward: _after_block},
}
_INLINED = {"forceinline": True, **KERNEL_OPTIONS}


@overload(begin, jit_options=_INLINED)
def _choose_begin(bound: Any, line: Line, length: float) -> Any:
    return _CHOICE[bound.instance_class][begin]


@overload(piece, jit_options=_INLINED)
def _choose_piece(bound: Any, j: int, at: Any) -> Any:
    return _CHOICE[bound.instance_class][piece]


@overload(onward, jit_options=_INLINED)
def _choose_onward(bound: Any, line: Line, at: Any) -> Any:
    return _CHOICE[bound.instance_class][onward]
