"""One request to one answer, whatever the request: a value with its error bound, or an error with code, message and path."""

from __future__ import annotations

import json
from functools import partial
from typing import Any

import numpy as np

from fogproof.contracts import Reference
from fogproof.errors import (
    FogproofError,
    InternalError,
    InvalidInputError,
    TooLargeError,
    UnsupportedError,
    shorten,
)
from fogproof.oracle.limits import Limits, require_size, within
from fogproof.oracle.requests import read_request
from fogproof.quantities import Quantity, quantities
from fogproof.scene.files import read_fields

PROTOCOL = "fogproof/oracle/1"


def answer(request: Any, rigorous: bool = False, limits: Limits | None = None) -> dict[str, Any]:
    """Answer one request; raises `FogproofError` for a bad one. Value and error are arrays.

    rigorous  answer with an enclosure proven by ball arithmetic, whatever the request says
    """
    quantity, arguments = read_arguments(request, rigorous)
    value, error, reference = evaluate(quantity, arguments, limits or Limits())
    require_numbers(quantity, value, error)
    return {
        "protocol": PROTOCOL,
        **({"id": request["id"]} if "id" in request else {}),
        "quantity": quantity.name,
        "value": value,
        "error": error,
        **described(quantity, reference),
    }


def answer_text(text: str, rigorous: bool = False, limits: Limits | None = None) -> dict[str, Any]:
    """Answer a request given as JSON text: the answer, or `{"error": {"code", "message", "path"}}`."""
    try:
        request = read_request(text)
    except FogproofError as error:
        return failure(error)
    return answer_or_failure(request, rigorous, limits)


def answer_or_failure(request: Any, rigorous: bool = False, limits: Limits | None = None) -> dict[str, Any]:
    """Answer one request; whatever goes wrong costs this answer alone."""
    try:
        return answer(request, rigorous, limits)
    except FogproofError as error:
        return failure(error, request)
    except MemoryError:
        return failure(TooLargeError("the answer needs more memory than there is"), request)
    except Exception as error:
        told = f"{type(error).__name__}: {shorten(str(error), 200)}"
        return failure(InternalError(f"a fault of fogproof, please report it with the request: {told}"), request)


def failure(error: FogproofError, request: Any = None) -> dict[str, Any]:
    """Return the answer to a request that has none."""
    named = {"id": request["id"]} if isinstance(request, dict) and "id" in request else {}
    return {"protocol": PROTOCOL, **named, "error": error.to_dict()}


def described(quantity: Quantity, reference: Reference) -> dict[str, str]:
    """Return what an answer says about its numbers."""
    return {
        "unit": quantity.unit,
        "convention": quantity.convention,
        "method": reference.method,
        "source": reference.source,
    }


def read_arguments(request: Any, rigorous: bool = False) -> tuple[Quantity, dict[str, Any]]:
    """Return the quantity a request asks for, and the arguments of its function."""
    if not isinstance(request, dict):
        raise InvalidInputError(f"request: must be a JSON object, got {shorten(request)}")
    if "quantity" not in request:
        raise InvalidInputError(f"request: quantity is missing; known are {', '.join(quantities())}", "quantity")
    name = request["quantity"]
    known = quantities().get(name) if isinstance(name, str) else None
    if known is None:
        raise InvalidInputError(
            f"request: quantity {shorten(name)} is not known; known are {', '.join(quantities())}", "quantity"
        )
    arguments = {key: value for key, value in request.items() if key not in ("quantity", "id")}
    if rigorous:
        if "rigorous" not in known.arguments:
            proven = [name for name, quantity in quantities().items() if "rigorous" in quantity.arguments]
            raise UnsupportedError(f"{name} has no proven enclosure; {', '.join(proven)} have", "quantity")
        arguments["rigorous"] = True
    read = read_fields(known.arguments, arguments, "request")
    return known, {**read, "of": _asked(read["of"])} if known.of else read


def _asked(request: Any) -> tuple[Quantity, dict[str, Any]]:
    """Return what the request inside a request asks for."""
    known = quantities().get(str(request.get("quantity")))
    if known is not None and known.of:
        raise UnsupportedError(f"{known.name} asks about a quantity and is none that can be asked about", "of.quantity")
    try:
        inner, arguments = read_arguments(request)
    except FogproofError as error:
        error.path = f"of.{error.path}".rstrip(".")
        raise
    return inner, arguments


def evaluate(quantity: Quantity, arguments: dict[str, Any], limits: Limits) -> tuple[np.ndarray, np.ndarray, Reference]:
    """Return value and error of one shape, without negative zeros, and the reference they come from."""
    require_size(quantity, arguments, limits.values)
    if quantity.of:
        asked, given = arguments["of"]
        require_size(asked, given, limits.values)
    with np.errstate(all="ignore"):
        reference = within(limits.seconds, partial(quantity.function, **arguments))
    value, error = np.broadcast_arrays(np.asarray(reference.value), np.asarray(reference.error))
    return np.asarray(value + 0.0), np.asarray(error + 0.0), reference


def require_numbers(quantity: Quantity, value: np.ndarray, error: np.ndarray) -> None:
    """Refuse an answer with a NaN in it: a question that has no value is no answer."""
    bad = np.isnan(value) | np.isnan(error)
    if bad.any():
        at = f" at index {[int(i) for i in np.argwhere(bad)[0]]}" if bad.ndim else ""
        raise UnsupportedError(f"{quantity.name} has no value there{at}: {bad.sum()} of {bad.size} do not exist")


def to_json(reply: dict[str, Any]) -> str:
    """Return an answer or failure as one line of JSON, infinite numbers as strings."""
    numbers = {key: json_numbers(item) for key, item in reply.items() if isinstance(item, np.ndarray)}
    return json.dumps({**reply, **numbers}, allow_nan=False)


def json_numbers(array: np.ndarray) -> Any:
    """Return an array as nested lists, infinite numbers as strings."""
    if np.isfinite(array).all():
        return array.tolist()
    return _with_names(array.tolist())


def _with_names(value: Any) -> Any:
    if isinstance(value, list):
        return [_with_names(item) for item in value]
    return value if abs(value) < float("inf") else str(value)
