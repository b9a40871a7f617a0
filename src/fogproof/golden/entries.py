"""What a golden table holds: questions as the oracle's protocol puts them, each with value and error."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from fogproof.analytic.proven.golden import Golden, golden_values
from fogproof.errors import InvalidInputError
from fogproof.oracle import Limits, answer
from fogproof.quantities import Quantity, quantities


@dataclass(frozen=True, eq=False)
class Entry:
    """One question and its answer: |value - truth| <= error, element by element.

    digits  the value with all its proven digits where there are more than a float64 holds, else ""
    """

    quantity: Quantity
    request: dict[str, Any]
    value: np.ndarray
    error: np.ndarray
    method: str
    source: str
    digits: str = ""


@dataclass(frozen=True)
class Row:
    """One number of an entry.

    arguments  of this number alone: an array of the request gives way to its element; points are lists of three
    index      where the number stands in an answer to such a request, () if it is all of it
    """

    entry: Entry
    arguments: dict[str, Any]
    index: tuple[int, ...]
    value: float
    error: float


def golden_entries(
    names: Sequence[str], requests: Sequence[dict[str, Any]] | None = None, limits: Limits | None = None
) -> list[Entry]:
    """Return the entries of some quantities: proven values and the example, or the answers to given requests.

    names     quantities; with requests, those to keep, all if there are none
    requests  as for `fogproof.oracle.answer`
    limits    what each answer may cost
    """
    for name in names:
        if name not in quantities():
            known = ", ".join(quantities())
            raise InvalidInputError(f"quantity {name!r} is not known; known are {known}", "quantity")
    if requests is not None:
        return [_answered(request, limits) for request in requests if not names or request.get("quantity") in names]
    proven = golden_values()
    return [
        entry
        for name in names
        for entry in (
            *(_proven(golden) for golden in proven if golden.request["quantity"] == name),
            _answered({"quantity": name, **quantities()[name].example}, limits),
        )
    ]


def _answered(request: dict[str, Any], limits: Limits | None) -> Entry:
    found = answer(request, limits=limits)
    question = {key: value for key, value in request.items() if key != "id"}
    value, error = found["value"], found["error"]
    return Entry(quantities()[found["quantity"]], question, value, error, found["method"], found["source"])


def _proven(golden: Golden) -> Entry:
    """Round a proven value to the nearest float64; what that loses counts as error."""
    quantity = quantities()[golden.request["quantity"]]
    value, error = math.inf, 0.0
    if golden.value != "inf":
        truth = Fraction(golden.value)
        value = float(truth)
        exact = abs(Fraction(value) - truth) + Fraction(golden.radius)
        error = float(exact)
        if Fraction(error) < exact:
            error = math.nextafter(error, math.inf)
    digits = "" if golden.value == "inf" else golden.value
    return Entry(quantity, golden.request, np.array(value), np.array(error), "ball arithmetic", quantity.source, digits)


def rows_of(entry: Entry) -> Iterator[Row]:
    """Yield the numbers of an entry, each with its own arguments."""
    arrays = {}
    for path, mark in entry.quantity.arrays.items():
        outer, _, inner = path.partition(".")
        given = entry.request.get(outer)
        given = given.get(inner) if inner and isinstance(given, dict) else given
        if given is not None and not mark.table:
            arrays[path] = np.vectorize(float, otypes=[float])(given), mark.axes
    shape = np.broadcast_shapes(*(array.shape[: array.ndim - axes] for array, axes in arrays.values()))
    for place in np.ndindex(shape):
        arguments = copy.deepcopy({key: value for key, value in entry.request.items() if key != "quantity"})
        for path, (array, axes) in arrays.items():
            outer, _, inner = path.partition(".")
            whole = np.broadcast_to(array, (*shape, *array.shape[array.ndim - axes :]))
            element = _plain(whole[place].tolist())
            if inner:
                arguments[outer][inner] = element
            else:
                arguments[outer] = element
        value, error = entry.value[place], entry.error[place]
        for index in np.ndindex(value.shape):
            yield Row(entry, arguments, index, float(value[index]), float(error[index]))


def _plain(value: Any) -> Any:
    """Return numbers as JSON puts them."""
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return value if math.isfinite(value) else str(value)
