"""Points of one call that know each other are found, in whatever order they come; independent ones are left alone."""

import numpy as np
import pytest

from fogproof import HalfLine, Interval, UnitSphere, UnitSquare, check_sampler
from fogproof.checks.statistics.evenness import evenness_test

CALLS = {"dimensions": None, "samples": 1 << 17}


def strata(rng, n):
    return rng.permutation((np.arange(n) + rng.random(n)) / n)


def hypercube(rng, n):
    return np.stack([strata(rng, n), strata(rng, n)], axis=-1)


def jittered(rng, n):
    side = int(np.sqrt(n))
    cells = rng.permutation(side * side)
    x = (np.stack([cells // side, cells % side], axis=-1) + rng.random((side * side, 2))) / side
    return np.concatenate([x, rng.random((n - side * side, 2))])


def on_sphere(u):
    z, phi = 1 - 2 * u[:, 0], 2 * np.pi * u[:, 1]
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


def ones(x):
    return np.ones(len(x))


STREAMS = {
    "strata in random order": (strata, ones, Interval(0, 1)),
    "Latin hypercube": (hypercube, ones, UnitSquare()),
    "jittered grid": (jittered, ones, UnitSquare()),
    "on the sphere": (lambda rng, n: on_sphere(hypercube(rng, n)), lambda x: ones(x) / (4 * np.pi), UnitSphere()),
    "under labels": (
        lambda rng, n: np.sqrt(hypercube(rng, n)) * 0.5, lambda x: np.where((x < 0.5).all(axis=1), 64 * x[:, 0] * x[:, 1], 0.0),
        UnitSquare(),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", STREAMS)
def test_stratified_calls_are_named_unless_they_are_declared(name):
    sample, pdf, domain = STREAMS[name]
    verdict = check_sampler(sample, pdf, domain, **CALLS)
    assert verdict.cause == "stratified samples", str(verdict)
    assert "quasi_random=True" in str(verdict)
    assert check_sampler(sample, pdf, domain, quasi_random=True, **CALLS).outcome == "not rejected"


def antithetic(rng, n):
    x = rng.random(n - n // 2)
    return rng.permutation(np.concatenate([x, 1 - x])[:n])


def opposite(rng, n):
    x = rng.random(n - n // 2)
    return rng.permutation(np.concatenate([x, (x + 0.5) % 1])[:n])


@pytest.mark.parametrize(("sample", "pdf", "domain"), [
    (antithetic, ones, Interval(0, 1)),
    (opposite, ones, Interval(0, 1)),
    (lambda rng, n: -np.log1p(-antithetic(rng, n)), lambda x: np.exp(-x), HalfLine(0)),
    (lambda rng, n: on_sphere(np.stack([rng.random(n), opposite(rng, n)], axis=1)), lambda x: ones(x) / (4 * np.pi),
     UnitSphere()),
    (lambda rng, n: 0.5 * np.sqrt(antithetic(rng, n)), lambda x: np.where(x < 0.5, 8 * x, 0.0), Interval(0, 1)),
    (lambda rng, n: np.where(rng.random(n) < 0.9, antithetic(rng, n), rng.random(n)), ones, Interval(0, 1)),
])  # fmt: skip
def test_partners_are_found_wherever_in_a_call_they_stand(sample, pdf, domain):
    verdict = check_sampler(sample, pdf, domain, **{**CALLS, "samples": 1 << 19})
    assert verdict.outcome == "rejected", str(verdict)
    assert verdict.cause == "correlation", str(verdict)
    assert check_sampler(sample, pdf, domain, quasi_random=True, **CALLS).outcome == "not rejected"


def test_independent_calls_are_left_alone():
    verdict = check_sampler(lambda rng, n: rng.random((n, 2)), ones, UnitSquare(), **CALLS)
    assert "independence within a call" in [f.check for f in verdict.findings]
    assert verdict.outcome == "not rejected", str(verdict)


def test_the_p_value_is_uniform_and_the_resolution_true():
    rng, share = np.random.default_rng(), np.full(32, 1 / 32)
    sizes = [16_384, 65_536, 65_536, 40_000]
    p, caught = [], 0
    for _ in range(2000):
        calls = np.stack([rng.multinomial(n, share) for n in sizes])
        finding = evenness_test("evenness", ("x",), calls[:, None], 1e-3)
        p.append(finding.p_value)
        missing = finding.resolution.value
        even = [n * share + np.sqrt(1 - missing) * (row - n * share) for n, row in zip(sizes, calls, strict=True)]
        caught += evenness_test("evenness", ("x",), np.stack(even)[:, None], 1e-3).outcome == "rejected"
    assert np.mean(np.array(p) < 0.05) < 0.05 + 5 * np.sqrt(0.05 / 2000)
    assert 0.97 < caught / 2000 < 1 - 1e-9
