"""Complex numbers in files, where neither TOML nor JSON has them: a real number, or the pair [real, imaginary]."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.validate import as_float_array


def as_complex(name: str, value: Any) -> complex:
    """Return a finite complex number from a number or a pair of real ones."""
    if isinstance(value, complex | np.complexfloating):
        value = (value.real, value.imag)
    parts = as_float_array(name, value)
    if parts.shape not in ((), (2,)) or not np.isfinite(parts).all():
        raise InvalidValueError(name, "must be a finite number or a pair [real, imaginary]", value)
    return complex(*np.atleast_1d(parts).tolist())


class _FromPair:
    """Tells pydantic how to validate and describe a complex number; called only when a file is read."""

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> Any:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(lambda value: as_complex("number", value))

    def __get_pydantic_json_schema__(self, _schema: Any, _handler: Any) -> dict[str, Any]:
        pair = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
        return {"anyOf": [{"type": "number"}, pair], "description": "a number or a pair [real, imaginary]"}


ComplexNumber = Annotated[complex, _FromPair()]
"""The type of a complex field that files can give."""
