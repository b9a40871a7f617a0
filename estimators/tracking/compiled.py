"""Users' numba functions as media: compiled into the trackers' loops, and at the same time array functions for everyone else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError


@dataclass(frozen=True, eq=False)
class CompiledField:
    """Extinction from a numba function, to be given to `Procedural` as its sigma_t.

    function  made by `numba.njit`, from floats (x, y, z) [m] to sigma_t [1/m]; (x, y, z, channel) if there are channels
    channels  how many channels, None if grey

    Each tracker is compiled once a process for each function.
    """

    function: Any
    channels: int | None = None

    def __post_init__(self) -> None:
        call = "f(x, y, z)" if self.channels is None else "f(x, y, z, channel)"
        if not is_compiled(self.function):
            name = getattr(self.function, "__name__", self.function)
            rule = "must be compiled by numba: a Python function cannot enter a compiled loop"
            fix = "decorate it with @numba.njit, or give Procedural an array function of points (..., 3)"
            raise InvalidValueError("function", rule, name, fix)
        from numba import types
        from numba.core.errors import NumbaError

        arguments = (types.float64,) * 3 + ((types.int64,) if self.channels is not None else ())
        try:
            self.function.compile(arguments)
            returned = self.function.overloads[arguments].signature.return_type
        except (NumbaError, TypeError, RuntimeError) as error:
            reason = str(error).strip().splitlines()[-1]
            raise InvalidValueError(
                "function", f"must compile as {call}", self.function.__name__, f"numba says: {reason}"
            ) from None
        if not isinstance(returned, types.Number):
            raise InvalidValueError("function", f"must return one number from {call}", str(returned))

    def __call__(self, x: Any) -> np.ndarray:
        """Return sigma_t [1/m] at points (..., 3), shape (...) or (..., channels)."""
        from fogproof.estimators.kernels.compiling import uncached
        from fogproof.estimators.kernels.tracking import look_up
        from fogproof.estimators.media.procedural import ChromaticFieldData, FieldData

        x = np.asarray(x, dtype=np.float64)
        sigma = np.empty((x.size // 3, self.channels or 1))
        data = FieldData if self.channels is None else ChromaticFieldData
        uncached(look_up)(data(self.function), np.array(x.reshape(-1, 3)), sigma)
        return sigma.reshape(x.shape[:-1] if self.channels is None else (*x.shape[:-1], self.channels))


def is_compiled(function: Any) -> bool:
    """Return whether something is a numba function, without importing numba."""
    return hasattr(function, "py_func") and hasattr(function, "nopython_signatures")
