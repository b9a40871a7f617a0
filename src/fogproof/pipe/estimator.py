"""A program as an estimator: `draw(rng, n)` becomes a question over the pipe."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof.checks.subject import Precision
from fogproof.contracts import Draws, Reference
from fogproof.errors import InvalidInputError
from fogproof.pipe.program import Program
from fogproof.pipe.sampler import LARGEST_SEED
from fogproof.pipe.spec import Spec


def draws_of(rows: np.ndarray, columns: tuple[str, ...]) -> Draws:
    """Return rows (n, k) with named columns as `Draws`."""
    values = [i for i, each in enumerate(columns) if each == "value"]
    others = [rows[:, columns.index(name)] if name in columns else None for name in ("cost", "order", "stderr")]
    return Draws(rows[:, values[0]] if len(values) == 1 else rows[:, values], *others)


def by_order(reference: Reference, spec: Spec, columns: tuple[str, ...]) -> Reference | dict[int, Reference]:
    """Return the expectations as realisations of these columns are held to them: by order where both have orders.

    The orders of the oracle are in its last axis: after n = 0, 1, ... scatterings.
    """
    values, given = np.atleast_1d(reference.value), columns.count("value")
    if "order" in columns and str((spec.quantity or {}).get("quantity", "")).endswith("_orders"):
        errors = np.broadcast_to(reference.error, values.shape)
        return {k: Reference(value, error) for k, (value, error) in enumerate(zip(values, errors, strict=True))}
    if len(values) not in (1, given):
        fix = "one a channel, or, of orders, one with a column order"
        raise InvalidInputError(
            f"there are {given} columns value, and {len(values)} expectations; write {fix}", "columns"
        )
    return reference


@dataclass(frozen=True, eq=False)
class PipeEstimator:
    """A program that answers "draw" with independent realisations, from uniforms or from the seed of the request."""

    program: Program
    dimensions: int | None
    precision: Precision
    parameters: Mapping[str, float]
    reference: Reference | dict[int, Reference]
    options: Mapping[str, Any] = field(default_factory=dict)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations."""
        columns = self.program.greeting.columns
        u = rng.random((n, self.dimensions or 0), dtype=self.precision)
        answer = self.program.ask("draw", u, n, len(columns), int(rng.integers(LARGEST_SEED)), self.parameters)
        return draws_of(answer, columns)
