"""`check_estimator`: is the mean of an estimator its reference, and are variance, cost and standard errors what theory says?

Means are tested exactly where they can be, by Student's law where skewness allows it, by what is declared of the values, whatever
their law; where none of them can tell, or the variance may be infinite, the verdict is inconclusive and says what would decide.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import islice
from typing import Any, Literal

import numpy as np

from fogproof.checks.arguments import alpha_of, bounds_of, samples_of, seed_of, tolerance_of
from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.draws import Source, count_of
from fogproof.checks.escalation import stages
from fogproof.checks.judgement import Judgement, judged
from fogproof.checks.mean_claim import Again
from fogproof.checks.observed import Observed
from fogproof.checks.quantities import Declared, column, quantities_of
from fogproof.checks.streams import batch_sizes, growing_sizes
from fogproof.checks.subject import UNIT_ROUNDOFF, Precision
from fogproof.checks.verdict import Finding, Verdict
from fogproof.contracts import Reference
from fogproof.doing import doing
from fogproof.errors import InvalidValueError
from fogproof.validate import number

Known = Mapping[int, Reference | float]


def check_estimator(
    draw: Callable[[np.random.Generator, int], Any] | Any,
    reference: Reference | float | Known,
    *,
    variance: Reference | float | None = None,
    cost: Reference | float | None = None,
    bounds: tuple[float, float] | None = None,
    nonnegative: bool = False,
    tails: Literal["unknown", "light"] = "unknown",
    tolerance: float | tuple[float, float] = 0.0,
    precision: Precision = "float64",
    resolution: float | None = None,
    samples: int = 1_000_000,
    alpha: float = 1e-6,
    seed: int | None = None,
) -> Verdict:
    """Test that an estimator's expectation is the reference; every sub-check shares one false-alarm probability `alpha`.

    draw         `draw(rng, n)` -> (n,) or (n, channels) independent realisations, or `Draws`; where these hold standard errors,
                 their squares must be right on average, and intervals of two of them must hold the reference. Or the
                 realisations themselves, if they are already there: an array (pixels, a file), or `Draws`
    reference    its expectation, () or (channels,): a number, or a `Reference` with an error bound that is counted; or
                 {label: expectation} of the contributions of each `Draws.order` (scattering orders, or strategies)
    variance     the exact variance of one realisation, tested as the mean of (X - reference)^2; 0 declares that there is none
    cost         the exact expectation of `Draws.cost`
    bounds       (low, high): no realisation lies outside. Decides whatever the law, also for a few or equal realisations
    nonnegative  no realisation is negative: the same as bounds=(0, inf), which decides where the mean is too large
    tails        "light": no heavier than those of the exponential law, so that a few realisations may be judged by Student's
                 test; averages of many paths are
    tolerance    what is still right: relative, or (relative, absolute); counted as an error of the reference
    precision    "float32": values are computed in single precision, and their rounding is no error
    resolution   a bias of this size, in the unit of the values, is small enough: the check ends as soon as it would have been
                 caught, and is inconclusive if it would not
    samples      most realisations; of those that are already there, all are judged
    alpha        false-alarm probability of this call with everything in it
    seed         any whole number; None draws a fresh one, which the verdict states

    >>> check_estimator(lambda rng, n: rng.random(n), 0.5, samples=10_000).outcome
    'not rejected'
    >>> check_estimator([0.0] * 100, 0.3, bounds=(0, 1)).outcome  # a black pixel
    'rejected'
    """
    started = time.perf_counter()
    alpha, seed = alpha_of(alpha), seed_of(seed)
    reference = _held(reference)
    count = count_of(draw)
    samples = samples_of(samples) if count is None else count
    if tails not in ("unknown", "light"):
        raise InvalidValueError("tails", 'must be "unknown" or "light"', tails)
    if precision not in UNIT_ROUNDOFF:
        raise InvalidValueError("precision", 'must be "float64" or "float32"', precision)
    near = tolerance_of(tolerance)
    within = bounds_of(bounds, nonnegative)
    declared = Declared(variance, cost, within, tails == "light", near, UNIT_ROUNDOFF[precision])
    labels = _labels_of(reference) if isinstance(reference, Mapping) else None
    sizes, looks = _looks(samples, alpha, resolution)
    source = Source(draw, seed, tuple(sizes), _channels_of(reference), "draws", precision)
    seen: Observed | None = None
    judgement, ordered = Judgement((), False), False
    for index, (draws, calls) in enumerate(source.batches()):
        if seen is None:
            stderr = None if draws.stderr is None else column(draws.stderr)
            seen = Observed.of(quantities_of(reference, declared, stderr), draws, labels)
        before, seen = seen.n, seen.after(draws, calls)
        ordered |= draws.order is not None
        doing(f"realisation {seen.n} of {samples} at most")
        due = [share for size, share in looks.items() if before < size <= seen.n]
        complete = seen.n == samples
        if seen.bad or due or complete:
            enough = resolution is not None or complete
            share = due[-1] if due else alpha
            judgement = judged(seen, _again(source, index + 1), samples, share, enough)
            if complete or judgement.final or _resolved(judgement, resolution):
                break
    assert seen is not None
    findings = list(judgement.findings)
    if resolution is not None:
        findings = [_unresolved(finding, resolution, seen.n) for finding in findings]
    settings: dict[str, Any] = {"channels": source.channels, "looks": list(looks)}
    settings |= _declared(declared, precision, resolution)
    name = "realisations" if source.finite else getattr(draw, "__qualname__", type(draw).__name__)
    reproduce = f"check_estimator({name}, ..., samples={samples}, alpha={alpha:g}, seed={seed})"
    seconds = time.perf_counter() - started
    cause = likely_cause(findings)
    untested = tuple(finding.message for finding in findings if finding.check == "other orders")
    untested += ("orders (give references by order, {label: expectation})",) if ordered and labels is None else ()
    return Verdict(tuple(findings), alpha, seen.n, seed, seconds, settings, cause, reproduce, unchecked=untested)


def _looks(samples: int, alpha: float, resolution: float | None) -> tuple[list[int], dict[int, float]]:
    """Return the sizes of batches, and the part of alpha that is spent at each number of samples that is looked at."""
    if resolution is None:
        return batch_sizes(samples), {look.samples: alpha for look in stages(samples, None, alpha, 1.0)}
    number("resolution", resolution, "must be > 0", 0, open_ends=True)
    sizes, ends = growing_sizes(samples)
    return sizes, dict.fromkeys(ends, alpha / len(ends))


def _held(reference: Reference | float | Known) -> Reference | dict[int, Reference]:
    """Return references with arrays of their own: what `draw` writes into the caller's changes nothing."""
    if isinstance(reference, Mapping):
        return {label: Reference.of("reference", one) for label, one in reference.items()}
    return Reference.of("reference", reference)


def _labels_of(reference: Known) -> frozenset[int]:
    """Return the orders that have a reference."""
    for label in reference:
        if not isinstance(label, int | np.integer):
            raise InvalidValueError("reference", "must have whole numbers as labels, those of Draws.order", label)
    return frozenset(reference)


def _again(source: Source, upto: int) -> Again:
    return lambda: islice(source.batches(), upto)


def _channels_of(reference: Reference | float | Known) -> int:
    given = list(reference.values()) if isinstance(reference, Mapping) else [reference]
    references = [Reference.of("reference", one) for one in given]
    if not references or any(one.value.size == 0 for one in references):
        raise InvalidValueError("reference", "must hold a value", reference)
    return max((np.broadcast(np.atleast_1d(r.value), r.error).size for r in references), default=1)


def _declared(declared: Declared, precision: Precision, resolution: float | None) -> dict[str, Any]:
    """Return what the verdict prints of what was allowed for and relied on."""
    said: dict[str, Any] = {}
    if declared.tolerance != (0.0, 0.0):
        said["tolerance"] = declared.tolerance
    if declared.bounds != (-np.inf, np.inf):
        said["bounds"] = declared.bounds
    if declared.light:
        said["tails"] = "light"
    if precision != "float64":
        said["precision"] = precision
    if resolution is not None:
        said["resolution"] = resolution
    return said


def _resolved(judgement: Judgement, resolution: float | None) -> bool:
    """Return whether the check may end because every mean is known as well as was asked for, or something was rejected."""
    if resolution is None:
        return False
    if any(finding.outcome == "rejected" for finding in judgement.findings):
        return True
    means = [f for f in judgement.findings if f.check.startswith("mean")]
    return all(f.outcome == "not rejected" and _reach(f) <= resolution for f in means)


def _unresolved(finding: Finding, resolution: float, n: int) -> Finding:
    undecided = (
        finding.check.startswith("mean") and finding.outcome == "not rejected" and finding.resolution is not None
    )
    if not undecided or _reach(finding) <= resolution:
        return finding
    more = np.ceil(n * (_reach(finding) / resolution) ** 2)
    message = f"{finding.message}; a bias of {resolution:.2g} would not have been caught yet: ask for about {more:.2g} samples"
    return replace(finding, outcome="inconclusive", message=message)


def _reach(finding: Finding) -> float:
    return np.inf if finding.resolution is None else finding.resolution.value
