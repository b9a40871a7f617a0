"""A hierarchical majorant: bounds of the extinction in blocks of space, so that tracking hurries where little is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import AnyMedium, VoxelGrid
from fogproof.scene.media import box
from fogproof.validate import as_float_array, points, require


@dataclass(frozen=True, eq=False)
class MajorantGrid:
    """low <= sigma_t <= high in each of bx x by x bz equal blocks of a box; the medium has to end where the box does.

    high          (bx, by, bz) [1/m]
    lower, upper  (3,) corners of the box [m]
    low           0, or (bx, by, bz) [1/m]
    """

    high: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    low: np.ndarray = 0.0  # type: ignore[assignment]  # __post_init__ makes it an array

    def __post_init__(self) -> None:
        high, low = as_float_array("high", self.high), as_float_array("low", self.low)
        if high.ndim != 3 or high.size == 0:
            raise InvalidValueError("high", "must have one bound a block, (bx, by, bz)", list(high.shape))
        if low.ndim and low.shape != high.shape:
            raise InvalidValueError("low", f"must have the shape {list(high.shape)} of high", list(low.shape))
        low = np.broadcast_to(low, high.shape)
        require("high", high, np.isfinite(high), "must be finite [1/m]")
        require("low", low, (low >= 0) & (low <= high), "must lie in [0, high] [1/m]")
        for name, corner in (("lower", points("lower", self.lower)), ("upper", points("upper", self.upper))):
            if corner.ndim != 1:
                raise InvalidValueError(name, "must be one corner [x, y, z]", getattr(self, name))
            object.__setattr__(self, name, corner)
        require("upper", self.upper, self.upper > self.lower, f"must be above lower = {self.lower.tolist()}")
        for name, array in (("high", high), ("low", low)):
            array = array.copy()
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @staticmethod
    def of(grid: VoxelGrid, block: int) -> MajorantGrid:
        """Return the bounds of a grid, over all channels, in blocks of at most `block` voxels along each axis.

        Voxels that touch a block count as well: interpolation reaches them, and so may a rounded position.
        """
        if isinstance(block, bool) or not isinstance(block, int) or block < 1:
            raise InvalidValueError("block", "must be a whole number of voxels >= 1", block)
        channels = grid.sigma_t.reshape(*grid.sigma_t.shape[:3], -1)
        low, high = channels.min(axis=-1), channels.max(axis=-1)
        for axis in range(3):
            low, high = _blocks(low, block, axis, np.minimum), _blocks(high, block, axis, np.maximum)
        return MajorantGrid(high, grid.lower, grid.upper, low)

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return low and high at points (n, 3), 0 outside."""
        shape = np.array(self.high.shape)
        place = (x - self.lower) / (self.upper - self.lower) * shape
        cell = tuple(np.clip(np.floor(place), 0, shape - 1).astype(int).T)
        inside = np.all((x >= self.lower) & (x <= self.upper), axis=-1)
        return np.where(inside, self.low[cell], 0.0), np.where(inside, self.high[cell], 0.0)

    def require_around(self, medium: AnyMedium) -> None:
        """Raise unless the medium is known to end inside the box."""
        if not hasattr(medium, "lower"):
            name = type(medium).__name__
            raise UnsupportedError(
                f"a {name} does not end; a majorant grid does: give the majorant as a number", "majorant"
            )
        lower, upper = box(medium)
        for name, end, corner, good in (
            ("lower", lower, self.lower, lower >= self.lower),
            ("upper", upper, self.upper, upper <= self.upper),
        ):
            require(
                f"{name} of the medium",
                np.asarray(end),
                good,
                f"must lie in the box of the majorant, {corner.tolist()}",
            )


def _blocks(bound: np.ndarray, block: int, axis: int, best: np.ufunc) -> np.ndarray:
    """Return the best of each block along one axis, the voxel on either side included."""
    bound = np.moveaxis(bound, axis, 0)
    n = len(bound)
    count = -(-n // block)
    touched = [slice(max(0, b * n // count - 1), -(-(b + 1) * n // count) + 1) for b in range(count)]
    return np.moveaxis(np.stack([best.reduce(bound[voxels], axis=0) for voxels in touched]), 0, axis)
