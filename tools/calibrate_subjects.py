"""Right samplers and estimators, on which every kind of check is calibrated."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from calibrate_tally import LEVEL

from fogproof.checks import Finding, check_estimator, compare_estimators
from fogproof.checks.subject import Subject
from fogproof.contracts import Draw, Draws, Reference
from fogproof.domains import Discrete, HalfLine, Interval, Product, RealLine, UnitSphere, UnitSquare
from fogproof.estimators import Directions, FreePath
from fogproof.scene import HenyeyGreenstein, Rayleigh
from fogproof.verify import select

TILTED = (2 / 7, -3 / 7, 6 / 7)
POLE = (0.0, 0.0, 1.0)


def _directions(phase: Any, axis: tuple[float, float, float] = POLE) -> Subject:
    sampler = Directions(phase, axis)
    return Subject(sampler.sample, sampler.pdf, sampler.domain, 2)


def _path() -> Subject:
    path = FreePath(1.4, 0.5)
    return Subject(path.sample, path.pdf, path.domain, 1, path.atoms)


def _two_peaks() -> Subject:
    """Half the samples in each of two normal peaks of width 1e-4."""
    from scipy.special import ndtri

    def sample(u: np.ndarray) -> np.ndarray:
        left = u[:, 0] < 0.5
        v = 2 * np.where(left, u[:, 0], u[:, 0] - 0.5)
        return np.where(left, 0.2, 0.7) + 1e-4 * ndtri(np.clip(v, 1e-16, 1 - 1e-16))

    def pdf(x: np.ndarray) -> np.ndarray:
        bells = (np.exp(-0.5 * ((x - centre) / 1e-4) ** 2) for centre in (0.2, 0.7))
        return sum(bells) * 0.5 / (1e-4 * np.sqrt(2 * np.pi))

    return Subject(sample, pdf, Interval(0, 1), 1)


def _weighted() -> Subject:
    def sample(u: np.ndarray) -> Draw:
        return Draw(u[:, 0], weight=2 * u[:, 0] * 0.6)

    return Subject(sample, lambda x: np.ones(len(x)), Interval(0, 1), 1, albedo=0.6)


def _single() -> Subject:
    sampler = Directions(HenyeyGreenstein(0.5))
    return Subject(sampler.sample, sampler.pdf, sampler.domain, 2, precision="float32")


def _normal(u: np.ndarray) -> np.ndarray:
    from scipy.special import ndtri

    return ndtri(np.clip(u[:, 0], 1e-300, None))


def _outsider(name: str) -> Subject:
    (case,) = select([f"outsiders/{name}"])
    found = case.make()
    return Subject(found.sample, found.pdf, found.domain, found.dimensions, found.atoms)


def _given_up() -> Subject:
    """A cone of which a tenth is given up: labels under both conventions."""
    found = select(["outsiders/lights/cone/8/0"])[0].make()
    return Subject(lambda u: Draw(found.sample(u[:, :2]), valid=u[:, 2] < 0.9), found.pdf, found.domain, 3)


SUBJECTS: dict[str, Callable[[], Subject]] = {
    "Henyey-Greenstein, g = 0.7": lambda: _directions(HenyeyGreenstein(0.7)),
    "Henyey-Greenstein, g = 0.95": lambda: _directions(HenyeyGreenstein(0.95)),
    "Rayleigh, tilted axis": lambda: _directions(Rayleigh(), TILTED),
    "unit square by its Rosenblatt map": lambda: Subject(
        lambda u: np.sqrt(u), lambda x: 4 * x[:, 0] * x[:, 1], UnitSquare(), 2, cdf=lambda x: x * x
    ),
    "free path with a surface": _path,
    "exponential": lambda: Subject(lambda u: -np.log1p(-u[:, 0]), lambda x: np.exp(-x), HalfLine(0), 1),
    "normal": lambda: Subject(_normal, lambda x: np.exp(-0.5 * x * x) / np.sqrt(2 * np.pi), RealLine(), 1),
    "two peaks of width 1e-4": _two_peaks,
    "weights": _weighted,
    "single precision": _single,
    "the sun's disk": lambda: _outsider("lights/cone/0.2665/0"),
    "environment map": lambda: _outsider("maps/sphere/64x128"),
    "Poisson": lambda: _outsider("laws/poisson/17.3"),
    "Pareto, index 0.3": lambda: _outsider("laws/pareto/0.3"),
    "table of 1000 weights": lambda: _outsider("maps/table/1000"),
    "a cone, a tenth given up": lambda: Subject(
        *(lambda s: (s.sample, lambda x: 0.9 * s.pdf(x), s.domain, s.dimensions))(_given_up())
    ),
    "distance and direction": lambda: Subject(
        lambda u: np.column_stack([-np.log1p(-u[:, 0]), Directions(Rayleigh()).sample(u[:, 1:]).x]),
        lambda x: np.exp(-x[:, 0]) * Directions(Rayleigh()).pdf(x[:, 1:]),
        Product(HalfLine(0), UnitSphere()),
        3,
    ),
    "Student, 0.3 degrees": lambda: _outsider("laws/t/0.3"),
    "beta, both ends singular": lambda: _outsider("laws/beta/0.1-0.1"),
    "two values, one rare": lambda: Subject(
        lambda u: (u[:, 0] < 1e-3) * 1.0, lambda x: np.where(x == 1, 1e-3, 0.999), Discrete(2), 1
    ),
    "uniforms of its own": lambda: Subject(
        lambda rng, n: rng.random((n, 2)), lambda x: np.ones(len(x)), UnitSquare(), None
    ),
    "die of forty": lambda: Subject(
        lambda u: np.floor(40 * u[:, 0]), lambda x: np.full(len(x), 1 / 40), Discrete(40), 1
    ),
}

RIGHT = {
    **{
        f"Henyey-Greenstein, g = {g:g}": (lambda g=g: _directions(HenyeyGreenstein(g)))
        for g in (0.0, 0.3, -0.5, 0.8, 0.9, -0.95, 0.99, 0.999, -0.999)
    },
    "Henyey-Greenstein, g = 0.99, tilted axis": lambda: _directions(HenyeyGreenstein(0.99), TILTED),
    **SUBJECTS,
}

OPEN = {"beta, both ends singular": "1.3 % of its samples round to 1, where its density is infinite"}
"""Right samplers of which a whole verdict may stay inconclusive, and why."""


def _reported(rng: np.random.Generator, n: int) -> Draws:
    x = rng.normal(size=(n, 20)) + 1
    return Draws(x.mean(axis=1), cost=rng.poisson(3, n), stderr=x.std(axis=1, ddof=1) / np.sqrt(20))


def _one(value: float) -> Reference:
    return Reference(np.asarray(value), np.asarray(0.0), "", "")


def estimator_findings(samples: int, seed: int) -> Iterator[Finding]:
    """Yield what is found of right estimators: smooth, skewed, of two values, with standard errors, and in pairs."""

    def hits(rng: np.random.Generator, n: int) -> np.ndarray:
        return (rng.random(n) < 0.02) * 1.0

    def exponential(rng: np.random.Generator, n: int) -> np.ndarray:
        return rng.exponential(size=n)

    def rare(rng: np.random.Generator, n: int) -> np.ndarray:
        return (rng.random(n) < 1e-3) * rng.uniform(500, 1500, n)

    options: dict[str, Any] = {"samples": samples, "alpha": LEVEL, "seed": seed}
    yield from check_estimator(exponential, _one(1.0), variance=1.0, **options).findings
    yield from check_estimator(hits, _one(0.02), **options).findings
    yield from check_estimator(_reported, _one(1.0), cost=3.0, **options).findings
    for finding in check_estimator(rare, _one(1.0), variance=1e3 * (1 + 1 / 12) - 1, **options).findings:
        if finding.check == "mean":
            yield Finding("mean, no normal law", finding.outcome, finding.message, finding.p_value, finding.alpha)
    yield from compare_estimators(exponential, lambda rng, n: rng.uniform(0, 2, n), **options).findings
