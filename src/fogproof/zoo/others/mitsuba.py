"""Mitsuba 3's own `ChiSquareTest`, called as it is: 101 x 202 cells, trapezoidal rule, single precision. Needs Mitsuba and LLVM."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.adapters.mitsuba import installed, vectorised
from fogproof.adapters.mitsuba.runtime import built
from fogproof.catalogue.cases import points_of
from fogproof.zoo.others.cells import SAMPLES, on_the_sphere
from fogproof.zoo.others.test import OtherTest


def _applies(sampler: Any) -> bool:
    few = sampler.dimensions is not None and 1 < sampler.dimensions <= 4
    return few and on_the_sphere(sampler) and installed() and vectorised()


def _p_value(sampler: Any, rng: np.random.Generator) -> float:
    return built(lambda mi: _run(mi, sampler, int(rng.integers(2**31))))


def _run(mi: Any, sampler: Any, seed: int) -> float:
    from mitsuba import chi2

    def sample(u: Any) -> Any:
        uniforms = np.stack([np.array(u[i], dtype=float) for i in range(sampler.dimensions)], axis=-1)
        x = np.asarray(points_of(sampler.sample(uniforms)), dtype=np.float32)
        return mi.Vector3f(*(mi.Float(np.ascontiguousarray(column)) for column in x.T))

    def pdf(x: Any) -> Any:
        points = np.stack([np.array(x[i], dtype=float) for i in range(3)], axis=-1)
        value = np.asarray(sampler.pdf(points / np.linalg.norm(points, axis=1, keepdims=True)), dtype=np.float32)
        return mi.Float(np.ascontiguousarray(value))

    tests: Any = chi2
    test = tests.ChiSquareTest(tests.SphericalDomain(), sample, pdf, sampler.dimensions, SAMPLES, seed=seed)
    accepted = test.run(significance_level=0.01, quiet=True)
    p = float(np.asarray(getattr(test, "p_value", 0.0)).reshape(-1)[0])
    return p if accepted or p < 0.01 else 0.0


TESTS = (OtherTest("mitsuba", "Mitsuba 3: ChiSquareTest", "mitsuba.chi2", 0.01, SAMPLES, _applies, _p_value),)
