"""A phase function from a table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.phase.phase_function import PhaseFunction
from fogproof.scene.phase.table_columns import normalisation, understand
from fogproof.validate import as_float_array, require


@dataclass(frozen=True)
class Tabulated(PhaseFunction):
    """Linear between `values` [1/sr] at increasing `cosines` from -1 to 1.

    The values must be normalised, 2 pi int_-1^1 f dmu = 1, to 1e-9; what remains is divided out.
    `Tabulated.normalised` scales values that are not; `Tabulated.from_columns` takes angles and other orders too.
    """

    cosines: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        total = _integral(self.cosines, self.values)
        if not abs(total - 1) <= 1e-9:
            rule = "must integrate to 1 over the sphere"
            raise InvalidValueError(
                "values", rule, total, "divide them by that, or use Tabulated.normalised(cosines, values)"
            )
        object.__setattr__(self, "cosines", tuple(as_float_array("cosines", self.cosines).tolist()))
        object.__setattr__(self, "values", tuple(as_float_array("values", self.values).tolist()))

    @classmethod
    def normalised(cls, cosines: Any, values: Any) -> Tabulated:
        """Return the function proportional to the piecewise linear one through `values` at `cosines`."""
        total = _integral(cosines, values)
        if not 0 < total < np.inf:
            raise InvalidValueError("values", "must have a positive finite integral", total)
        return cls(cosines, tuple((as_float_array("values", values) / total).tolist()))

    @classmethod
    def from_columns(cls, places: Any, values: Any) -> tuple[Tabulated, str]:
        """Return the function of two columns as programs write them, and one sentence that says what was understood.

        places  forward cosines, or scattering angles in radians or degrees; in either order, with both poles or the centres of
                equal cells
        values  >= 0 there, in any normalisation; between the places the function is linear in the cosine

        Example: `phase, understood = Tabulated.from_columns([0, 30, 90, 180], [9, 4, 1, 2])`.
        """
        columns = understand(places, values)
        total = _integral(columns.cosines, columns.values)
        phase = cls.normalised(columns.cosines, columns.values)
        c, f = np.array(phase.cosines), np.array(phase.values)
        left, right = c[:-1], c[1:]
        mean = np.pi / 3 * np.sum((right - left) * (f[:-1] * (2 * left + right) + f[1:] * (left + 2 * right)))
        return phase, f"{columns.sentence}; {normalisation(total)}; linear in the cosine; mean cosine {mean:.6g}"


def _integral(cosines: Any, values: Any) -> float:
    """Return 2 pi int f dmu of a table whose shape and signs have been checked."""
    c, f = as_float_array("cosines", cosines), as_float_array("values", values)
    if c.ndim != 1 or c.size < 2:
        raise InvalidValueError("cosines", "must be a list of at least two numbers", cosines)
    require("cosines", c, np.isfinite(c), "must be finite")
    if c[0] != -1 or c[-1] != 1 or not (np.diff(c) > 0).all():
        fix = "Tabulated.from_columns understands angles, decreasing cosines and centres of cells"
        raise InvalidValueError("cosines", "must increase from -1 to 1", cosines, fix)
    if f.shape != c.shape:
        raise InvalidValueError("values", "must be one number a cosine", values, f"there are {c.size} cosines")
    require("values", f, np.isfinite(f) & (f >= 0), "must be finite and >= 0 [1/sr]")
    return float(np.pi * np.sum(np.diff(c) * (f[1:] + f[:-1])))
