"""Errors of estimators: of the mean, of single realisations, of their independence, of variance and cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.catalogue import EstimatorCase
from fogproof.contracts import Draws, Reference
from fogproof.zoo.bug import Bug, Estimating
from fogproof.zoo.limits import mean_needed
from fogproof.zoo.mutants.mutation import Mutated, Mutation, mutants

Array = np.ndarray
BIAS = ("bias", "lost contribution")
_PILOT = 20_000


def _draws(result: Any) -> Draws:
    return result if isinstance(result, Draws) else Draws(np.asarray(result))


@dataclass(frozen=True)
class OfValues:
    """The estimator with changed values.

    change  (values, generator) -> changed values
    needed  whether the error is one of the mean alone, which a test of means must see against the spread
    """

    change: Callable[[Array, np.random.Generator], Array]
    needed: bool = True

    def __call__(self, case: EstimatorCase) -> Mutated | None:
        """Plant it."""
        right = case.make()
        if isinstance(case.reference, dict):
            return None

        def draw(rng: np.random.Generator, n: int) -> Draws:
            draws = _draws(right.draw(rng, n))
            return Draws(self.change(np.asarray(draws.value), rng), draws.cost, draws.order, draws.stderr)

        return Mutated(Estimating(draw), lambda: self._needed(case) if self.needed else 1.0)

    def _needed(self, case: EstimatorCase) -> float:
        rng = np.random.default_rng(1)
        value = np.asarray(_draws(case.make().draw(rng, min(_PILOT, case.samples))).value, dtype=float)
        changed = np.asarray(self.change(value.copy(), rng), dtype=float)
        shift, variance = np.atleast_1d(np.mean(changed - value, axis=0)), np.atleast_1d(np.var(value, axis=0))
        return min(mean_needed(float(s), float(v)) for s, v in zip(shift, variance, strict=True))


def _lost(value: Array, rng: np.random.Generator) -> Array:
    gone = rng.random(len(value)) < 0.05
    return np.where(gone.reshape(-1, *[1] * (value.ndim - 1)), 0.0, value)


def _nan(value: Array, rng: np.random.Generator) -> Array:
    wrong = np.array(value, dtype=float)
    wrong[rng.random(len(value)) < 1e-3] = np.nan
    return wrong


def _clipped(case: EstimatorCase) -> Mutated | None:
    """Fireflies are cut at twice the mean."""
    reference = case.reference() if callable(case.reference) else case.reference
    if isinstance(reference, dict):
        return None
    most = 2 * np.abs(np.asarray(Reference.of("reference", reference).value))
    return OfValues(lambda value, rng: np.minimum(value, most))(case)


def _repeated(case: EstimatorCase) -> Mutated | None:
    right = case.make()

    def draw(rng: np.random.Generator, n: int) -> Draws:
        half = _draws(right.draw(rng, (n + 1) // 2))
        parts: list[Any] = [None if part is None else np.repeat(part, 2, axis=0)[:n] for part in half]
        return Draws(*parts)

    few = np.asarray(_draws(right.draw(np.random.default_rng(1), 64)).value)
    varies = bool(np.any(np.ptp(few, axis=0) > 1e-12 * np.abs(few).max()))
    return Mutated(Estimating(draw), equal=not varies)


def _costly(case: EstimatorCase) -> Mutated | None:
    if case.cost is None:
        return None
    right = case.make()

    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = _draws(right.draw(rng, n))
        return draws._replace(cost=None if draws.cost is None else 1.1 * np.asarray(draws.cost))

    return Mutated(Estimating(draw))


def _wide(case: EstimatorCase) -> Mutated | None:
    if case.variance is None or isinstance(case.reference, dict):
        return None
    reference = case.reference() if callable(case.reference) else case.reference
    mean = np.asarray(Reference.of("reference", reference).value)
    variance = case.variance()
    if not np.any(np.asarray(Reference.of("variance", variance).value) > 0):
        return None
    mutated = OfValues(lambda value, rng: mean + 1.2 * (value - mean), needed=False)(case)
    return None if mutated is None else Mutated(mutated.subject, lambda: _variance_needed(case, 1.44))


def _variance_needed(case: EstimatorCase, factor: float) -> float:
    """Return the samples for the mean of squares to show that the variance is wrong by a factor."""
    value = np.asarray(_draws(case.make().draw(np.random.default_rng(1), min(_PILOT, case.samples))).value, dtype=float)
    square = np.atleast_2d(((value - value.mean(axis=0)) ** 2).T)
    return min(mean_needed((factor - 1) * float(s.mean()), factor**2 * float(s.var())) for s in square)


DEPENDENT = ("correlation", "repeated samples", "dependent samples")
MUTATIONS: tuple[Mutation[EstimatorCase], ...] = (
    Mutation("bright", "values are 2 % too large", BIAS, OfValues(lambda value, rng: 1.02 * value)),
    Mutation("dark", "values are 2 % too small", BIAS, OfValues(lambda value, rng: 0.98 * value)),
    Mutation("lost", "one realisation in twenty is lost", BIAS, OfValues(_lost)),
    Mutation("clipped", "fireflies are cut at twice the mean", BIAS, _clipped),
    Mutation("not-finite", "one realisation in a thousand is no number", ("not a number",), OfValues(_nan, False)),
    Mutation("repeated", "every realisation is returned twice", DEPENDENT, _repeated),
    Mutation("costly", "the cost is 10 % too large", ("wrong cost",), _costly),
    Mutation("wide", "the spread is 20 % too large", ("wrong variance", "outside the domain"), _wide),
)


def bugs() -> list[Bug]:
    """Return each error in each estimator of the catalogue."""
    return mutants(EstimatorCase, MUTATIONS)
