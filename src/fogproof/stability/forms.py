"""Calling what takes plain numbers for some of its arguments with arrays of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.contracts import Reference
from fogproof.stability.formula import Evaluate


def each(*names: str) -> Callable[[Callable[..., Any]], Evaluate]:
    """Return a decorator: the function gets the named arguments as floats, once for each of their values, the rest as arrays."""

    def decorate(function: Callable[..., Any]) -> Evaluate:
        def evaluate(**arguments: np.ndarray) -> np.ndarray | Reference:
            keys = np.stack([np.asarray(arguments[name], float) for name in names], axis=1)
            rest = {name: values for name, values in arguments.items() if name not in names}
            different, which = np.unique(keys, axis=0, return_inverse=True)
            value: np.ndarray | None = None
            error: np.ndarray | None = None
            for k, key in enumerate(different):
                at = np.flatnonzero(which.reshape(-1) == k)
                plain = dict(zip(names, map(float, key), strict=True))
                answer = function(**plain, **{name: values[at] for name, values in rest.items()})
                found = answer.value if isinstance(answer, Reference) else np.asarray(answer)
                value = np.empty(len(keys), found.dtype) if value is None else value
                value[at] = found
                if isinstance(answer, Reference):
                    error = np.empty(len(keys)) if error is None else error
                    error[at] = answer.error
            assert value is not None
            return value if error is None else Reference(value, error, "", "")

        evaluate.__name__ = function.__name__
        return evaluate

    return decorate
