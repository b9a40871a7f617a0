"""What is measured of an estimator: each quantity is the mean of numbers made from its draws, with the value it should have."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fogproof.checks.statistics.known import NOTHING, NOTHING_MORE, Declarable, Known
from fogproof.contracts import Draws, Reference
from fogproof.errors import InvalidValueError, SubjectError
from fogproof.validate import require

_BOUNDS, _TAILS = "bounds=(low, high)", 'tails="light"'
OF_A_MEAN = Declarable(
    "the exact variance=", "variance=0 if the estimator has none, its exact variance=", _BOUNDS, _TAILS
)
OF_A_DIFFERENCE = Declarable(
    "the exact variance=(first, second)", "the exact variance=(first, second), 0 for one that has none", _BOUNDS, _TAILS
)
_WITHOUT_VARIANCE = Declarable(bounds=_BOUNDS, tails=_TAILS)


@dataclass(frozen=True)
class CheckedQuantity:
    """One expectation, channel by channel.

    name     what it is called
    numbers  draws with values (n, channels) -> (n, channels) whose mean it is
    value    (channels,) what it should be
    error    (channels,) bound on the error of that
    cause    the likely class of error where it is not
    known    what is declared of one of the numbers, channel by channel; or nothing
    own      (channels,) what of that is the reference's own, where the rest is tolerated; None if it is all
    tame     whether an event a hundred times larger than all that was seen is out of the question
    signed   whether numbers of both signs are usual, so that it tells nothing if none was negative
    ways     what the caller may declare about it
    further  (lowest, highest value so far, channel) -> how far off a number that was not met may lie, if the values can tell
    """

    name: str
    numbers: Callable[[Draws], np.ndarray]
    value: np.ndarray
    error: np.ndarray
    cause: str
    known: tuple[Known, ...] = ()
    own: np.ndarray | None = None
    tame: bool = False
    signed: bool = False
    ways: Declarable = NOTHING_MORE
    further: Callable[[float, float, int], float] | None = None

    def known_of(self, channel: int) -> Known:
        """Return what is declared of the numbers of one channel."""
        return self.known[channel] if self.known else NOTHING


@dataclass(frozen=True)
class Declared:
    """What the caller declares beside the reference; see `check_estimator`."""

    variance: Reference | float | None = None
    cost: Reference | float | None = None
    bounds: tuple[float, float] = (-math.inf, math.inf)
    light: bool = False
    tolerance: tuple[float, float] = (0.0, 0.0)
    roundoff: float = 2.0**-53

    def known(self, variance: float | None = None) -> Known:
        """Return what may be relied on of a value."""
        return Known(variance, *self.bounds, self.light)

    def widened(self, value: np.ndarray, error: np.ndarray) -> np.ndarray:
        """Return the error with the tolerance, and with the rounding of single precision, where that is declared."""
        relative, absolute = self.tolerance
        rounding = 8 * self.roundoff if self.roundoff > 2.0**-53 else 0.0
        return np.asarray(error + absolute + (relative + rounding) * np.abs(value))


def quantities_of(
    reference: Reference | float | Mapping[int, Reference | float], declared: Declared, stderr: np.ndarray | None
) -> list[CheckedQuantity]:
    """Return all that is known of an estimator, the means of its values first; `stderr` are the first it reports, if any."""
    cost = _cost(declared)
    if isinstance(reference, Mapping):
        if declared.variance is not None:
            raise InvalidValueError("variance", "needs one reference, not one for each order", declared.variance)
        return [_order(label, one, declared) for label, one in reference.items()] + cost
    value, own = _exact("reference", reference, None)
    _require_meaning(declared.tolerance, value)
    error = declared.widened(value, own)
    low, high = declared.bounds
    inside = (value + error >= low) & (value - error <= high)
    require("reference", value, inside, f"must lie within the declared bounds ({low:g}, {high:g})")
    known = [declared.known() for _ in value]
    more = []
    if declared.variance is not None:
        v, v_error = _exact("variance", declared.variance, len(value))
        v_error = v_error + _rounding_of_variance(v, value, declared.roundoff)
        known = [declared.known(float(one)) for one in v + v_error]
        if math.isfinite(high - low):
            most = np.maximum(high - value + error, 0.0) * np.maximum(value + error - low, 0.0)
            possible = v - v_error <= most * (1 + 1e-12)
            rule = (
                "must be possible within the declared bounds: (high - mean) (mean - low) at most (Bhatia & Davis 2000)"
            )
            require("variance", v, possible, rule, f"that is {float(most.min()):.6g}")
        # (X - r)^2 has expectation V + (mean - r)^2, and |mean - r| <= error; what of that is tolerated is no doubt of V.
        v_own, v_error = v_error + own**2, v_error + error**2
        largest = np.maximum((high - value) ** 2, (value - low) ** 2)
        told = "" if math.isfinite(low) or math.isfinite(high) else "that no square is negative"
        squares = tuple(Known(low=0.0, high=float(one), light=declared.light, told=told) for one in largest)
        more.append(
            CheckedQuantity(
                "variance",
                lambda d: _squared(d.value - value),
                v,
                v_error,
                "wrong variance",
                squares,
                v_own,
                ways=_WITHOUT_VARIANCE,
            )
        )
    if stderr is not None:
        unit = _unit(stderr)
        zero = np.zeros_like(value)
        name, cause = "square of the error less that of the standard error", "wrong standard errors"
        told = "that no error is larger than the bounds leave"
        most = np.maximum(high - value + error, value + error - low) / unit
        bounded = (
            tuple(Known(high=float(one), told=told) for one in _squared(most)) if math.isfinite(high - low) else ()
        )
        more.append(
            CheckedQuantity(
                name,
                lambda d: _squared((d.value - value) / unit) - _squared(column(d.stderr) / unit),
                zero,
                (error / unit) ** 2,
                cause,
                bounded,
                own=(own / unit) ** 2,
                # An error twice as large as any so far: of averages of rare hits, two hits are four times one in the square.
                further=lambda low, high, c: (2 * max(high - value[c], value[c] - low) / unit) ** 2,
            )
        )
    mean = CheckedQuantity("mean", lambda d: d.value, value, error, "bias", tuple(known), own, ways=OF_A_MEAN)
    return [mean, *more, *cost]


def _require_meaning(tolerance: tuple[float, float], value: np.ndarray) -> None:
    """Refuse a tolerance that is a share of nothing."""
    relative, absolute = tolerance
    if relative > 0 and absolute == 0 and not value.any():
        rule, fix = (
            "must have an absolute part where the reference is 0, of which every share is 0",
            "give (0, absolute)",
        )
        raise InvalidValueError("tolerance", rule, relative, fix)


def _rounding_of_variance(v: np.ndarray, value: np.ndarray, roundoff: float) -> np.ndarray:
    """Return by how much the variance changes if every realisation is rounded, and computed with a few roundings more.

    Rounding moves a realisation by at most roundoff |X|, by Minkowski's inequality the deviation by no more than the root of the
    mean square of that.
    """
    size = np.sqrt(v + value * value) * roundoff
    return np.asarray(2 * np.sqrt(v) * size + size * size + 8 * roundoff * v)


def _order(label: int, reference: Reference | float, declared: Declared) -> CheckedQuantity:
    value, error = _exact("reference", reference, None)
    low, high = declared.bounds
    known = tuple(Known(None, min(low, 0.0), max(high, 0.0), declared.light) for _ in value)

    def numbers(d: Draws) -> np.ndarray:
        if d.order is None:
            raise SubjectError("draw must return Draws with an order when references by order are given", "draw: order")
        return np.where(column(d.order) == label, d.value, 0.0)

    return CheckedQuantity(
        f"mean of order {label}",
        numbers,
        value,
        declared.widened(value, error),
        "bias",
        known,
        error,
        ways=_WITHOUT_VARIANCE,
    )


def _cost(declared: Declared) -> list[CheckedQuantity]:
    if declared.cost is None:
        return []

    def numbers(d: Draws) -> np.ndarray:
        if d.cost is None:
            raise SubjectError("draw must return Draws with a cost when a reference cost is given", "draw: cost")
        return column(d.cost)

    value, error = _exact("cost", declared.cost, 1)
    return [
        CheckedQuantity(
            "cost", numbers, value, error, "wrong cost", (Known(low=0.0, told="that no cost is negative"),), tame=True
        )
    ]


def _exact(name: str, reference: Reference | float, channels: int | None) -> tuple[np.ndarray, np.ndarray]:
    reference = Reference.of(name, reference)
    value, error = np.broadcast_arrays(np.atleast_1d(reference.value), np.atleast_1d(reference.error))
    if value.ndim > 1:
        rule = "must be a number or (channels,)"
        raise InvalidValueError(name, rule, f"shape {value.shape}", "an image becomes one by reshape(-1, channels)")
    for part, array in ((name, value), (f"{name}: error", error)):
        require(part, array, np.isfinite(array), "must be finite", "nothing can be held to a value that is not known")
    if name != "reference":
        require(name, value, value >= -error, "must be >= 0")
    if channels is not None:
        value, error = np.broadcast_to(value, (channels,)), np.broadcast_to(error, (channels,))
    return value, error


def _squared(x: np.ndarray) -> np.ndarray:
    with np.errstate(over="ignore", under="ignore"):
        return x * x


def _unit(stderr: np.ndarray) -> float:
    """Return 1, or a scale in which squares of standard errors stay within binary64."""
    largest = float(np.max(stderr, initial=0.0, where=np.isfinite(stderr)))
    return 1.0 if largest == 0 or 1e-100 < largest < 1e100 else math.ldexp(1.0, math.frexp(largest)[1])


def column(values: np.ndarray | None) -> np.ndarray:
    """Return values of shape (n,) as (n, 1)."""
    assert values is not None
    array = np.asarray(values, dtype=np.float64)
    return array[:, None] if array.ndim == 1 else array
