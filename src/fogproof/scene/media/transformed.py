"""Any medium somewhere else: moved, turned, scaled or sheared by an affine map."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.kinds import ByKind
from fogproof.scene.media.common import read_only
from fogproof.scene.phase import require_phase
from fogproof.validate import as_float_array, require

WORST = 1e8
"""Condition of a matrix beyond which places in the medium are not known from those in the world."""


@dataclass(frozen=True, eq=False)
class TransformedMedium:
    """A medium whose coefficients at a place of the world are those of another at the place that `to_world` maps there.

    medium    in coordinates of its own, with one phase function; not one whose extinction depends on the direction
    to_world  (3, 4) or (4, 4) affine map [m], the last row 0 0 0 1; the columns are where the axes go, the last one the origin

    Extinction stays per metre of the world: a grid scaled to twice its size is twice as thick.
    """

    medium: Annotated[Any, ByKind("fogproof.scene.media", default="homogeneous")]
    to_world: FloatArray

    def __post_init__(self) -> None:
        one = self.medium
        if not all(hasattr(one, name) for name in ("channels", "albedo", "phase", "emission")):
            raise InvalidValueError("medium", "must be a medium", one, "for example a VoxelGrid")
        if hasattr(one, "media") or hasattr(one, "to_world"):
            what = f"a transformed medium holds no {type(one).__name__}"
            raise UnsupportedError(f"{what}; transform its parts, and multiply the matrices", "medium")
        require_phase("medium.phase", one.phase, "must be one phase function in a transformed medium")
        matrix = as_float_array("to_world", self.to_world)
        if matrix.shape not in ((3, 4), (4, 4)):
            raise InvalidValueError("to_world", "must be a matrix (3, 4) or (4, 4)", list(matrix.shape))
        require("to_world", matrix, np.isfinite(matrix), "must be finite [m]")
        if matrix.shape == (4, 4) and not np.array_equal(matrix[3], (0, 0, 0, 1)):
            rule = "must have the last row 0 0 0 1"
            raise InvalidValueError("to_world", rule, matrix[3].tolist(), "a perspective map is no place for a medium")
        object.__setattr__(self, "to_world", read_only(matrix[:3]))
        sizes = np.linalg.svd(self.to_world[:, :3], compute_uv=False)
        if not sizes[-1] * WORST > sizes[0]:
            fix = "its three columns must point three ways"
            raise InvalidValueError("to_world", "must be invertible", self.to_world[:, :3].tolist(), fix)

    @property
    def lower(self) -> np.ndarray:
        """Corner of a box around the medium [m]; infinite where it has no end."""
        return self._box()[0]

    @property
    def upper(self) -> np.ndarray:
        """The opposite corner [m]."""
        return self._box()[1]

    def _box(self) -> tuple[np.ndarray, np.ndarray]:
        low = np.asarray(getattr(self.medium, "lower", (-np.inf,) * 3), float)
        high = np.asarray(getattr(self.medium, "upper", (np.inf,) * 3), float)
        if not np.isfinite([low, high]).all():
            return np.full(3, -np.inf), np.full(3, np.inf)
        middle, half = (low + high) / 2, (high - low) / 2
        at = self.to_world[:, :3] @ middle + self.to_world[:, 3]
        reach = (np.abs(self.to_world[:, :3]) @ half) * (1 + 1e-12) + 1e-12 * np.abs(at)
        return at - reach, at + reach

    @property
    def albedo(self) -> Any:
        """That of the medium."""
        return self.medium.albedo

    @property
    def phase(self) -> Any:
        """That of the medium."""
        return self.medium.phase

    @property
    def emission(self) -> Any:
        """That of the medium."""
        return self.medium.emission

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return bool(getattr(self.medium, "is_empty", False))

    @property
    def sources_vary(self) -> bool:
        """Whether albedo or emission may differ from place to place."""
        return bool(getattr(self.medium, "sources_vary", False))

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        channels: int | None = self.medium.channels
        return channels

    def channel(self, c: int) -> TransformedMedium:
        """Return the grey medium that channel c sees."""
        from fogproof.scene.media import medium_of_channel

        return replace(self, medium=medium_of_channel(self.medium, c))
