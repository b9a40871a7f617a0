"""Whole programs: more samples never make an estimate worse, and neighbouring random streams know nothing of each other."""

import math

import numpy as np
import pytest

from fogproof import check_convergence, check_streams
from fogproof.errors import InvalidValueError, SubjectError


def stalling(rng, n):
    """A sum in single precision that stands still once a term is below half a unit in its last place."""
    total = np.float32(0)
    for part in np.full(max(n // 1000, 1), np.float32(1000 * 0.5)) + rng.normal(size=max(n // 1000, 1)).astype(
        np.float32
    ):
        total = np.minimum(total + part, np.float32(400_000))
    return total / n


def mean(rng, n):
    return rng.random(n).mean()


PROGRAMS = [
    ("right", mean, {"reference": 0.5}, "not rejected"),
    ("right, no reference", mean, {}, "not rejected"),
    ("channels", lambda rng, n: rng.random((n, 3)).mean(axis=0), {"reference": [0.5, 0.5, 0.5]}, "not rejected"),
    ("an accumulator that is full", stalling, {"reference": 0.5}, "rejected"),
    ("full, no reference", stalling, {}, "rejected"),
    ("biased at every count", lambda rng, n: mean(rng, n) + 0.1, {"reference": 0.5}, "rejected"),
    ("overflow", lambda rng, n: mean(rng, n) if n < 100_000 else np.nan, {"reference": 0.5}, "rejected"),
    ("noise that grows", lambda rng, n: 0.5 + 1e-6 * n * rng.normal(), {"reference": 0.5}, "inconclusive"),
    ("one number", lambda rng, n: 0.4, {"reference": 0.5}, "inconclusive"),
    ("one number, near enough", lambda rng, n: 0.4, {"reference": 0.5, "tolerance": 0.3}, "not rejected"),
    ("marching, no reference", lambda rng, n: 0.5 + 1 / n, {}, "inconclusive"),
    ("marching, no reference, near enough", lambda rng, n: 0.5 + 1 / n, {"tolerance": 0.01}, "not rejected"),
    ("marching, no reference, not near", lambda rng, n: 0.5 + 1 / n, {"tolerance": 1e-5}, "rejected"),
    ("ray marching", lambda rng, n: 0.5 + 1 / n, {"reference": 0.5}, "not rejected"),
    ("ray marching in single precision", lambda rng, n: 0.5 + 1 / n + 1e-7 * n, {"reference": 0.5}, "rejected"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "run", "options", "outcome"), PROGRAMS, ids=[c[0] for c in PROGRAMS])
def test_more_samples_are_never_worse(name, run, options, outcome):
    counts = [1000, 30_000, 1_000_000] if "full" in name or "march" in name else [1000, 10_000, 100_000]
    verdict = check_convergence(run, counts, replicates=16, **options)
    assert verdict.outcome == outcome, str(verdict)


def test_a_program_that_disregards_the_count_gets_no_better():
    verdict = check_convergence(lambda rng, n: rng.random(100).mean(), [100, 1000, 1_000_000], reference=0.5)
    assert verdict.outcome == "inconclusive"
    assert "disregarded" in str(verdict)


def test_bad_counts_are_explained():
    for counts in ([100], [100, 10], [10, 10], [0, 10]):
        with pytest.raises(InvalidValueError, match="counts"):
            check_convergence(mean, counts)
    with pytest.raises(SubjectError, match="run"):
        check_convergence(lambda rng, n: rng.random((n, 2)), [10, 100])
    with pytest.raises(InvalidValueError, match="reference must be one number"):
        check_convergence(lambda rng, n: rng.random(n).mean(), [10, 100], reference=[0.5, 0.5])


class Congruential:
    """The generator of the C standard's example: its first numbers are linear in the seed."""

    def __init__(self, seed):
        self.state = seed

    def __call__(self, n):
        out = np.empty(n)
        for i in range(n):
            self.state = (1103515245 * self.state + 12345) % 2**31
            out[i] = self.state / 2**31
        return out


def overlapping(i):
    rng = np.random.Generator(np.random.PCG64(5))
    rng.random(10 * i)
    return rng


def hidden_state():
    rng = np.random.default_rng(3)
    return lambda i: rng


def antithetic(i):
    u = np.random.default_rng([4, i // 2]).random(256)
    return lambda n: u[:n] if i % 2 else 1 - u[:n]


def few_bits(rng, bits):
    """Return a stream of numbers that are cut to so many bits."""
    return lambda n: np.floor(rng.random(n) * 2.0**bits) / 2.0**bits


STREAMS = [
    ("spawned", lambda i: np.random.default_rng(np.random.SeedSequence(9, spawn_key=(i,))), ""),
    ("jumped", lambda i: np.random.Generator(np.random.PCG64(9).jumped(i)), ""),
    ("single precision", lambda i: lambda n: np.random.default_rng([1, i]).random(n, dtype=np.float32), ""),
    ("neighbouring seeds of a linear congruence", Congruential, "correlation"),
    ("eight bits", lambda i: few_bits(np.random.default_rng([3, i]), 8), ""),
    ("half precision", lambda i: few_bits(np.random.default_rng([4, i]), 11), ""),
    ("eight bits, overlapping", lambda i: few_bits(overlapping(i), 8), "dependent samples"),
    ("overlapping", overlapping, "dependent samples"),
    ("the same twice", lambda i: np.random.default_rng(i // 2), "dependent samples"),
    ("one generator for all", hidden_state(), "dependent samples"),
    ("antithetic neighbours", antithetic, "correlation"),
    ("not uniform", lambda i: lambda n: np.random.default_rng([2, i]).random(n) ** 1.05, "correlation"),
    ("one is reached", lambda i: lambda n: np.round(np.random.default_rng(i).random(n), 2), "outside the domain"),
]


@pytest.mark.parametrize(("name", "make_rng", "cause"), STREAMS, ids=[c[0] for c in STREAMS])
def test_streams(name, make_rng, cause):
    verdict = check_streams(make_rng, 400)
    assert verdict.cause == cause, str(verdict)
    assert verdict.outcome == ("rejected" if cause else "not rejected")


def test_p_values_of_right_streams_are_not_too_small():
    """Of the tests on 150 sets of right streams, no more reach 1e-2 than a bound on chance allows."""
    small = total = 0
    for seed in range(150):
        found = check_streams(lambda i, s=seed: np.random.default_rng([s, i]), 64, numbers=64).findings
        p_values = [f.p_value for f in found if f.p_value is not None]
        total += len(p_values)
        small += sum(p <= 0.01 for p in p_values)
    assert small <= 0.01 * total + 6 * np.sqrt(0.01 * total), f"{small} of {total}"


def test_streams_state_what_they_would_have_found():
    """Planted at the size that is stated: neighbours that are correlated so much, and numbers that are so uneven."""
    n, k = 64, 400
    right = check_streams(lambda i: np.random.default_rng([5, i]), k, numbers=n)
    stated = {f.check: f.resolution for f in right.findings if f.resolution is not None}
    assert len(stated) == 1 + 8 + 6, "every test that has a p-value"
    assert right.resolution is stated["all numbers"]
    size, uneven = stated["neighbours, 0 apart"].value, stated["all numbers"].value
    copied = 0.5 - math.sqrt(0.25 - size)  # c (1 - c) is the correlation
    found = {"neighbours, 0 apart": 0, "all numbers": 0}
    for seed in range(6):

        def alike(i, seed=seed):
            """Each number is its neighbour's with a small probability."""
            own, before = (np.random.default_rng([seed, i + 1 - back]).random(n) for back in (0, 1))
            return lambda m: np.where(np.random.default_rng([seed, i, 1]).random(n) < copied, before, own)

        def heavier(i, seed=seed):
            """The lower half has more numbers, the upper one less."""
            u = np.random.default_rng([seed, i]).random(n)
            return lambda m: np.where(u < 0.5 + uneven / 2, u / (1 + uneven), 1 - (1 - u) / (1 - uneven))

        for name, streams in zip(found, (alike, heavier), strict=True):
            verdict = check_streams(streams, k, numbers=n)
            found[name] += next(f for f in verdict.findings if f.check == name).outcome == "rejected"
    assert min(found.values()) >= 5, "each with probability 0.99"
