"""Does a sampler that draws its own uniforms follow one law, however many samples it is asked for at once?

A path for single samples beside a vectorised one, or a draw whose first element is special, shows in small calls alone: the batches
of a check are large. Points of calls of 1, 10 and 1000 are held against the pilot, which is one large call, by Kolmogorov's
distance along each coordinate of the domain's known law. Massart's bound (1990) on either sample makes the p-value no smaller than
it should be: P(D >= a + b) <= 2 exp(-2 m a^2) + 2 exp(-2 n b^2).
"""

from __future__ import annotations

import math

import numpy as np

from fogproof.checks.promises import at_any_atom, inside
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import Subject
from fogproof.checks.verdict import Finding, Outcome, Resolution
from fogproof.errors import SubjectError

CALLS = {1: 64, 10: 32, 1000: 4}
"""Samples of a call: how many such calls."""

_CAUSE = "size of the call"
Points = dict[int, np.ndarray]


def small_calls(subject: Subject, seed: int) -> Points:
    """Return the good points of the continuous part (m, ...) of calls of each size, but of those the sampler refuses."""
    found = {}
    for index, (size, calls) in enumerate(CALLS.items()):
        rng = batch_generator(seed, "sizes", 0, index)
        try:
            found[size] = np.concatenate([_good(subject, rng, size) for _ in range(calls)])
        except SubjectError:  # what fails loudly misleads nobody
            continue
    return found


def _good(subject: Subject, rng: np.random.Generator, size: int) -> np.ndarray:
    draw = subject.draw(rng, size)
    good = inside(subject, draw) & ~at_any_atom(subject, draw.x)
    return draw.x[good if draw.valid is None else good & draw.valid]


def one_law(name: str, subject: Subject, calls: Points, pilot: np.ndarray, seed: int, alpha: float) -> Finding:
    """Test whether the points of small calls follow the law of the pilot (n, ...)."""
    law, rng = subject.domain.law(pilot), batch_generator(seed, "sizes", 1, 0)
    n = len(pilot)
    large = np.sort(law.coordinates(pilot, rng.random((n, len(law.axes)))), axis=0)
    rivals, worst, message = max(len(calls) * len(law.axes), 1), (1.0, 0.0), "no call of a few samples gives points"
    for size, points in calls.items():
        m = len(points)
        if not (m and n):  # all at atoms
            continue
        small = np.sort(law.coordinates(points, rng.random((m, len(law.axes)))), axis=0)
        for axis, label in enumerate(law.axes):
            distance = _distance(small[:, axis], large[:, axis])
            p = min(1.0, rivals * 4 * math.exp(-2 * distance**2 * m * n / (math.sqrt(m) + math.sqrt(n)) ** 2))
            if p <= worst[0]:
                worst = (p, distance)
                message = f"calls of {size} and of {n} differ by a Kolmogorov distance of {distance:.2g} in {label}"
    p, effect = worst
    rejected = p <= alpha
    outcome: Outcome = "rejected" if rejected else "not rejected"
    cause = _CAUSE if rejected else ""
    return Finding(
        name, outcome, message, p, alpha, False, effect, effect, _reach(calls, n, rivals, alpha), cause=cause
    )


def _reach(calls: Points, n: int, rivals: int, alpha: float) -> Resolution | None:
    """Return the distance that calls of every size would have shown, but for `MISS`: Massart's bound both ways."""
    sizes = {size: len(points) for size, points in calls.items() if len(points)}
    if not sizes:
        return None
    size, m = min(sizes.items(), key=lambda one: one[1])
    root = math.sqrt(0.5 * math.log(4 * rivals / alpha)) + math.sqrt(0.5 * math.log(4 / MISS))
    distance = root * (1 / math.sqrt(m) + 1 / math.sqrt(n))
    return Resolution(f"Kolmogorov distance between calls of {size} and of {n}", min(distance, 1.0), MISS)


def _distance(a: np.ndarray, b: np.ndarray) -> float:
    """Return the largest difference of the empirical distributions of two sorted samples."""
    if not (len(a) and len(b)):
        return 0.0
    both = np.concatenate([a, b])
    return float(
        np.max(np.abs(np.searchsorted(a, both, "right") / len(a) - np.searchsorted(b, both, "right") / len(b)))
    )
