"""Many requests at once: those that differ in their numbers alone become one call of the oracle on arrays.

Requests belong together if they ask for the same quantity, have equal arguments apart from arrays (and rays, which are made of
arrays), and arrays of the same shapes. They are stacked along a new first axis, which every quantity broadcasts over. If the
call fails, because one of them is bad, the batch is halved until the bad one stands alone: it costs its own answer, no other.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fogproof.errors import FogproofError
from fogproof.oracle.answers import (
    PROTOCOL,
    answer_or_failure,
    described,
    evaluate,
    failure,
    json_numbers,
    read_arguments,
    to_json,
)
from fogproof.oracle.limits import Limits
from fogproof.oracle.requests import read_request
from fogproof.quantities import Quantity, quantities
from fogproof.scene import Ray

MOST_NUMBERS = 64
"""In one array of a request; a larger one is worth a call of its own."""


class Reply(NamedTuple):
    """One line of JSON, and whether it answers its request."""

    text: str
    good: bool


class _Stack(NamedTuple):
    """What the requests of a batch have in common: key, and the shape of each array they give."""

    key: Any
    shapes: dict[str, tuple[int, ...]]


def answer_lines(lines: list[str], rigorous: bool, limits: Limits) -> Iterator[Reply]:
    """Yield the reply to each request, in order, as soon as it is known."""
    answers: dict[int, Reply] = {}
    requests: dict[int, Any] = {}
    stacks: dict[int, _Stack] = {}
    batches: dict[Any, list[int]] = {}
    for i, line in enumerate(lines):
        try:
            requests[i] = read_request(line)
        except FogproofError as error:
            answers[i] = Reply(to_json(failure(error)), False)
            continue
        stack = None if rigorous else _stack(requests[i])
        if stack:
            stacks[i] = stack
            batches.setdefault(stack.key, []).append(i)
    for i in range(len(lines)):
        if i not in answers and i in stacks:
            batch = batches[stacks[i].key]
            found = _answer_batch([requests[j] for j in batch], stacks[i].shapes, limits)
            answers |= zip(batch, found, strict=True)
        elif i not in answers:
            answers[i] = _answer_alone(requests[i], limits, rigorous)
        yield answers.pop(i)


def _stack(request: Any) -> _Stack | None:
    """Return what a request has in common with those it can be answered with; None if it must be answered alone."""
    name = request.get("quantity") if isinstance(request, dict) else None
    known = quantities().get(name) if isinstance(name, str) else None
    if known is None or known.of:
        return None
    rest = {key: value for key, value in request.items() if key != "id"}
    shapes: dict[str, tuple[int, ...]] = {}
    for path, mark in known.arrays.items():
        outer, _, inner = path.partition(".")
        if mark.table or outer not in rest:
            continue
        if inner:
            ray = rest[outer]
            if not isinstance(ray, dict):
                return None
            if inner not in ray:
                continue
            value = ray[inner]
            rest[outer] = {key: item for key, item in ray.items() if key != inner}
        else:
            value = rest.pop(outer)
        shape = _shape(value)
        if shape is None or len(shape) < mark.axes:
            return None
        shapes[path] = shape
    return _Stack((*shapes.items(), json.dumps(rest, sort_keys=True)), shapes)


def _shape(value: Any) -> tuple[int, ...] | None:
    """Return the shape of a small regular array of JSON numbers, None for anything else."""
    if type(value) is float or value in ("inf", "-inf"):
        return ()
    if type(value) is int:
        return () if abs(value) < 1 << 1023 else None
    if not isinstance(value, list) or not 0 < len(value) <= MOST_NUMBERS:
        return None
    inner = _shape(value[0])
    if inner is None or any(_shape(item) != inner for item in value[1:]):
        return None
    return (len(value), *inner)


def _answer_alone(request: Any, limits: Limits, rigorous: bool = False) -> Reply:
    reply = answer_or_failure(request, rigorous, limits)
    return Reply(to_json(reply), "value" in reply)


def _answer_batch(requests: list[dict[str, Any]], shapes: dict[str, tuple[int, ...]], limits: Limits) -> list[Reply]:
    """Answer requests of one stack, halving it where that fails."""
    if len(requests) == 1:
        return [_answer_alone(requests[0], limits)]
    try:
        return _answer_stacked(requests, shapes, limits)
    except (FogproofError, MemoryError, ArithmeticError, ValueError, TypeError, LookupError):
        half = len(requests) // 2
        return [line for part in (requests[:half], requests[half:]) for line in _answer_batch(part, shapes, limits)]


def _answer_stacked(requests: list[dict[str, Any]], shapes: dict[str, tuple[int, ...]], limits: Limits) -> list[Reply]:
    quantity, arguments = read_arguments(requests[0])
    if not shapes:  # the same question again
        arrays = {}
        value, error, reference = evaluate(quantity, arguments, limits)
        value, error = (np.broadcast_to(x, (len(requests), *x.shape)) for x in (value, error))
    else:
        arrays = _stacked(quantity, requests, shapes)
        for name in [name for name in arrays if "." not in name]:
            arguments[name] = arrays.pop(name)
        for outer in {path.partition(".")[0] for path in arrays}:
            arguments[outer] = Ray(**{path.partition(".")[2]: array for path, array in arrays.items()})
        value, error, reference = evaluate(quantity, arguments, limits)
        if value.shape[:1] != (len(requests),):
            raise ValueError("a quantity that does not broadcast")
    good = ~(np.isnan(value) | np.isnan(error)).reshape(len(requests), -1).any(axis=1)
    values, errors = (
        json_numbers(np.where(np.isnan(value), 0.0, value)),
        json_numbers(np.where(np.isnan(error), 0.0, error)),
    )
    tail = json.dumps(described(quantity, reference))[1:]
    replies = []
    for i, request in enumerate(requests):
        if not good[i]:
            replies.append(_answer_alone(request, limits))
            continue
        named = f'"id": {json.dumps(request["id"])}, ' if "id" in request else ""
        numbers = f'"value": {json.dumps(values[i])}, "error": {json.dumps(errors[i])}'
        text = f'{{"protocol": "{PROTOCOL}", {named}"quantity": "{quantity.name}", {numbers}, {tail}'
        replies.append(Reply(text, True))
    return replies


def _stacked(
    quantity: Quantity, requests: list[dict[str, Any]], shapes: dict[str, tuple[int, ...]]
) -> dict[str, np.ndarray]:
    """Return the arrays of all requests along a new first axis, with axes of length 1 where others have more."""
    axes = {path: len(shape) - quantity.arrays[path].axes for path, shape in shapes.items()}
    most = max(axes.values())
    stacked = {}
    for path, shape in shapes.items():
        outer, _, inner = path.partition(".")
        values = [request[outer][inner] if inner else request[outer] for request in requests]
        flat = [float(x) for x in values] if shape == () else [x for value in values for x in _flat(value)]
        stacked[path] = np.array(flat).reshape(len(requests), *(1,) * (most - axes[path]), *shape)
    return stacked


def _flat(value: Any) -> Iterator[float]:
    if isinstance(value, list):
        for item in value:
            yield from _flat(item)
    else:
        yield float(value)
