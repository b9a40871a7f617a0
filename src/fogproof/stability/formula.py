"""What is declared of a formula whose stability is measured: ours, the truth, a bound, hard regions, naive forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from fogproof.contracts import Reference

Precision = Literal["float64", "float32"]
BOTH: tuple[Precision, ...] = ("float64", "float32")
Values = Callable[[int, Any], np.ndarray]
"""(n, dtype) -> about n values of one argument, in ascending order."""

Evaluate = Callable[..., np.ndarray | Reference]
"""Arguments by name, arrays (n,) -> values (n,), of the oracle with their errors."""


@dataclass(frozen=True)
class HardRegion:
    """A grid of arguments: `axes` vary, at most two of them, the others are `fixed`.

    derived  what takes axes and fixed ones by name and returns the arguments instead, rounded as they are, such as the origin of a
             ray that comes from afar; None if they are the arguments themselves
    """

    name: str
    axes: dict[str, Values]
    fixed: dict[str, float] = field(default_factory=dict)
    derived: Callable[..., dict[str, np.ndarray]] | None = None

    def grid(self, n: int, precision: Precision) -> tuple[list[np.ndarray], dict[str, np.ndarray]]:
        """Return the values along each axis, and every argument at every point of the grid, (points,)."""
        dtype = np.dtype(precision)
        along = [np.asarray(values(n, dtype), dtype) for values in self.axes.values()]
        mesh = [part.ravel() for part in np.meshgrid(*along, indexing="ij")]
        arguments = dict(zip(self.axes, mesh, strict=True))
        arguments |= {name: np.full_like(mesh[0], value) for name, value in self.fixed.items()}
        return along, arguments if self.derived is None else self.derived(**arguments)


@dataclass(frozen=True)
class Naive:
    """The same number as others write it: in a lecture, a book, a renderer."""

    name: str
    source: str
    evaluate: Evaluate


@dataclass(frozen=True)
class Formula:
    """One formula of ours and what is known of it.

    name        theme/what
    title       what it is, in words
    of          the public name that it proves, as `analytic.transmittance` or `estimators.FreePath`
    ours        evaluates it in floating point
    truth       the same number for exact arguments (`flint.arb` each), by mathematics alone: nothing of ours
    bound       largest error in units of what half a unit in the last place of each argument and of the result can do;
                None for the oracle, whose answers state their own
    regions     where it is hard
    naive       other ways to write it, each of which fails in one of the regions
    precisions  of arguments and result
    size        points along an axis, as a share of what is usual: a truth that takes long has fewer
    condition   whether what the arguments do to the value is measured; errors are plain ulps where that takes too long
    """

    name: str
    title: str
    of: str
    ours: Evaluate
    truth: Callable[..., Any]
    regions: tuple[HardRegion, ...]
    bound: float | None = None
    naive: tuple[Naive, ...] = ()
    precisions: tuple[Precision, ...] = ("float64",)
    size: float = 1.0
    condition: bool = True
