"""`check_mis`: are the weights of multiple importance sampling a partition of unity, and those of the strategies' densities?

Both are identities of functions, so they are looked at point by point, on points that the strategies themselves draw: there is no
noise. Weights made of densities in another measure (area for solid angle) sum to one all the same; the second identity finds them.
What no point met may be wrong: the resolution says how rare that is.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.checks.arguments import samples_of, seed_of, whole
from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.draws import as_array
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Precision, call, numbers
from fogproof.checks.verdict import Finding, Resolution, Verdict
from fogproof.contracts import Draw
from fogproof.errors import InvalidValueError, SubjectError, shorten
from fogproof.validate import as_float_array, number

_ROUNDING: dict[Precision, float] = {"float64": 1e-9, "float32": 1e-3}


def check_mis(
    strategies: Sequence[Any],
    weights: Callable[[np.ndarray], Any] | Sequence[Callable[[np.ndarray], Any]],
    *,
    counts: Sequence[float] | None = None,
    exponent: float | None = 1.0,
    precision: Precision = "float64",
    samples: int = 10_000,
    seed: int | None = None,
) -> Verdict:
    """Test the weights of multiple importance sampling (Veach & Guibas 1995) on common points; nothing about it is statistical.

    strategies  samplers with `sample(u)`, `pdf(x)` and `dimensions`, or tuples of these three; on one domain and in one measure;
                `sample(rng, n)` where `dimensions` is None
    weights     x -> (n, strategies), or one function x -> (n,) for each strategy
    counts      samples taken with each strategy, equal by default
    exponent    of the power heuristic, w_i ~ (n_i p_i)^exponent: 1 is the balance heuristic; None asks for a sum of one alone
    precision   "float32": weights or densities are computed in single precision
    samples     points of each strategy
    seed        any whole number; None draws a fresh one, which the verdict states

    >>> uniform = (lambda u: u[:, 0], lambda x: np.ones(len(x)), 1)
    >>> linear = (lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, 1)
    >>> check_mis([uniform, linear], lambda x: np.stack([1 / (1 + 2 * x), 2 * x / (1 + 2 * x)], axis=-1)).outcome
    'not rejected'
    """
    started = time.perf_counter()
    samples, seed = samples_of(samples, 1), seed_of(seed)
    if len(strategies) < 2:
        raise InvalidValueError("strategies", "must be at least two", len(strategies))
    shares = np.ones(len(strategies)) if counts is None else as_float_array("counts", counts)
    if shares.shape != (len(strategies),) or not (shares > 0).all():
        raise InvalidValueError("counts", "must be one number > 0 for each strategy", counts)
    if exponent is not None:
        number(
            "exponent", exponent, "must be > 0 and finite", 0, open_ends=True, fix="None asks for a sum of one alone"
        )
    techniques = [_Technique.of(i, strategy) for i, strategy in enumerate(strategies)]
    drawn = [technique.points(batch_generator(seed, "mis", i, 0), samples) for i, technique in enumerate(techniques)]
    if len({x.shape[1:] for x in drawn}) > 1:
        raise SubjectError("strategies must sample points of one domain", "strategies")
    x = np.concatenate(drawn)
    densities = np.stack([technique.density(x) for technique in techniques], axis=-1)
    given = _weights(weights, x, len(techniques))
    findings = [
        _densities(densities, x, samples),
        *_weighing(given, densities, x, shares, exponent, _ROUNDING[precision]),
    ]
    seconds = time.perf_counter() - started
    reproduce = f"check_mis(..., samples={samples}, seed={seed})"
    return Verdict(tuple(findings), 0.0, len(x), seed, seconds, {}, likely_cause(findings), reproduce)


@dataclass(frozen=True)
class _Technique:
    index: int
    sample: Callable[[np.ndarray], Any]
    pdf: Callable[[np.ndarray], Any]
    dimensions: int | None

    @staticmethod
    def of(index: int, strategy: Any) -> _Technique:
        tuples = isinstance(strategy, tuple) and len(strategy) == 3
        if not tuples and not all(hasattr(strategy, name) for name in ("sample", "pdf", "dimensions")):
            rule = "must have sample(u), pdf(x) and dimensions, or be a tuple of them"
            raise InvalidValueError(f"strategies[{index}]", rule, strategy)
        sample, pdf, k = strategy if tuples else (strategy.sample, strategy.pdf, strategy.dimensions)
        if k is not None:
            k = whole(f"strategies[{index}].dimensions", k, 1)
        return _Technique(index, sample, pdf, k)

    def points(self, rng: np.random.Generator, n: int) -> np.ndarray:
        what = f"strategies[{self.index}].sample(u)"
        given = (rng, n) if self.dimensions is None else (rng.random((n, self.dimensions)),)
        result = call(what, self.sample, *given)
        draw = result if isinstance(result, Draw) else Draw(result)
        x = as_array(what, draw.x)
        return x if draw.valid is None else x[np.asarray(draw.valid, dtype=bool)]

    def density(self, x: np.ndarray) -> np.ndarray:
        what = f"strategies[{self.index}].pdf(x)"
        with np.errstate(all="ignore"):
            return numbers(what, call(what, self.pdf, x), (len(x),))


def _weights(weights: Any, x: np.ndarray, k: int) -> np.ndarray:
    with np.errstate(all="ignore"):
        if callable(weights):
            return numbers("weights(x)", call("weights(x)", weights, x), (len(x), k))
        if len(weights) != k:
            raise InvalidValueError("weights", f"must be one function for each of {k} strategies", len(weights))
        columns = [
            numbers(f"weights[{i}](x)", call(f"weights[{i}](x)", w, x), (len(x),)) for i, w in enumerate(weights)
        ]
        return np.stack(columns, axis=-1)


def _densities(densities: np.ndarray, x: np.ndarray, samples: int) -> Finding:
    good = np.isfinite(densities) & (densities >= 0)
    good[:, :] &= densities.max(axis=1, initial=0.0)[:, None] > 0
    message = "densities are finite, and one is positive at every point"
    return _pointwise("densities", good.all(axis=1), densities, x, message, "wrong formula")


def _weighing(
    given: np.ndarray, densities: np.ndarray, x: np.ndarray, counts: np.ndarray, exponent: float | None, slack: float
) -> list[Finding]:
    total = given.sum(axis=1)
    sums = np.abs(total - 1) <= slack
    nowhere = (densities > 0) | (given == 0)
    findings = [
        _pointwise("sum of weights", sums, total[:, None], x, f"weights sum to one within {slack:g}", "wrong weight"),
        _pointwise(
            "weights without samples",
            nowhere.all(axis=1),
            given,
            x,
            "weights vanish where densities do",
            "wrong weight",
        ),
    ]
    if exponent is None:
        return findings
    with np.errstate(all="ignore"):
        scaled = densities * counts
        powers = (scaled / scaled.max(axis=1, keepdims=True)) ** exponent
        expected = powers / powers.sum(axis=1, keepdims=True)
    same = ~(np.abs(given - expected) > slack) & np.isfinite(given)
    for i in range(given.shape[1]):
        pair = np.stack([given[:, i], expected[:, i]], axis=-1)
        message = f"weights of strategy {i} are those of the densities within {slack:g}"
        findings.append(_pointwise(f"weights of strategy {i}", same[:, i], pair, x, message, "wrong weight"))
    return findings


def _pointwise(name: str, good: np.ndarray, values: np.ndarray, x: np.ndarray, message: str, cause: str) -> Finding:
    """Return what was found at the points x, of which `good` are right.

    That no point lies in a part of the domain which holds a share s of the points of all strategies together has probability
    (1 - s)^n at most.
    """
    wrong = np.flatnonzero(~good)
    if not len(wrong):
        resolution = (
            Resolution(f"share of points with wrong {name}", -math.expm1(math.log(MISS) / len(x)), MISS)
            if len(x)
            else None
        )
        return Finding(name, "not rejected", message, effect=0.0, resolution=resolution)
    worst = wrong[0]
    said = " against ".join(f"{value:.9g}" for value in values[worst])
    message = f"{len(wrong)} of {len(x)} points: {said} at {shorten(x[worst])}"
    return Finding(name, "rejected", message, effect=len(wrong) / len(x), cause=cause)
