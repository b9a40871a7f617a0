"""`check_reciprocity`: does a phase function know only the angle, and does light travel it both ways alike?"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.checks.diagnosis import likely_cause
from fogproof.checks.streams import batch_generator, fresh_seed
from fogproof.checks.subject import call, numbers
from fogproof.checks.verdict import Finding, Verdict
from fogproof.errors import shorten
from fogproof.validate import number

_ROUNDING = 64  # times the roundoff that two ways to the same number may differ by, and what moving the directions by it changes


def check_reciprocity(
    f: Callable[[np.ndarray, np.ndarray], Any],
    *,
    isotropic: bool = True,
    samples: int = 10_000,
    roundoff: float = 2.0**-53,
    seed: int | None = None,
) -> Verdict:
    """Test f(a, b) = f(-b, -a), Helmholtz's reciprocity, at random pairs of directions; nothing about it is statistical.

    f          `f(incoming, outgoing)` -> (n,), both (n, 3) unit vectors of propagation: forward means incoming = outgoing
    isotropic  whether the medium is: f may then depend on the angle between the directions only, whichever way they are turned
    roundoff   unit roundoff of the arithmetic f uses
    seed       any whole number; None draws a fresh one, which the verdict states
    """
    started = time.perf_counter()
    number("samples", samples, "must be at least 1", 1)
    seed = fresh_seed() if seed is None else seed
    rng = batch_generator(seed, "reciprocity", 0, 0)
    a, b = _directions(rng, samples), _directions(rng, samples)
    near = samples // 2  # half of the pairs are nearly parallel or opposed: peaks are there
    b[:near] = a[:near] * np.sign(rng.random((near, 1)) - 0.5) + 10.0 ** rng.uniform(-6, 0, (near, 1)) * b[:near]
    b /= np.sqrt(np.sum(b * b, axis=1))[:, None]

    def value(incoming: np.ndarray, outgoing: np.ndarray) -> np.ndarray:
        return numbers("f(incoming, outgoing)", call("f(incoming, outgoing)", f, incoming, outgoing), (samples,))

    with np.errstate(all="ignore"):
        here = value(a, b)
        moved = [value(a, _nudged(b, axis, sign * 8 * roundoff)) for axis in range(3) for sign in (1, -1)]
        slack = _ROUNDING * roundoff * np.abs(here) + 4 * np.max(np.abs(np.array(moved) - here), axis=0)
        findings = [_finding("reciprocity", here, value(-b, -a), slack, a, b)]
        if isotropic:
            turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
            findings.append(_finding("rotation", here, value(a @ turn.T, b @ turn.T), slack, a, b))
    name = getattr(f, "__qualname__", type(f).__name__)
    reproduce = f"check_reciprocity({name}, isotropic={isotropic}, samples={samples}, seed={seed})"
    seconds = time.perf_counter() - started
    return Verdict(tuple(findings), 0.0, samples, seed, seconds, {}, likely_cause(findings), reproduce)


def _directions(rng: np.random.Generator, n: int) -> np.ndarray:
    x = rng.normal(size=(n, 3))
    return x / np.sqrt(np.sum(x * x, axis=1))[:, None]


def _nudged(x: np.ndarray, axis: int, step: float) -> np.ndarray:
    moved = x.copy()
    moved[:, axis] += step
    return moved


def _finding(
    name: str, here: np.ndarray, there: np.ndarray, slack: np.ndarray, a: np.ndarray, b: np.ndarray
) -> Finding:
    gap = np.abs(here - there)
    wrong = ~(gap <= slack)
    effect = float(np.max(gap / np.maximum(np.abs(here), 1e-300)))
    if not wrong.any():
        return Finding(
            name, "not rejected", f"equal within rounding for {len(here)} pairs of directions", effect=effect
        )
    i = int(np.argmax(np.where(wrong, gap - slack, -np.inf)))
    message = f"{wrong.sum()} of {len(here)} pairs: {here[i]:.9g} against {there[i]:.9g}"
    message += f" for incoming {shorten(a[i])}, outgoing {shorten(b[i])}"
    return Finding(name, "rejected", message, effect=effect, cause="wrong formula")
