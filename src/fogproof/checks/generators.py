"""`check_streams`: are the random numbers of neighbouring seeds, workers or pixels independent?

A renderer seeds a generator for every pixel, thread or frame. Streams that overlap, that begin alike, or whose first numbers
follow from one another draw patterns into images whose every pixel is right.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from fogproof.checks.arguments import alpha_of, whole
from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.draws import as_array
from fogproof.checks.statistics.cells import MISS, unevenness
from fogproof.checks.statistics.succession import fingerprints
from fogproof.checks.statistics.tails import chi_square_above, chi_square_detected, normal_quantile, normal_two_sided
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Outcome, Resolution, Verdict
from fogproof.errors import SubjectError

_COLUMNS = 4  # first numbers of every stream that are looked at across streams
_WINDOW = 4  # successive numbers, at least, of a stretch that is looked for elsewhere
_CHANCE = 1e-3  # share of alpha for stretches that are equal by chance
_CELLS = 16
_SHIFTS = (0, 1, 2)


def check_streams(make_rng: Callable[[int], Any], k: int = 1000, *, numbers: int = 256, alpha: float = 1e-6) -> Verdict:
    """Test that the streams `make_rng(0)` ... `make_rng(k - 1)` are independent, within each and across neighbours.

    make_rng  seed, worker or pixel -> a `numpy.random.Generator`, or a function n -> (n,) uniforms in [0, 1)
    k         how many streams; single precision is welcome
    numbers   how many numbers of each
    alpha     false-alarm probability of this call with everything in it; streams are fixed, so that it is one of all their kind

    >>> check_streams(lambda i: np.random.default_rng([7, i]), 200).outcome
    'not rejected'
    """
    started = time.perf_counter()
    alpha, k, numbers = alpha_of(alpha), whole("k", k, 32), whole("numbers", numbers, 16)
    u = np.stack([_stream(make_rng, i, numbers) for i in range(k)])
    findings = [_range(u)]
    if findings[0].outcome != "rejected":
        findings += [_reproducible(make_rng, u, numbers), _overlaps(u, _CHANCE * alpha)]
        jobs = _tests(u)
        findings += [test((1 - _CHANCE) * alpha / len(jobs)) for test in jobs]
    name = getattr(make_rng, "__qualname__", type(make_rng).__name__)
    reproduce = f"check_streams({name}, {k}, numbers={numbers}, alpha={alpha:g})"
    seconds = time.perf_counter() - started
    return Verdict(tuple(findings), alpha, k * numbers, 0, seconds, {"streams": k}, likely_cause(findings), reproduce)


def _stream(make_rng: Callable[[int], Any], i: int, n: int) -> np.ndarray:
    rng = call(f"make_rng({i})", make_rng, i)
    draw = rng.random if hasattr(rng, "random") else rng
    if not callable(draw):
        raise SubjectError(
            f"make_rng({i}) must return a generator or a function n -> uniforms, got {rng!r}", "make_rng"
        )
    x = as_array(f"make_rng({i})", call(f"the stream of make_rng({i})", draw, n))
    if x.shape != (n,):
        raise SubjectError(f"the stream of make_rng({i}) must return ({n},) uniforms, got {x.shape}", "make_rng")
    return x.astype(np.float64)


def _range(u: np.ndarray) -> Finding:
    wrong = int(np.count_nonzero(~((u >= 0) & (u < 1))))
    message = f"{wrong} of {u.size} numbers lie outside [0, 1)" if wrong else f"all {u.size} numbers lie in [0, 1)"
    outcome: Outcome = "rejected" if wrong else "not rejected"
    return Finding("range", outcome, message, effect=wrong / u.size, cause="outside the domain" if wrong else "")


def _reproducible(make_rng: Callable[[int], Any], u: np.ndarray, n: int) -> Finding:
    """Compare with the same streams made again, by several threads at once."""
    some = range(min(len(u), 32))
    with ThreadPoolExecutor(4) as pool:
        again = list(pool.map(lambda i: _stream(make_rng, i, n), some))
    differ = [i for i in some if not np.array_equal(again[i], u[i])]
    message = "streams are the same when they are made again, by four threads at once"
    if differ:
        message = (
            f"{len(differ)} of {len(some)} streams differ when they are made again, the first is number {differ[0]}"
        )
    outcome: Outcome = "rejected" if differ else "not rejected"
    return Finding(
        "threads", outcome, message, effect=len(differ) / len(some), cause="dependent samples" if differ else ""
    )


def _overlaps(u: np.ndarray, alpha: float) -> Finding:
    """Look for stretches of numbers that occur twice, in any stream at any place, so long that chance does not repeat them."""
    length = _stretch(u, alpha)
    if length > u.shape[1] // 2:
        message = f"stretches of {u.shape[1] // 2} numbers of so few bits are equal by chance: ask for more numbers="
        return Finding("overlap", "inconclusive", message, alpha=alpha)
    windows = np.lib.stride_tricks.sliding_window_view(u, length, axis=1)
    prints = fingerprints(windows.reshape(-1, length))
    owner = np.repeat(np.arange(len(u)), windows.shape[1])
    order = np.argsort(prints, kind="stable")
    equal = np.flatnonzero(prints[order][1:] == prints[order][:-1])
    if not len(equal):
        return Finding("overlap", "not rejected", f"no {length} successive numbers occur twice", alpha=alpha)
    pairs = np.stack([owner[order][equal], owner[order][equal + 1]])
    a, b = pairs[:, np.lexsort(pairs[::-1])[0]]
    message = f"{len(equal)} stretches of {length} numbers occur again, the first in streams {a} and {b}"
    effect = len(equal) / len(prints)
    return Finding("overlap", "rejected", message, alpha=alpha, effect=effect, cause="dependent samples")


def _stretch(u: np.ndarray, alpha: float) -> int:
    """Return how long stretches must be that two of them are equal by chance with probability alpha at most.

    How often two numbers are equal is seen within the streams, where an overlap with another does not show.
    """
    streams, n = u.shape
    ordered = np.sort(u, axis=1)
    begins = np.ones(u.shape, dtype=bool)
    begins[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
    runs = np.diff(np.flatnonzero(np.append(begins.ravel(), True))).astype(np.float64)
    equal, pairs = float(np.sum(runs * (runs - 1)) / 2), streams * n * (n - 1) / 2
    alike = min((equal + 6 * math.sqrt(equal) + 6) / pairs, 1.0)
    if alike == 1:
        return n
    return max(_WINDOW, math.ceil(math.log(0.5 * (streams * n) ** 2 / alpha) / -math.log(alike)))


def _tests(u: np.ndarray) -> list[Callable[[float], Finding]]:
    tests: list[Callable[[float], Finding]] = [lambda share: _uniform("all numbers", u.ravel(), share)]
    for column in range(_COLUMNS):
        values = u[:, column]
        steps = np.diff(values) % 1.0  # of independent uniforms: uniform, and pairwise independent
        place = f"number {column} of every stream"
        tests.append(lambda share, v=values, p=place: _kolmogorov(p, v, share))  # type: ignore[misc]
        tests.append(lambda share, v=steps[::2], p=f"step to the neighbour in {place}": _kolmogorov(p, v, share))  # type: ignore[misc]
    for shift in _SHIFTS:
        a, b = u[:-1, : u.shape[1] - shift], u[1:, shift:]
        tests.append(lambda share, a=a, b=b, s=shift: _correlation(f"neighbours, {s} apart", a, b, share))  # type: ignore[misc]
        tests.append(lambda share, a=a[::2], b=b[::2], s=shift: _pairs(f"pairs of neighbours, {s} apart", a, b, share))  # type: ignore[misc]
    return tests


def _finding(name: str, message: str, p: float, alpha: float, effect: float, seen: Resolution) -> Finding:
    rejected = p <= alpha
    outcome: Outcome = "rejected" if rejected else "not rejected"
    cause = "correlation" if rejected else ""
    return Finding(name, outcome, message, p, alpha, False, effect, effect, seen, cause=cause)


def _kolmogorov(name: str, x: np.ndarray, alpha: float) -> Finding:
    ordered, n = np.sort(x), len(x)
    distance = float(max(np.max(np.arange(1, n + 1) / n - ordered), np.max(ordered - np.arange(n) / n)))
    p = min(1.0, 2 * math.exp(-2 * n * distance**2))  # Massart 1990
    reach = math.sqrt(math.log(2 / alpha) / (2 * n)) + math.sqrt(math.log(1 / MISS) / (2 * n))
    seen = Resolution(f"Kolmogorov distance of {name}", min(reach, 1.0), MISS)
    return _finding(name, f"Kolmogorov's distance from the uniform law is {distance:.3g}", p, alpha, distance, seen)


def _uniform(name: str, x: np.ndarray, alpha: float) -> Finding:
    cells = _CELLS**2
    counts = np.bincount((x * cells).astype(np.int64), minlength=cells)
    statistic = float(np.sum((counts - len(x) / cells) ** 2) / (len(x) / cells))
    message = f"chi-square is {statistic:.4g} on {cells} cells"
    p = chi_square_above(cells - 1, statistic)
    return _finding(name, message, p, alpha, statistic / (cells - 1), _uneven(name, cells, len(x), alpha))


def _uneven(name: str, cells: int, n: int, alpha: float) -> Resolution:
    """Return how uneven n numbers must be in so many cells for chi-square to find it."""
    seen = math.sqrt(chi_square_detected(cells - 1, alpha, MISS) / n)
    return Resolution(f"{unevenness(cells)} of {name}", seen, MISS)


def _correlation(name: str, a: np.ndarray, b: np.ndarray, alpha: float) -> Finding:
    correlation = 12 * float(np.mean((a - 0.5) * (b - 0.5)))
    p = normal_two_sided(correlation * math.sqrt(a.size))
    reach = (normal_quantile(alpha / 2) + normal_quantile(MISS)) / math.sqrt(a.size)
    seen = Resolution(f"correlation of {name}", min(reach, 1.0), MISS)
    return _finding(name, f"correlation is {correlation:+.3g}", p, alpha, correlation, seen)


def _pairs(name: str, a: np.ndarray, b: np.ndarray, alpha: float) -> Finding:
    cells = (a * _CELLS).astype(np.int64) * _CELLS + (b * _CELLS).astype(np.int64)
    counts = np.bincount(cells.ravel(), minlength=_CELLS**2)
    expected = a.size / _CELLS**2
    statistic = float(np.sum((counts - expected) ** 2) / expected)
    message = f"chi-square is {statistic:.4g} on {_CELLS} x {_CELLS} cells"
    p, seen = chi_square_above(_CELLS**2 - 1, statistic), _uneven(name, _CELLS**2, a.size, alpha)
    return _finding(name, message, p, alpha, statistic / (_CELLS**2 - 1), seen)
