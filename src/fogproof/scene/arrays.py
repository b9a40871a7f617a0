"""Types of fields and arguments that are arrays: pydantic reads them from nested lists, without being imported here.

`Any` for type checkers, because the functions accept whatever NumPy can make an array of.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.validate import Channels, as_float_array

MOST_AXES = 16
"""Of an array in a file or request: NumPy broadcasts 32 axes, and the formulas need some of their own."""


@dataclass(frozen=True)
class Numbers:
    """Tells pydantic how to validate and describe an array of numbers; called only when a file or request is read.

    axes   how many axes at the end belong to one value: 0 for numbers, 1 for points (..., 3); all before them broadcast
    table  True for an axis of a table, or a matrix: never broadcast against others
    """

    axes: int = 0
    table: bool = False

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> Any:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(_read)

    def __get_pydantic_json_schema__(self, _schema: Any, _handler: Any) -> dict[str, Any]:
        if self.table or self.axes:
            whole = "a matrix, row by row" if self.axes == 2 else "a list of numbers"
            described = whole if self.table else "[x, y, z], or nested lists of such points"
            return {"type": "array", "description": described}
        return {
            "anyOf": [{"type": "number"}, {"type": "array"}, {"enum": ["inf", "-inf"]}],
            "description": "a number or nested lists of numbers",
        }


def _read(value: Any) -> np.ndarray:
    array = as_float_array("", value)
    if array.ndim > MOST_AXES:
        raise InvalidValueError("", f"must have at most {MOST_AXES} axes", array.ndim)
    return array


class _GreyOrChannels:
    """Tells pydantic to read a grey value, or a list with one value a channel."""

    def __get_pydantic_core_schema__(self, _source: Any, handler: Any) -> Any:
        return handler.generate_schema(Channels)


FloatArray = Annotated[Any, Numbers()]
"""Numbers (...), which broadcast."""

PointArray = Annotated[Any, Numbers(axes=1)]
"""Points or vectors (..., 3), which broadcast without their last axis."""

AxisArray = Annotated[Any, Numbers(table=True)]
"""Numbers (n,) along one axis of a table."""

MatrixArray = Annotated[Any, Numbers(axes=2, table=True)]
"""A matrix (m, n)."""

ChannelArray = Annotated[Any, _GreyOrChannels()]
"""A number, or one number a channel."""


@dataclass(frozen=True)
class _Whole:
    """Tells pydantic to read a whole number >= 0."""

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> Any:
        from pydantic_core import core_schema

        return core_schema.int_schema(ge=0, strict=True)


Count = Annotated[int, _Whole()]
"""A whole number n >= 0; the answer has n + 1 values along its last axis."""
