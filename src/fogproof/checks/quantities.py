"""What is measured of an estimator: each quantity is the mean of numbers made from its draws, with the value it should have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws, Reference
from fogproof.errors import SubjectError
from fogproof.validate import require


@dataclass(frozen=True)
class Quantity:
    """One expectation, channel by channel.

    name      what it is called
    numbers   draws with values (n, channels) -> (n, channels) whose mean it is
    value     (channels,) what it should be
    error     (channels,) bound on the error of that
    cause     the likely class of error where it is not
    variance  (channels,) the exact variance of the numbers, or None
    """

    name: str
    numbers: Callable[[Draws], np.ndarray]
    value: np.ndarray
    error: np.ndarray
    cause: str
    variance: np.ndarray | None = None


def quantities_of(
    reference: Reference | float | Mapping[int, Reference | float],
    variance: Reference | float | None,
    cost: Reference | float | None,
    with_stderr: bool,
) -> list[Quantity]:
    """Return all that is known of an estimator, the means of its values first."""
    if isinstance(reference, Mapping):
        return [_order(label, one) for label, one in reference.items()] + _cost(cost)
    value, error = _exact("reference", reference, None)
    spread = None
    more = []
    if variance is not None:
        v, v_error = _exact("variance", variance, len(value))
        spread = v + v_error
        # (X - r)^2 has expectation V + (mean - r)^2, and |mean - r| <= error.
        more.append(Quantity("variance", lambda d: (d.value - value) ** 2, v, v_error + error**2, "wrong variance"))
    if with_stderr:
        more.append(
            Quantity(
                "square of the error less that of the standard error",
                lambda d: (d.value - value) ** 2 - _column(d.stderr) ** 2,
                np.zeros_like(value),
                error**2,
                "wrong standard errors",
            )
        )
    return [Quantity("mean", lambda d: d.value, value, error, "bias", spread), *more, *_cost(cost)]


def _order(label: int, reference: Reference | float) -> Quantity:
    value, error = _exact("reference", reference, None)

    def numbers(d: Draws) -> np.ndarray:
        if d.order is None:
            raise SubjectError("draw must return Draws with an order when references by order are given", "draw: order")
        return np.where(_column(d.order) == label, d.value, 0.0)

    return Quantity(f"mean of order {label}", numbers, value, error, "bias")


def _cost(cost: Reference | float | None) -> list[Quantity]:
    if cost is None:
        return []

    def numbers(d: Draws) -> np.ndarray:
        if d.cost is None:
            raise SubjectError("draw must return Draws with a cost when a reference cost is given", "draw: cost")
        return _column(d.cost)

    value, error = _exact("cost", cost, 1)
    return [Quantity("cost", numbers, value, error, "wrong cost")]


def _exact(name: str, reference: Reference | float, channels: int | None) -> tuple[np.ndarray, np.ndarray]:
    reference = Reference.of(name, reference)
    value, error = np.broadcast_arrays(np.atleast_1d(reference.value), np.atleast_1d(reference.error))
    for part, array in ((name, value), (f"{name}: error", error)):
        require(part, array, np.isfinite(array), "must be finite", "nothing can be held to a value that is not known")
    if name != "reference":
        require(name, value, value >= -error, "must be >= 0")
    if channels is not None:
        value, error = np.broadcast_to(value, (channels,)), np.broadcast_to(error, (channels,))
    return value, error


def _column(values: np.ndarray | None) -> np.ndarray:
    assert values is not None
    array = np.asarray(values, dtype=np.float64)
    return array[:, None] if array.ndim == 1 else array
