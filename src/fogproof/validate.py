"""Rules for arguments, stated once: each function returns the clean value or raises `InvalidValueError`."""

from __future__ import annotations

import numbers
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError, shorten

Channels = float | tuple[float, ...]
"""A grey value, or one value a colour or wavelength channel."""

LONGEST = 1e6
"""The longest time limit [s]: systems wait so long for sure, and eleven days are as good as none."""


def as_float_array(name: str, value: Any) -> np.ndarray:
    """Return `value` as a new float64 array without negative zeros, or say what cannot be read as numbers."""
    array = np.empty(0)
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O" and all(_is_number(one) for one in array.flat):  # fractions, decimals, mpmath's
            array = array.astype(np.float64)
        if array.dtype.kind not in "iuf":
            raise TypeError(array.dtype)
        return np.asarray(array.astype(np.float64) + 0.0)  # -0.0 + 0.0 = 0.0: its sign must not choose a branch
    except (TypeError, ValueError, OverflowError):
        fix = "give real and imaginary parts as two channels" if np.iscomplexobj(array) else ""
        raise InvalidValueError(name, "must be a number or an array of numbers", value, fix) from None


def coordinates(name: str, value: Any) -> tuple[float, ...]:
    """Return the coordinates of one point, whatever sequence they come in."""
    array = as_float_array(name, value)
    if array.ndim != 1:
        raise InvalidValueError(name, "must be the coordinates of a point", value)
    return tuple(array.tolist())


def _is_number(value: Any) -> bool:
    return isinstance(value, numbers.Number) and not isinstance(value, bool | complex)


def first_bad(array: np.ndarray, good: np.ndarray) -> Any:
    """Return the first value of `array` where `good` fails, for an error message."""
    return array[~good].ravel()[0].item()


def require(name: str, array: np.ndarray, good: np.ndarray | bool, rule: str, fix: str = "") -> None:
    """Raise `InvalidValueError` naming the first value of `array` where `good` is false."""
    good = np.broadcast_to(good, array.shape)
    if not good.all():
        raise InvalidValueError(name, rule, first_bad(array, good), fix)


def number(
    name: str,
    value: Any,
    rule: str,
    low: float = -np.inf,
    high: float = np.inf,
    *,
    open_ends: bool = False,
    fix: str = "",
) -> float:
    """Return a single finite number in [low, high], or in (low, high) with `open_ends`."""
    array = as_float_array(name, value)
    if array.ndim:
        raise InvalidValueError(name, "must be a single number", value)
    x = float(array)
    inside = low < x < high if open_ends else low <= x <= high
    if not (np.isfinite(x) and inside):
        endless = np.isinf(x) and (high if x > 0 else low) == x and "finite" not in rule
        raise InvalidValueError(name, f"{rule} and finite" if endless else rule, x, fix)
    return x


def nonnegative_channels(name: str, value: Any, unit: str) -> Channels:
    """Return a finite value >= 0, or a tuple of them with one a channel."""
    array = as_float_array(name, value)
    if array.ndim > 1 or array.size == 0:
        raise InvalidValueError(name, "must be a number or a list with one number a channel", value)
    require(name, array, np.isfinite(array) & (array >= 0), f"must be finite and >= 0 [{unit}]")
    return float(array) if array.ndim == 0 else tuple(array.tolist())


def points(name: str, value: Any) -> np.ndarray:
    """Return read-only (..., 3) coordinates, all finite."""
    array = as_float_array(name, value)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise InvalidValueError(
            name,
            "must have three coordinates in its last axis",
            list(array.shape),
            f"pass [x, y, z]; the value was {shorten(value)}",
        )
    require(name, array, np.isfinite(array), "must be finite")
    array.flags.writeable = False
    return array


def unit_vectors(name: str, value: Any) -> np.ndarray:
    """Return read-only (..., 3) unit vectors.

    A length off by less than 1e-6 (a vector normalised in single precision) is normalised again; more is an error. One
    that is off by rounding alone, 4 eps, stays as it is: to normalise twice would move it.
    """
    array = points(name, value)
    with np.errstate(over="ignore", under="ignore"):  # a length of inf or 0 is no unit either
        length = np.sqrt(np.sum(array * array, axis=-1))
    require(name, length, np.abs(length - 1) < 1e-6, "must have unit length", "divide it by its length")
    rounded = np.abs(length[..., None] - 1) <= 4 * np.finfo(np.float64).eps
    array = np.where(rounded, array, array / length[..., None])
    array.flags.writeable = False
    return array


def channel_count(**values: Channels) -> int | None:
    """Return how many channels the named values have together, None if all are grey; unequal counts are an error."""
    counts = {name: len(value) for name, value in values.items() if isinstance(value, tuple)}
    if len(set(counts.values())) > 1:
        listed = ", ".join(f"{name} has {n}" for name, n in counts.items())
        raise InvalidValueError(
            next(iter(counts)),
            "must have as many channels as its companions",
            listed,
            "give one number for grey, or equally many everywhere",
        )
    return next(iter(counts.values()), None)


def one_point(name: str, value: object) -> tuple[float, float, float]:
    """Return one finite point as a tuple."""
    point = points(name, value)
    if point.ndim != 1:
        raise InvalidValueError(name, "must be one point [x, y, z]", value)
    return tuple(point.tolist())


def one_direction(name: str, value: object) -> tuple[float, float, float]:
    """Return one unit vector as a tuple."""
    vector = unit_vectors(name, value)
    if vector.ndim != 1:
        raise InvalidValueError(name, "must be one vector [x, y, z]", value)
    return tuple(vector.tolist())


def time_limit(name: str, value: Any) -> float:
    """Return a time limit in (0, `LONGEST`] [s]."""
    rule = f"must be > 0 and at most {LONGEST:g} [s]"
    return number(name, value, rule, np.nextafter(0, 1), LONGEST)


def positive_length(name: str, value: Any) -> float:
    """Return a finite length > 0 [m]."""
    return number(name, value, "must be finite and > 0 [m]", 0, np.inf, open_ends=True)
