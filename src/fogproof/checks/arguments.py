"""Arguments that several checks share, each read once: the clean value, or one sentence that says what to write."""

from __future__ import annotations

import inspect
import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.checks.streams import fresh_seed
from fogproof.errors import InvalidValueError
from fogproof.validate import as_float_array, number, require

SMALLEST_ALPHA = 1e-100
"""False-alarm probabilities below this are no promise that arithmetic could keep."""


def alpha_of(alpha: Any) -> float:
    """Return a false-alarm probability."""
    rule = f"must lie in (0, 1), and not below {SMALLEST_ALPHA:g}"
    value = number("alpha", alpha, rule, 0, 1, open_ends=True, fix="1e-6 is usual")
    if value < SMALLEST_ALPHA:
        raise InvalidValueError("alpha", rule, value, "1e-6 is usual")
    return value


def shared_among(check: Callable[..., Any], options: dict[str, Any]) -> dict[str, Any]:
    """Return those of the options that a check takes; one that passes its further options on takes all of them."""
    parameters = inspect.signature(check).parameters.values()
    named = {p.name for p in parameters}
    passes_on = any(p.kind is p.VAR_KEYWORD for p in parameters)
    return {name: value for name, value in options.items() if passes_on or name in named}


def samples_of(samples: Any, least: int = 2) -> int:
    """Return a number of realisations; 1e6 is one."""
    return whole("samples", samples, least)


def whole(name: str, value: Any, least: int) -> int:
    """Return a whole number, also if it is written as a float such as 1e6."""
    rule = f"must be a whole number >= {least}"
    if type(value) is int and value < least:
        raise InvalidValueError(name, rule, value)  # as it was given, not as a float
    x = number(name, value, rule, least)
    if x != math.floor(x):
        raise InvalidValueError(name, rule, x)
    return int(x)


def seed_of(seed: Any) -> int:
    """Return a seed: the one given, or a fresh one."""
    if seed is None:
        return fresh_seed()
    rule = "must be a whole number >= 0, or None for a fresh one"
    try:
        value = operator.index(seed)
    except TypeError:
        raise InvalidValueError("seed", rule, seed) from None
    if value < 0:
        raise InvalidValueError("seed", rule, seed)
    return value


def require_albedo(albedo: Any) -> None:
    """Refuse an albedo that is no finite number, nor a list with one a channel; weights have signs, and so may their mean."""
    array = as_float_array("albedo", albedo)
    if array.ndim > 1 or not array.size:
        raise InvalidValueError("albedo", "must be a number, or a list with one number a channel", albedo)
    require("albedo", array, np.isfinite(array), "must be finite")


def bounds_of(bounds: Any, nonnegative: bool = False) -> tuple[float, float]:
    """Return (low, high) between which every value lies."""
    if bounds is None:
        return (0.0 if nonnegative else -math.inf), math.inf
    array = as_float_array("bounds", bounds)
    if array.shape != (2,) or not array[0] < array[1]:
        raise InvalidValueError("bounds", "must be (low, high) with low < high", bounds)
    low, high = map(float, array)
    return max(low, 0.0) if nonnegative else low, high


def tolerance_of(tolerance: Any) -> tuple[float, float]:
    """Return the tolerance as (relative, absolute)."""
    array = as_float_array("tolerance", tolerance)
    if array.shape not in ((), (2,)) or not ((array >= 0) & (array < math.inf)).all():
        raise InvalidValueError("tolerance", "must be one number >= 0, or (relative, absolute)", tolerance)
    relative, absolute = (float(array), 0.0) if array.ndim == 0 else map(float, array)
    return relative, absolute
