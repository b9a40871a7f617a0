"""The extinction of a medium at a point, for kernels: each kind's plain data say how it is looked up.

`sigma_t(medium, channel, x, y, z)` becomes, when a kernel is compiled, the static method `extinction` of the type of `medium`.
Data have an axis for the channels even when they are grey, so that every kernel serves both.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba.extending import overload

from fogproof.estimators.kernels.compiling import KERNEL_OPTIONS


def sigma_t(medium: NamedTuple, channel: int, x: float, y: float, z: float) -> float:
    """Return the extinction at a point [1/m]; only inside kernels."""
    raise NotImplementedError("sigma_t runs inside kernels only")


@overload(sigma_t, jit_options={"forceinline": True, **KERNEL_OPTIONS})
def _choose(medium: Any, channel: int, x: float, y: float, z: float) -> Any:
    return medium.instance_class.extinction
