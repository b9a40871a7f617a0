"""Many points, some at a time: what a formula needs for each of them beside the answer is in memory for a block of them only."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def in_blocks(formula: Callable[..., tuple[np.ndarray, ...]], size: int, *points: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the arrays that a formula gives at points that broadcast, (...) -> (..., more) each, `size` of them at a time.

    formula  takes one array (v,) for each of `points` and returns arrays (v, more); it is called once where there are no points

    Example:
        >>> import numpy as np
        >>> def power(x, n):
        ...     return (x**n,)
        >>> in_blocks(power, 2, np.array([1.0, 2.0, 3.0]), np.array(2))[0].tolist()
        [1.0, 4.0, 9.0]
    """
    wide = np.broadcast_arrays(*points)
    shape, flat = wide[0].shape, [array.reshape(-1) for array in wide]
    found = [formula(*(array[i : i + size] for array in flat)) for i in range(0, max(flat[0].size, 1), size)]
    columns = [np.concatenate(column) for column in zip(*found, strict=True)]
    return tuple(column.reshape((*shape, *column.shape[1:])) for column in columns)
