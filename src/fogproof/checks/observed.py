"""All that is remembered of an estimator's draws, however many there are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fogproof.checks.json_values import jsonable
from fogproof.checks.quantities import CheckedQuantity, column
from fogproof.checks.statistics.coverage import Coverage
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.succession import Succession
from fogproof.contracts import Draws

_TRACE = 12  # points of the running mean kept for the figure


@dataclass(frozen=True)
class Observed:
    """What was drawn so far.

    quantities  what is measured, the means of the values first
    moments     of each quantity and channel
    succession  how realisations follow each other
    coverage    of reported standard errors
    trace       running mean and standard error
    labels      orders that have a reference, None if orders do not matter
    unlisted    other orders: how many realisations, and the sum of their absolute values
    n, bad      how many realisations, and how many that are not finite
    """

    quantities: list[CheckedQuantity]
    moments: tuple[tuple[Moments, ...], ...]
    succession: Succession
    coverage: Coverage = field(default_factory=Coverage)
    trace: tuple[tuple[int, list[float], list[float]], ...] = ()
    labels: frozenset[int] | None = None
    unlisted: dict[float, tuple[int, float]] = field(default_factory=dict)
    n: int = 0
    bad: int = 0

    @staticmethod
    def of(quantities: list[CheckedQuantity], first: Draws, labels: frozenset[int] | None = None) -> Observed:
        """Return the empty record of an estimator whose first batch is given."""
        empty = tuple(tuple(Moments() for _ in q.value) for q in quantities)
        finite = first.value[np.isfinite(first.value).all(axis=1)]
        return Observed(quantities, empty, Succession.about(finite), labels=labels)

    def after(self, draws: Draws, sizes: Sequence[int]) -> Observed:
        """Return the record after one more batch, drawn in calls of these sizes."""
        n = sum(sizes)
        bad = int(np.count_nonzero(~usable(draws)))
        if bad or self.bad:
            return replace(self, n=self.n + n, bad=self.bad + bad)
        moments = tuple(
            tuple(
                old.merged(Moments.of(np.ascontiguousarray(x))) for old, x in zip(olds, q.numbers(draws).T, strict=True)
            )
            for q, olds in zip(self.quantities, self.moments, strict=True)
        )
        coverage = self.coverage
        if draws.stderr is not None and self.labels is None:
            mean = self.quantities[0]
            coverage = coverage.after(draws.value, column(draws.stderr), mean.value, mean.error)
        means = moments[0]
        trace = (*self.trace, (self.n + n, [m.mean for m in means], [m.stderr for m in means]))
        return replace(
            self,
            moments=moments,
            coverage=coverage,
            succession=self.succession.after(draws.value, sizes),
            trace=trace,
            unlisted=self._unlisted(draws),
            n=self.n + n,
        )

    def _unlisted(self, draws: Draws) -> dict[float, tuple[int, float]]:
        if self.labels is None or draws.order is None:
            return self.unlisted
        found = dict(self.unlisted)
        orders = np.asarray(draws.order, dtype=np.float64).reshape(len(draws.value))
        for label in np.unique(orders):
            if label not in self.labels:
                here = np.isnan(orders) if np.isnan(label) else orders == label
                count, size = found.get(float(label), (0, 0.0))
                total = float(np.sum(np.abs(draws.value[here])))
                found[float(label)] = (count + int(np.count_nonzero(here)), size + total)
        return found

    def figure(self, channel: int) -> dict[str, Any]:
        """Return the data of a plot of the running mean, at counts that grow by about a constant factor."""
        picks = np.unique(np.geomspace(1, len(self.trace), _TRACE).astype(int)) - 1
        rows = [self.trace[i] for i in picks]
        columns = {
            "n": [r[0] for r in rows],
            "mean": [r[1][channel] for r in rows],
            "stderr": [r[2][channel] for r in rows],
        }
        mean = self.quantities[0]
        return jsonable({"kind": "mean", "reference": mean.value[channel], "error": mean.error[channel], **columns})


def usable(draws: Draws) -> np.ndarray:
    """Return (n,) which realisations are finite in everything they report; a standard error is not negative either."""
    good = np.isfinite(draws.value).all(axis=1)
    for part, least in ((draws.cost, -np.inf), (draws.stderr, 0.0)):
        if part is not None:
            columns = np.asarray(part, dtype=np.float64).reshape(len(good), -1)
            good &= (np.isfinite(columns) & (columns >= least)).all(axis=1)
    return good
