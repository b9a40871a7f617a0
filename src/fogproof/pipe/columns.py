"""What the columns of a file of samples are: named by the spec, by the file itself, or all of a point."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fogproof.errors import InvalidInputError
from fogproof.pipe.spec import Spec


def columns_of(path: Path, spec: Spec, shape: tuple[int, ...], named: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of a file's columns: those of the spec, else its own, else those of bare points or values."""
    (rows, count), first = shape, "x" if spec.samples_points else "value"
    bare = int(np.prod(spec.domain.shape, dtype=int)) if spec.domain is not None else 1
    columns = spec.columns or named or (first,) * (count if not spec.samples_points else min(count, bare))
    if len(columns) != count:
        told = f"{len(columns)} are named" if spec.columns or named else f"a point has {bare}"
        fix = 'name them all in the spec, as in columns = ["x", "x", "x", "pdf"]'
        if rows == len(columns):
            fix = "transpose it: one sample a row"
        raise InvalidInputError(f"{path} has {count} columns, and {told}; {fix}", "columns")
    points = columns.count("x")
    for name in set(columns) - {"x", "weight", "value"}:
        if columns.count(name) > 1:
            raise InvalidInputError(f"{path} has {columns.count(name)} columns {name}; there is one at most", "columns")
    if spec.samples_points and points != bare:
        raise InvalidInputError(f"{path} has {points} columns x; a point of {spec.domain} has {bare}", "columns")
    if not spec.samples_points and "value" not in columns:
        raise InvalidInputError(f"{path} has no column value, but {', '.join(columns)}", "columns")
    return columns
