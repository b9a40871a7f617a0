"""`check_convergence`: do more samples make a program's estimate better, and never worse?

Sums in single precision stall after some ten million terms, counters overflow, generators begin again: estimates that are right
with few samples are wrong with many. Replicates at growing counts are held to the reference, or else to those at the other counts.
Replicates that are all equal are no law: what they may leave unseen is bounded by the scatter at the other counts.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.checks.arguments import alpha_of, seed_of, tolerance_of, whole
from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.draws import as_array
from fogproof.checks.statistics.extremes import extremes_p
from fogproof.checks.statistics.known import Declarable, Known
from fogproof.checks.statistics.light import light_tailed_reach
from fogproof.checks.statistics.means import DOUBT, mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Outcome, Verdict
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, SubjectError

_ROUNDING = 1e-12  # relative: of sums in another order
_PROGRESS = 1e-6  # relative: an error that falls by less has stalled
_DOUBT = 1e-4  # probability that the scatter of a right program is doubted: that is no false alarm
_GROWN = 10.0  # times all errors with fewer samples, two at least: no chance of a program whose seed is fixed
_LIGHT = Known(light=True, told="what check_convergence takes for granted")
_SAME = "all estimates from as many samples are equal: the program is not random, or disregards its generator"
_REPLICATES = Declarable(more="replicates")


def check_convergence(
    run: Callable[[np.random.Generator, int], Any],
    counts: Sequence[int],
    *,
    reference: Reference | float | None = None,
    tolerance: float | tuple[float, float] = 0.0,
    replicates: int = 32,
    alpha: float = 1e-6,
    seed: int | None = None,
) -> Verdict:
    """Test that estimates from more and more samples have one expectation, and scatter less and less.

    run         `run(rng, count)` -> the program's estimate from so many samples: a number, or (channels,)
    counts      numbers of samples, growing: up to what the program is used with
    reference   what the estimates converge to; without one, each count is held to the ones before it
    tolerance   what is still right: relative, or (relative, absolute)
    replicates  estimates at each count, whose law is taken to be no heavier than the exponential one
    alpha       false-alarm probability of this call with everything in it
    seed        any whole number; None draws a fresh one, which the verdict states

    >>> check_convergence(lambda rng, n: rng.random(n).mean(), [100, 1000], reference=0.5).outcome
    'not rejected'
    """
    started = time.perf_counter()
    alpha, seed, replicates = alpha_of(alpha), seed_of(seed), whole("replicates", replicates, 8)
    sizes = [whole("counts", count, 1) for count in counts]
    if len(sizes) < 2 or sorted(set(sizes)) != sizes:
        raise InvalidValueError("counts", "must be at least two numbers that grow", list(counts))
    rows = [_estimates(run, count, replicates, seed, index) for index, count in enumerate(sizes)]
    channels = rows[0].shape[1]
    if any(row.shape[1] != channels for row in rows):
        raise SubjectError("run must return as many channels at every count", "run")
    if reference is not None and np.size(Reference.of("reference", reference).value) not in (1, channels):
        rule = f"must be one number, or one for each of the {channels} channels that run returns"
        raise InvalidValueError("reference", rule, reference)
    finite = [np.isfinite(row) for row in rows]
    bad = [
        f"{np.count_nonzero(~good)} with {n} samples" for good, n in zip(finite, sizes, strict=True) if not good.all()
    ]
    constant = False
    if bad:
        findings = [
            Finding("finite values", "rejected", f"estimates are not finite: {', '.join(bad)}", cause="not a number")
        ]
    else:
        near = tolerance_of(tolerance)
        if constant := all(np.ptp(row, axis=0).max() == 0 for row in rows):
            findings = _not_random(rows, sizes, reference, near)
        else:
            findings = _levels(rows, sizes, reference, near, alpha)
            findings += _scatter(rows, sizes, _DOUBT)
    name = getattr(run, "__qualname__", type(run).__name__)
    reproduce = f"check_convergence({name}, {sizes}, ..., replicates={replicates}, alpha={alpha:g}, seed={seed})"
    total, seconds = replicates * sum(sizes), time.perf_counter() - started
    cause, unchecked = likely_cause(findings), (f"randomness ({_SAME})",) if constant else ()
    settings = {"counts": sizes}
    return Verdict(tuple(findings), alpha, total, seed, seconds, settings, cause, reproduce, unchecked=unchecked)


def _estimates(run: Callable[..., Any], count: int, replicates: int, seed: int, index: int) -> np.ndarray:
    rows = []
    for i in range(replicates):
        value = as_array(
            "run(rng, count)", call("run(rng, count)", run, batch_generator(seed, "convergence", index, i), count)
        )
        if value.ndim > 1:
            raise SubjectError(f"run must return a number or (channels,), got shape {value.shape}", "run")
        rows.append(np.atleast_1d(value).astype(np.float64))
    if len({len(row) for row in rows}) > 1:
        raise SubjectError("run must return as many channels every time", "run")
    return np.array(rows)


def _levels(
    rows: list[np.ndarray],
    sizes: list[int],
    reference: Reference | float | None,
    tolerance: tuple[float, float],
    alpha: float,
) -> list[Finding]:
    """Hold every count to the reference, or to the one before it and to the first."""
    channels = rows[0].shape[1]
    relative, absolute = tolerance
    jobs: list[tuple[str, str, tuple[int, ...], np.ndarray, np.ndarray, np.ndarray]] = []
    if reference is not None:
        one = Reference.of("reference", reference)
        value, error = (np.broadcast_to(part, (channels,)) for part in (one.value, one.error))
        for k in reversed(range(len(sizes))):  # the most samples first: they are what is used
            allowed = error + absolute + relative * np.abs(value)
            jobs.append((f"mean with {sizes[k]} samples", "mean", (k,), rows[k], value, allowed))
    else:
        for j, k in sorted({(k - 1, k) for k in range(1, len(sizes))} | {(0, len(sizes) - 1)}, reverse=True):
            slack = absolute + relative * np.abs(rows[j].mean(axis=0))
            name = f"{sizes[k]} against {sizes[j]} samples"
            jobs.append((name, "difference", (j, k), rows[k] - rows[j], np.zeros(channels), slack))
    share = alpha / (len(jobs) * channels)
    findings = []
    for name, what, at, numbers, value, error in jobs:
        for c in range(channels):
            label = f"{name}, channel {c}" if channels > 1 else name
            claim = float(value[c]), float(error[c])
            found = _level(label, what, numbers[:, c], claim, [row[:, c] for row in rows], sizes, at, share)
            if found.resolution is not None:  # each number of samples has its own
                found = replace(found, resolution=replace(found.resolution, kind=f"bias of {label}"))
            findings.append(found)
    return findings


def _level(
    name: str,
    what: str,
    numbers: np.ndarray,
    claim: tuple[float, float],
    rows: list[np.ndarray],
    sizes: list[int],
    at: tuple[int, ...],
    alpha: float,
) -> Finding:
    """Test that numbers, made of the estimates at the counts `at`, have the claimed expectation but for an error.

    Estimates that are all equal hide their scatter: they are held to the claim, or to others' mean, by that of other counts.
    """
    value, error = claim
    data = Moments.of(np.ascontiguousarray(numbers))
    data.values = None  # averages of many samples are no hits and misses, even if few of their values were met
    still = [k for k in at if rows[k].min() == rows[k].max()]
    if len(still) == 1 < len(at):
        other = Moments.of(rows[at[0] if still[0] == at[1] else at[1]])
        alpha = 0.5 * alpha
        error += light_tailed_reach(other.n, alpha) * other.stderr
        value, data = other.mean, Moments.of(rows[still[0]])
        what = f"{sizes[still[0]]} samples against the mean {value:.7g} of the others"
    found = mean_test(name, what, data, value, error, alpha, "bias", _LIGHT, ways=_REPLICATES)
    if data.low < data.high or found.outcome == "not rejected":
        return found
    scatter = math.fsum(_scatter_bound(rows, sizes, k, alpha) for k in still or at)
    return _unvarying(found, data, (value - error, value + error), scatter, alpha, len(sizes) - 1 in at)


def _scatter_bound(rows: list[np.ndarray], sizes: list[int], k: int, miss: float) -> float:
    """Return a bound on the variance of an estimate from sizes[k] samples, by that of the other counts; 0 where none varies.

    With more samples variances do not grow, and they fall as 1 / n^2 at most where estimates come in steps. What was seen of normal
    estimates lies so far below their variance with probability `miss`.
    """
    from scipy.special import gammaincinv

    freedom = 0.5 * (len(rows[0]) - 1)
    unlucky = freedom / float(gammaincinv(freedom, miss))
    ratios = np.array(sizes) / sizes[k]
    return unlucky * max(float(row.var(ddof=1)) * max(1.0, r * r) for row, r in zip(rows, ratios, strict=True))


def _unvarying(
    finding: Finding, data: Moments, claim: tuple[float, float], scatter: float, alpha: float, last: bool
) -> Finding:
    """Judge estimates that are all equal, and not right, by the scatter that others let expect (Cantelli's inequality).

    last  whether they are those of the most samples, for which chance is no excuse
    """
    p = extremes_p(data, *claim, Known(variance=scatter)) if scatter > 0 else 1.0
    start = finding.message.partition(";")[0]
    if p <= alpha:
        message = f"{start}; by their scatter at other numbers of samples they would differ"
        side = "too large" if data.mean > claim[1] else "too small"
        return replace(
            finding, outcome="rejected", message=message, p_value=p, alpha=alpha, cause="bias", region=(side,)
        )
    if p > DOUBT and scatter > 0 and not last:
        message = f"{start}; by their scatter at other numbers of samples chance explains it"
        return replace(finding, outcome="not rejected", message=message, p_value=p, alpha=alpha)
    return finding


def _not_random(
    rows: list[np.ndarray], sizes: list[int], reference: Reference | float | None, tolerance: tuple[float, float]
) -> list[Finding]:
    """Judge a program that is not random, such as ray marching: its error must not grow with the number of steps, but fall.

    Errors of quasi-random points, or of a program whose seed is fixed, go up and down: rejected is only one that is out of all
    proportion to those with fewer samples. Without a reference there is no telling by how much two numbers of steps may differ,
    unless a tolerance says so.
    """
    relative, absolute = tolerance
    values = np.array([row[0] for row in rows])
    if reference is None:
        truth, error, who = values[-1], np.zeros(()), f"the estimate with {sizes[-1]} samples"
    else:
        one = Reference.of("reference", reference)
        truth, error, who = one.value, one.error, "the reference"
    allowed = error + absolute + (relative + _ROUNDING) * np.abs(truth)
    off = np.abs(values - truth)
    within = (off <= allowed).all(axis=-1)
    if reference is None:
        outcome: Outcome = "not rejected" if within.all() else "rejected" if absolute + relative > 0 else "inconclusive"
        message = f"estimates differ by up to {off.max():.3g} from {who}; {_SAME}"
        message += "; give reference= or tolerance=" if outcome == "inconclusive" else ""
        cause = "bias" if outcome == "rejected" else ""
        return [Finding("difference", outcome, message, effect=float(off.max()), cause=cause)]
    findings, least = [], np.full(off.shape[1:], np.inf)
    for k, (row, n) in enumerate(zip(off, sizes, strict=True)):
        worse = bool((row > least + allowed).any())
        grown = k > 1 and bool((row > _GROWN * off[:k].max(axis=0) + allowed).any())
        outcome = "rejected" if worse and grown else "inconclusive" if worse else "not rejected"
        message = f"off by {row.max():.3g} with {n} samples"
        if worse:
            message += f", by {least.max():.3g} with fewer; {_SAME}"
            message += "" if grown else ". Such errors go up and down: more counts, or tolerance=, would decide"
        cause = "bias" if outcome == "rejected" else ""
        findings.append(Finding(f"error with {n} samples", outcome, message, effect=float(row.max()), cause=cause))
        least = np.minimum(least, row)
    stalled = ~(off[-1] <= allowed) & ~(off[-1] < off[0] * (1 - _PROGRESS))
    if stalled.any():
        message = f"off by {off[0].max():.3g} with {sizes[0]} samples, and still by {off[-1].max():.3g} with {sizes[-1]}; {_SAME}"
        message += ". If that is right enough, say so by tolerance="
        findings.append(Finding("approach to the reference", "inconclusive", message, effect=float(off[-1].max())))
    return findings


def _scatter(rows: list[np.ndarray], sizes: list[int], doubt: float) -> list[Finding]:
    """Compare the scatter of replicates with that at the first count, by Fisher's test: it must fall.

    Independent samples make variances fall as 1 / n; what does not fall as 1 / sqrt(n) is reported. It may be so where rare bright
    values were missed at first, so that this alone rejects nothing; a right program is doubted with probability `doubt`.
    """
    from scipy.special import betainc

    freedom = 0.5 * (len(rows[0]) - 1)
    share = doubt / ((len(rows) - 1) * rows[0].shape[1])
    high = []
    for row, n in zip(rows[1:], sizes[1:], strict=True):
        slowest = np.sqrt(sizes[0] / n)
        for first, later in zip(rows[0].var(axis=0, ddof=1), row.var(axis=0, ddof=1), strict=True):
            allowed = slowest * first
            p = float(betainc(freedom, freedom, allowed / (allowed + later))) if later > 0 else 1.0
            if p <= share:
                times = np.sqrt(later / first) if first > 0 else np.inf
                high.append(f"{times:.3g} times as much with {n}, which should be {np.sqrt(sizes[0] / n):.2g}")
    if not high:
        return [Finding("scatter of estimates", "not rejected", "estimates from more samples scatter less")]
    message = f"estimates scatter, against {sizes[0]} samples, {'; '.join(high)}"
    message += ": rare bright values, an overflow, or a number of samples that is disregarded"
    return [Finding("scatter of estimates", "inconclusive", message)]
