"""An array type for dataclass fields that pydantic can read from nested lists, without importing pydantic here."""

from __future__ import annotations

from typing import Annotated, Any

from fogproof.validate import as_float_array


class _FromNestedLists:
    """Tells pydantic how to validate and describe an array of numbers; called only when a file is read."""

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> Any:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(lambda value: as_float_array("array", value))

    def __get_pydantic_json_schema__(self, _schema: Any, _handler: Any) -> dict[str, Any]:
        return {
            "anyOf": [{"type": "number"}, {"type": "array"}, {"const": "inf"}],
            "description": "a number or nested lists of numbers",
        }


# `Any` for type checkers, because the constructors accept whatever NumPy can make an array of.
FloatArray = Annotated[Any, _FromNestedLists()]
