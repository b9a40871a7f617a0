"""A phase function that varies in space: two populations of particles in a proportion that depends on the place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.phase.phase_function import PhaseFunctionField, require_phase
from fogproof.validate import points


@dataclass(frozen=True, eq=False)
class Ramp:
    """A number that grows linearly from 0 on the plane through `start` to 1 on the plane through `end`.

    start, end  (3,) two different points [m]; the planes are normal to the line between them, and beyond them the
                number stays 0 or 1
    """

    start: FloatArray
    end: FloatArray

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            point = points(name, getattr(self, name))
            if point.ndim != 1:
                raise InvalidValueError(name, "must be one point [x, y, z]", getattr(self, name))
            object.__setattr__(self, name, point)
        if np.array_equal(self.start, self.end):
            raise InvalidValueError("end", "must differ from start", self.end)


class _FromTable:
    """In a file the share is a `Ramp`; a function cannot be written there."""

    def __get_pydantic_core_schema__(self, _source: Any, handler: Any) -> Any:
        return handler.generate_schema(Ramp)


@dataclass(frozen=True, eq=False)
class VaryingPhase:
    """f_p(x, mu) = (1 - q(x)) first(mu) + q(x) second(mu), normalised at every place x.

    first, second  phase functions
    share          q(x) in [0, 1], the part of the scattering coefficient that belongs to `second`: a `Ramp`, or from
                   Python an array function of points (..., 3) -> (...)
    """

    first: PhaseFunctionField
    second: PhaseFunctionField
    share: Annotated[Ramp | Callable[[np.ndarray], np.ndarray], _FromTable()]

    def __post_init__(self) -> None:
        for name in ("first", "second"):
            require_phase(name, getattr(self, name))
        if not (isinstance(self.share, Ramp) or callable(self.share)):
            raise InvalidValueError("share", "must be a Ramp or a function of points", self.share)
