"""A program as an estimator: `draw(rng, n)` becomes a question over the pipe."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof.checks.subject import Precision
from fogproof.contracts import Draws, Reference
from fogproof.pipe.program import Program
from fogproof.pipe.sampler import LARGEST_SEED


def draws_of(rows: np.ndarray, columns: tuple[str, ...]) -> Draws:
    """Return rows (n, k) with named columns as `Draws`."""
    values = [i for i, each in enumerate(columns) if each == "value"]
    others = [rows[:, columns.index(name)] if name in columns else None for name in ("cost", "order", "stderr")]
    return Draws(rows[:, values[0]] if len(values) == 1 else rows[:, values], *others)


@dataclass(frozen=True, eq=False)
class PipeEstimator:
    """A program that answers "draw" with independent realisations, from uniforms or from the seed of the request."""

    program: Program
    dimensions: int | None
    precision: Precision
    parameters: Mapping[str, float]
    reference: Reference
    options: Mapping[str, Any] = field(default_factory=dict)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations."""
        columns = self.program.greeting.columns
        u = rng.random((n, self.dimensions or 0), dtype=self.precision)
        answer = self.program.ask("draw", u, n, len(columns), int(rng.integers(LARGEST_SEED)), self.parameters)
        return draws_of(answer, columns)
