"""`check_bound`: does a majorant lie above its function everywhere, and is it attained somewhere?

The largest quotient f / bound is looked for: at corners, evenly spread and independent uniform points first, then around the best
of them in ever smaller neighbourhoods. A place where f exceeds its bound is a proof; that none was found is none. So it is said how
near f came, and how much of the domain may be wrong: m independent points miss a share s of it with probability (1 - s)^m.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.checks.arguments import seed_of, whole
from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import UNIT_ROUNDOFF, Precision, call, nudged, numbers
from fogproof.checks.verdict import Finding, Outcome, Resolution, Verdict
from fogproof.domains import Domain
from fogproof.errors import InvalidValueError, shorten
from fogproof.validate import number

_BEST = 32  # places that are looked at more closely
_ROUNDS = 40
_SHRINK = 0.6  # of the neighbourhood, from one round to the next
_NEAR = 1e-6  # above the bound by less is told as a difference
_CORNERS = 6  # dimensions up to which all corners are visited; of more, as many as these have, chosen at random
_ROUNDED = {"float64": 1e-6, "float32": 1e-3}  # relative: an excess that is larger is no rounding
_NOISE = 4.0  # times what a move by one unit in the last place does to f


def check_bound(
    f: Callable[[np.ndarray], Any],
    bound: float | Callable[[np.ndarray], Any],
    domain: Domain,
    *,
    attained: float = 0.5,
    precision: Precision = "float64",
    evaluations: int = 100_000,
    seed: int | None = None,
) -> Verdict:
    """Test f(x) <= bound(x) on a domain, and that the bound is no looser than asked for; nothing about it is statistical.

    f            x -> (n,), such as an extinction coefficient [1/m]
    bound        its majorant: a number, or a function of the same points
    domain       where; points have the domain's shape
    attained     part of the bound that f reaches somewhere: a looser bound is right, but wastes work, and may hide a peak that
                 was not found; it makes the verdict inconclusive
    precision    "float32": f or the bound are computed in single precision
    evaluations  most points
    seed         any whole number; None draws a fresh one, which the verdict states

    >>> from fogproof import Interval
    >>> check_bound(lambda x: 1 + 0.8 * np.sin(3 * x), 1.8, Interval(0.0, 4.0)).outcome
    'not rejected'
    >>> check_bound(lambda x: 1 + 0.8 * np.sin(3 * x), 1.79, Interval(0.0, 4.0)).outcome
    'rejected'
    """
    started = time.perf_counter()
    evaluations, seed = whole("evaluations", evaluations, 100), seed_of(seed)
    number("attained", attained, "must lie in [0, 1]", 0, 1)
    if not isinstance(domain, Domain):
        raise InvalidValueError("domain", "must be one of fogproof.domains, such as Interval(0, 1)", domain)
    if np.isinf(domain.measure):
        raise InvalidValueError("domain", "must be bounded: elsewhere there is no scale to search on", domain)
    law = domain.law(np.empty((0, *domain.shape)))
    limit = 0.0 if callable(bound) else number("bound", bound, "must be >= 0", 0)
    slack = 16 * UNIT_ROUNDOFF[precision]

    highest = limit

    def quotient_at(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        with np.errstate(all="ignore"):
            value = numbers("f(x)", call("f(x)", f, x), (len(x),))
            top = (
                numbers("bound(x)", call("bound(x)", bound, x), (len(x),))
                if callable(bound)
                else np.full(len(x), limit)
            )
            ratio = np.where(top > 0, value / top, np.where(value > top, np.inf, 0.0))
        nonlocal highest
        highest = max(highest, float(np.max(top, initial=0.0)))
        known = ~(np.isnan(value) | np.isnan(top) | np.isposinf(value))
        return np.where(known, ratio, np.inf), value, x

    def searched(enough: float) -> tuple[float, float, Any, int, int]:
        rng = batch_generator(seed, "bound", 0, 0)
        return _search(lambda u: quotient_at(law.place(u)), len(law.axes), evaluations, rng, enough)

    best, value, place, used, independent = searched(1 + slack)
    if 1 + slack < best <= 1 + _ROUNDED[precision]:  # so little may be the rounding of f itself
        moved = np.concatenate(nudged(np.asarray(place)[None], UNIT_ROUNDOFF[precision]))
        change = np.abs(quotient_at(moved)[0] - best)
        noise = _NOISE * float(np.max(change, initial=0.0, where=change <= _ROUNDED[precision]))
        if best <= 1 + noise:
            slack = noise
            best, value, place, used, independent = searched(1 + slack)
    over = not best <= 1 + slack
    findings = _found(best, value, shorten(place), used, independent, over)
    if not over:
        findings.append(_attained(best, shorten(place), used, highest, attained))
    name = getattr(f, "__qualname__", type(f).__name__)
    reproduce = f"check_bound({name}, ..., evaluations={evaluations}, seed={seed})"
    seconds = time.perf_counter() - started
    return Verdict(tuple(findings), 0.0, used, seed, seconds, {}, likely_cause(findings), reproduce)


def _found(best: float, value: float, at: str, used: int, independent: int, over: bool) -> list[Finding]:
    """Return what was found of the largest quotient, `best`, where f has `value`."""
    size = f"is {best:.9g} times its bound" if best > 1 + _NEAR else f"is above its bound, by {best - 1:.2g} of that,"
    if not np.isfinite(value):
        size = "is no number that a bound could hold,"
    message = f"f = {value:.9g} {size} at {at}" if over else f"f <= bound at {used} points"
    part = "part of the domain where f exceeds its bound"
    resolution = None if over else Resolution(part, -math.expm1(math.log(MISS) / independent), MISS)
    outcome: Outcome = "rejected" if over else "not rejected"
    cause = "wrong bound" if over else ""
    return [Finding("above everywhere", outcome, message, effect=best - 1, resolution=resolution, cause=cause)]


def _attained(best: float, at: str, used: int, highest: float, attained: float) -> Finding:
    """Return whether a bound that is nowhere larger than `highest` is reached as nearly as asked for."""
    near = best >= attained or highest == 0  # where both are zero, the bound is as tight as can be
    message = f"f reaches {best:.4g} of its bound, at {at}" if highest else f"f and its bound are 0 at {used} points"
    if not near:
        message += f", less than {attained:g}: the bound is loose, or a peak was missed: more evaluations would tell"
    return Finding("attained somewhere", "not rejected" if near else "inconclusive", message, effect=best)


def _search(
    quotient: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]],
    k: int,
    evaluations: int,
    rng: np.random.Generator,
    enough: float,
) -> tuple[float, float, Any, int, int]:
    """Return the largest quotient found, f there, the point, how many were evaluated, and how many of those were independent.

    The end is where the quotient exceeds `enough`.
    """
    independent = evaluations // 4
    spread = np.concatenate([_evenly(evaluations // 2 - independent, k, rng), rng.random((independent, k))])
    ends = np.array([0.0, 0.5, np.nextafter(1.0, 0.0)])
    if k <= _CORNERS:
        corners = np.array(list(itertools.product(ends, repeat=k)))
    else:
        corners = np.concatenate([np.repeat(ends[:, None], k, axis=1), rng.choice(ends, (3**_CORNERS, k))])
    spread = np.concatenate([corners, spread])
    ratio, value, x = quotient(spread)
    i = int(np.argmax(ratio))
    best, found, used = (float(ratio[i]), float(value[i]), x[i]), spread, len(spread)
    order = np.argsort(-ratio, kind="stable")[:_BEST]
    centres, tops = found[order], ratio[order]
    each = max((evaluations - used) // (_ROUNDS * len(centres)), 2)
    reach = 2 * len(spread) ** (-1 / k)
    for _ in range(_ROUNDS):
        if best[0] > enough or used >= evaluations:
            break
        step = rng.uniform(-reach, reach, (len(centres), each, k))
        step[:, ::2] *= rng.random((len(centres), (each + 1) // 2, k)) < 1 / k  # half of them along few axes
        trial = np.clip(centres[:, None] + step, 0.0, np.nextafter(1.0, 0.0))
        ratio, value, x = quotient(trial.reshape(-1, k))
        used += len(ratio)
        i = int(np.argmax(ratio))
        if ratio[i] > best[0]:
            best = (float(ratio[i]), float(value[i]), x[i])
        ratio = ratio.reshape(len(centres), each)
        choice = np.argmax(ratio, axis=1)
        better = ratio[np.arange(len(centres)), choice] > tops
        centres = np.where(better[:, None], trial[np.arange(len(centres)), choice], centres)
        tops = np.maximum(tops, ratio.max(axis=1))
        reach *= _SHRINK
    return (*best, used, independent)


def _evenly(n: int, k: int, rng: np.random.Generator) -> np.ndarray:
    """Return n points that fill the unit cube evenly: Kronecker's sequence of the generalised golden ratio, shifted at random."""
    phi = 2.0
    for _ in range(60):
        phi = (1 + phi) ** (1 / (k + 1))
    steps = phi ** -np.arange(1.0, k + 1)
    return (rng.random(k) + np.arange(n)[:, None] * steps) % 1.0
