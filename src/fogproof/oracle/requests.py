"""One line of text to one request, by the letter of JSON: what Python's parser forgives is refused here."""

from __future__ import annotations

import json
import math
from typing import Any

from fogproof.errors import InvalidInputError
from fogproof.oracle.limits import DEEPEST


def read_request(text: str) -> Any:
    """Return the JSON value of a text, or raise `InvalidInputError`.

    Refused besides broken JSON: NaN and Infinity (write "inf"), numbers beyond float64, a key twice, more than 64 levels.
    """
    try:
        value = _DECODER.decode(text)
    except json.JSONDecodeError as error:
        raise InvalidInputError(f"request is not valid JSON: {error}") from None
    except RecursionError:
        raise InvalidInputError(f"request is nested too deeply; at most {DEEPEST} levels") from None
    except ValueError:  # Python's bound on the digits of an integer
        raise InvalidInputError("request has an integer of too many digits; write it as a float, 1e300") from None
    _require_plain(value, DEEPEST)
    return value


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise InvalidInputError(f"request has the key {twice!r} twice in one table", twice)
    return table


def _refuse(constant: str) -> Any:
    fix = {"Infinity": ' write the string "inf"', "-Infinity": ' write the string "-inf"'}
    raise InvalidInputError(f"request has {constant}, which is not JSON;{fix.get(constant, ' no quantity takes it')}")


def _require_plain(value: Any, levels: int) -> None:
    """Refuse infinite floats, which can only come from a number like 1e999, and deep nesting."""
    if isinstance(value, float):
        if math.isinf(value):
            raise InvalidInputError('request has a number beyond 1.8e308, the largest float64; write "inf" or "-inf"')
    elif isinstance(value, list | dict):
        if levels == 0:
            raise InvalidInputError(f"request is nested too deeply; at most {DEEPEST} levels")
        for item in value.values() if isinstance(value, dict) else value:
            _require_plain(item, levels - 1)


_DECODER = json.JSONDecoder(object_pairs_hook=_unique, parse_constant=_refuse)
