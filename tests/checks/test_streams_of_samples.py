"""Samples that know each other, come twice, or are made of few bits are found and named; independent ones are left alone."""

import numpy as np
import pytest

from fogproof import Discrete, Interval, UnitDisk, UnitSphere, UnitSquare, check_sampler
from fogproof.checks.few_values import few_values, few_values_axes
from fogproof.checks.statistics.repeats import repeats_test
from fogproof.checks.statistics.serial import LAGS, Successions, in_units, serial_test
from fogproof.checks.subject import Subject

UNIT = Interval(0, 1)
N = 1 << 17


def ones(x):
    return np.ones(len(x))


def successions(u, batch=1 << 16):
    """Return the sums over u (n, k), counted batch by batch."""
    total = None
    for start in range(0, len(u), batch):
        part = Successions.of([in_units(column) for column in u[start : start + batch].T], True)
        total = part if total is None else total.merged(part)
    return total


def test_lagged_products_are_those_of_a_loop():
    u = np.random.default_rng().random((LAGS * 20 + 7, 2))
    sums = Successions.of([in_units(column) for column in u.T], True)
    plain = in_units(u).astype(np.int64)
    c = (np.concatenate([plain, 2 * np.abs(plain) - 2**14], axis=1) >> 9)[: LAGS * 20]
    for lag in (1, 2, 17, 63, 64):
        expected = c[:-lag].T @ c[lag:]
        assert np.array_equal(sums.lagged[lag - 1], expected)
        assert sums.many[lag] == len(c) - lag


def correlated(rng, n, lag, r):
    """Return uniform numbers whose correlation with those `lag` earlier is about r."""
    from scipy.signal import lfilter
    from scipy.special import ndtr

    feedback = np.zeros(lag + 1)
    feedback[[0, lag]] = 1, -r
    return ndtr(lfilter([np.sqrt(1 - r * r)], feedback, rng.normal(size=n + 10 * lag))[10 * lag :])


@pytest.mark.parametrize("lag", [1, 2, 37, 64])
def test_a_correlation_of_a_twentieth_is_found_at_any_lag(lag):
    u = correlated(np.random.default_rng(), 2 * N, lag, 0.05)
    finding = serial_test("serial correlation", successions(u[:, None]), 1e-7)
    assert finding.outcome == "rejected"
    assert ("successive" if lag == 1 else f"samples {lag} apart") in finding.message
    assert finding.resolution.value < 0.05


def call_by_call(make):
    return lambda rng, n: make(rng, n)[:n]


def one_number_late(rng, n):
    """The second number of a sample is the first one of the next."""
    v = rng.random(n + 1)
    return np.stack([v[:-1], v[1:]], axis=-1)


STREAMS = {
    "antithetic neighbours": (
        lambda rng, n: np.stack([v := rng.random((n + 1) // 2), 1 - v], axis=-1).ravel(), "serial correlation", "antithetic"),
    "antithetic halves": (
        lambda rng, n: np.concatenate([v := rng.random((n + 1) // 2), 1 - v]), "serial correlation", "antithetic"),
    "every point twice": (lambda rng, n: np.repeat(rng.random((n + 1) // 2), 2), "repeated points", "again right after"),
    "the same in four threads": (lambda rng, n: np.tile(rng.random((n + 3) // 4), 4), "repeated points", "points later"),
    "a third copied": (
        lambda rng, n: np.concatenate([v := rng.random(n - n // 3), v[: n // 3]]), "repeated points", "points later"),
    "15 bits": (lambda rng, n: rng.integers(0, 1 << 15, n) / 2.0**15, "repeated points", "few bits"),
    "one point often": (lambda rng, n: np.where(rng.random(n) < 1e-3, 0.4, rng.random(n)), "repeated points", "one point comes"),
}  # fmt: skip


@pytest.mark.parametrize("name", STREAMS)
def test_dependent_streams_are_named(name):
    make, check, words = STREAMS[name]
    verdict = check_sampler(call_by_call(make), ones, UNIT, dimensions=None, samples=N)
    finding = next(f for f in verdict.findings if f.check == check)
    assert finding.outcome == "rejected", str(verdict)
    assert words in finding.message


def test_numbers_used_twice_are_seen_across_the_axes():
    verdict = check_sampler(call_by_call(one_number_late), ones, UnitSquare(), dimensions=None, samples=N)
    assert "serial correlation" in [f.check for f in verdict.findings if f.outcome == "rejected"], str(verdict)


def directions(mu, phi):
    sine = np.sqrt(np.maximum(1 - mu * mu, 0))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


def coarse(u, bits):
    return (np.floor(u * 2**bits) + 0.5) / 2**bits


COARSE = {
    "mu of 16 bits": (UnitSphere(), lambda u: directions(2 * coarse(u[:, 0], 16) - 1, 2 * np.pi * u[:, 1]), "mu"),
    "azimuth of 16 bits": (UnitSphere(), lambda u: directions(2 * u[:, 0] - 1, 2 * np.pi * coarse(u[:, 1], 16)), "phi"),
    "radius of 20 bits": (
        UnitDisk(), lambda u: np.sqrt(coarse(u[:, :1], 20)) * directions(0 * u[:, 0], 2 * np.pi * u[:, 1])[:, :2], "r^2"),
    "one axis of 15 bits": (UnitSquare(), lambda u: np.stack([coarse(u[:, 0], 15), u[:, 1]], axis=-1), "x"),
    "one axis of 9 bits": (UnitSquare(), lambda u: np.stack([coarse(u[:, 0], 9), u[:, 1]], axis=-1), "x"),
    "one axis of 4 bits": (UnitSquare(), lambda u: np.stack([coarse(u[:, 0], 4), u[:, 1]], axis=-1), "x"),
    "mu of 8 bits": (
        UnitSphere(), lambda u: directions(1 - np.floor(256 * u[:, 0]) / 128, 2 * np.pi * u[:, 1]), "mu"),
    "azimuth of 8 bits": (
        UnitSphere(), lambda u: directions(2 * u[:, 0] - 1, np.floor(256 * u[:, 1]) * np.pi / 128), "phi"),
}  # fmt: skip


@pytest.mark.parametrize("name", COARSE)
def test_few_values_of_one_coordinate_are_found(name):
    domain, sample, axis = COARSE[name]
    verdict = check_sampler(
        sample, lambda x: np.full(len(x), 1 / domain.measure), domain, dimensions=2, samples=N, alpha=1e-6
    )
    assert verdict.cause == "coarse numbers", str(verdict)
    rejecting = {f.check for f in verdict.findings if f.outcome == "rejected"}
    assert f"different values of {axis}" in rejecting
    bits = int("".join(filter(str.isdigit, name)))
    assert bits > 10 or f"{axis} takes {1 << bits} values alone" in verdict.diagnosis, verdict.diagnosis


def rejections(domain, sample, precision="float64", seeds=20):
    found = 0
    for _ in range(seeds):
        u = np.random.default_rng().random((1 << 16, 2), dtype=precision)
        x = np.asarray(sample(u), dtype=np.float64)
        subject = Subject(None, None, domain, None, precision=precision)
        findings = [few_values("values", subject, axis, x[:999], x, 1e-4) for axis in few_values_axes(subject)]
        found += any(f.outcome == "rejected" for f in findings)
    return found


@pytest.mark.parametrize("width", [2.0, 1e-4, 1e-9])
def test_narrow_lobes_of_fine_numbers_are_no_fault(width):
    def sample(u):
        versine = width * u[:, 0]
        sine, phi = np.sqrt(versine * (2 - versine)), 2 * np.pi * u[:, 1]
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1 - versine], axis=-1)

    assert rejections(UnitSphere(), sample) == 0


@pytest.mark.parametrize("law", [
    lambda u: 1 - u**40,  # most of it within rounding of 1
    lambda u: np.where(u < 0.95, (np.floor(5 * u) + 0.5) / 5, u),  # lobes too narrow for rounding
])  # fmt: skip
def test_what_rounding_makes_one_is_no_fault(law):
    assert rejections(UnitSquare(), lambda u: np.stack([law(u[:, 0]), u[:, 1]], axis=-1)) == 0


def test_single_precision_is_no_fault_where_it_is_declared():
    def sample(u):
        return directions(2 * u[:, 0] - 1, np.float32(2 * np.pi) * u[:, 1])

    assert rejections(UnitSphere(), sample, "float32") == 0


def test_uniforms_of_32_bits_are_declared():
    def sample(rng, n):
        return rng.integers(0, 1 << 32, n) * 2.0**-32

    for bits, outcome in ((None, "rejected"), (32, "not rejected")):
        verdict = check_sampler(sample, ones, UNIT, dimensions=None, samples=1 << 19, uniform_bits=bits, alpha=1e-5)
        finding = next(f for f in verdict.findings if f.check == "repeated points")
        assert finding.outcome == outcome or (bits is None and finding.statistic < 30), str(finding)


def test_an_atom_of_the_stated_size_is_caught():
    n, rng, caught = 1 << 16, np.random.default_rng(), 0
    for _ in range(100):
        x = rng.integers(1, 1 << 62, n, dtype=np.uint64)
        size = repeats_test("repeated points", x[:n], lambda n: 1e-3, 1e-7).resolution.value
        x[rng.random(n) < size] = 0
        caught += repeats_test("repeated points", x, lambda n: 1e-3, 1e-7).outcome == "rejected"
    assert caught >= 94, "99 of 100 were promised"


def test_rare_values_are_no_correlation():
    p = 1e-3
    options = {"dimensions": 1, "samples": 20_000, "alpha": 1e-4}
    verdicts = [
        check_sampler(lambda u: (u[:, 0] < p) * 1.0, lambda i: np.where(i == 1, p, 1 - p), Discrete(2), **options)
        for _ in range(60)
    ]
    assert all(v.outcome == "not rejected" for v in verdicts)


@pytest.mark.parametrize("dimensions", [1, 2])
def test_a_stream_without_correlation_that_knows_its_neighbour_is_found(dimensions):
    """The tent map: uniform, uncorrelated at every lag, and each number follows from the one before."""

    def tent(rng, n):
        x = np.empty((n, dimensions))
        x[0] = rng.random(dimensions)
        for i in range(1, n):
            x[i] = 1 - np.abs(1 - 2 * x[i - 1]) + 1e-9 * rng.random()  # doubling runs out of bits
        return np.clip(x[:, 0] if dimensions == 1 else x, 0, 1)

    domain = Interval(0, 1) if dimensions == 1 else UnitSquare()
    verdict = check_sampler(tent, ones, domain, dimensions=None, samples=20_000)
    found = next(f for f in verdict.findings if f.check == "serial correlation")
    assert found.outcome == "rejected", str(verdict)
    assert "how far from the middle" in found.message


@pytest.mark.parametrize(
    ("again", "cause"), [([1, 2], "coarse numbers"), ([1, 1], "atom"), ([1, 2, 3, 4], "coarse numbers")]
)
def test_different_points_that_come_twice_each_speak_of_few_bits(again, cause):
    prints = np.concatenate([np.arange(50_000, dtype=np.uint64), np.array(again, dtype=np.uint64)])
    finding = repeats_test("repeated points", prints, lambda n: 1e-6, 1e-7)
    assert (finding.outcome, finding.cause) == ("rejected", cause)
