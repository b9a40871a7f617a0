"""For each check something broken that this check alone rejects: it, and no other, did it.

The findings of every call are the columns, the twins the rows; a row may not be rejected anywhere but where it is marked.
"""

import numpy as np
import pytest

from fogproof import (
    Box,
    Draw,
    Draws,
    HalfLine,
    Interval,
    Product,
    Reference,
    UnitSphere,
    UnitSquare,
    check_bound,
    check_convergence,
    check_estimator,
    check_mis,
    check_reciprocity,
    check_sampler,
    check_streams,
    compare_estimators,
)

N = 30_000


def rejecting(verdict):
    return {f.check for f in verdict.findings if f.outcome == "rejected"}


def flat(u):
    return u[:, 0]


def ones(x):
    return np.ones(len(x))


def sphere(u):
    sine, phi = 2 * np.sqrt(u[:, 0] * (1 - u[:, 0])), 2 * np.pi * u[:, 1]
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1 - 2 * u[:, 0]], axis=-1)


def forward(x):
    """A density of mean cosine 1/6 about z."""
    return (1 + 0.5 * x[:, 2]) / (4 * np.pi)


def leaning(sign):
    """Samples of that density, or of its mirror image."""

    def sample(u):
        mu = 2 * (np.sqrt(0.25 + 2 * u[:, 0]) - 1)
        sine, phi = np.sqrt(np.maximum(1 - mu * mu, 0)), 2 * np.pi * u[:, 1]
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), sign * mu], axis=-1)

    return sample


def stopped(u, **more):
    t = np.minimum(-np.log1p(-u[:, 0]), 1.0)
    return Draw(t, **{name: part(t) for name, part in more.items()})


def label(t):
    return (t == 1.0).astype(float)


LINE = Interval(0.0, 1.0)
END = {1.0: float(np.exp(-1))}
SQUARE = Product(Interval(0.0, 1.0), Interval(0.0, 1.0), Interval(0.0, 1.0))


def stateful():
    count = [0]

    def sample(u):
        count[0] += 1
        return u[:, 0] if count[0] % 2 else 1 - u[:, 0]

    return sample


def single_is_special(rng, n):
    return np.full(1, 0.01) if n == 1 else rng.random(n)


def rounded_cosine(rng, n):
    x = sphere(rng.random((n, 2)))
    mu = (np.floor(x[:, 2] * 2**13) + 0.5) / 2**13
    scale = np.sqrt(np.maximum(1 - mu * mu, 0) / (1 - x[:, 2] ** 2))
    return np.stack([x[:, 0] * scale, x[:, 1] * scale, mu], axis=-1)


def copied(share):
    def sample(rng, n):
        x = rng.random(n)
        again = rng.random(n) < share
        again[:500] = False
        x[again] = x[np.flatnonzero(again) - 500]
        return x

    return sample


def bent(u):
    """Along each axis a density 1 + 0.1 (6 x^2 - 6 x + 1): halves of an axis have their share."""
    x = np.linspace(0, 1, 10_001)
    return np.interp(u, x + 0.1 * (2 * x**3 - 3 * x**2 + x), x)


def striped(u):
    """Along the fifth axis 64 stripes of density 1.2 and 64 of 0.8: halves of the axis, and of its halves, have their share."""
    x = u.copy()
    pair, y = np.divmod(64 * u[:, 4], 1)
    x[:, 4] = (pair + np.where(y < 0.6, y / 1.2, 0.5 + (y - 0.6) / 0.8)) / 64
    return x


def by_its_own(sample, d):
    """The same from uniforms of its own: nobody sees the map."""
    return lambda rng, n: sample(rng.random((n, d)))


def given_up(share):
    return lambda u: Draw(u[:, 0], valid=u[:, 1] >= share)


SAMPLERS = {
    "domain": (lambda u: np.where(np.abs(u[:, 0] - 0.3) < 1e-4, -1.0, u[:, 0]), ones, LINE, {}),
    "normalisation": (flat, lambda x: np.full(len(x), 1 + 1e-5), LINE, {}),
    "positive pdf": (
        lambda u: np.where(np.abs(u[:, 0] - 0.7) < 1e-4, 0.3, u[:, 0]),
        lambda x: np.where(np.abs(x - 0.3) < 5e-8, 0.0, 1.0), LINE, {}),
    "returned pdf": (lambda u: Draw(u[:, 0], pdf=np.full(len(u), 1 + 5e-7)), ones, LINE, {}),
    "weight": (
        lambda u: Draw(u[:, 0], weight=(1 + 5e-7) * u[:, :1] * [1.0, 2.0]), ones, LINE,
        {"eval": lambda x: x[:, None] * [1.0, 2.0]}),
    "weight of the last channel": (
        lambda u: Draw(u[:, 0], weight=u[:, :1] * [1.0, 2.00001]), ones, LINE,
        {"eval": lambda x: x[:, None] * [1.0, 2.0]}),
    "finite weight": (lambda u: Draw(u[:, 0], weight=np.where(np.abs(u[:, 0] - 0.3) < 1e-3, np.nan, u[:, 0])), ones, LINE, {}),
    "finite pdf": (lambda u: Draw(u[:, 0], pdf=np.where(np.abs(u[:, 0] - 0.3) < 1e-3, np.nan, 1.0)), ones, LINE, {}),
    "returned probability": (
        lambda u: stopped(u, pdf=lambda t: np.where(t == 1, 0.36, np.exp(-t))), lambda t: np.exp(-t), LINE, {"atoms": END}),
    "event": (
        lambda u: stopped(u, event=lambda t: np.where((t > 0.5) & (t < 0.505), 1, label(t))), lambda t: np.exp(-t), LINE,
        {"atoms": END}),
    "event that says nothing": (lambda u: stopped(u, event=lambda t: 0 * t), lambda t: np.exp(-t), LINE, {"atoms": END}),
    "declared events": (
        lambda u: Draw(u[:, 0], event=np.where(np.abs(u[:, 0] - 0.3) < 1e-4, 7, 0)), ones, LINE, {"events": {0: 1.0}}),
    "declared event": (
        lambda u: Draw(u[:, 0], event=(u[:, 0] < 0.3).astype(int)), ones, LINE, {"events": {0: 0.5, 1: 0.5}}),
    "mean cosine": (leaning(-1), lambda x: forward(-x), UnitSphere(), {"axis": (0, 0, 1), "mean_cosine": 1 / 6, "dimensions": 2}),
    "mean cosine about another axis": (
        leaning(1), forward, UnitSphere(), {"axis": (1, 0, 0), "mean_cosine": 1 / 6, "dimensions": 2}),
    "pdf against the reference": (
        leaning(-1), lambda x: forward(-x), UnitSphere(), {"reference": lambda x: Reference(forward(x)), "dimensions": 2}),
    "pdf off its reference by 1e-6": (
        flat, ones, LINE, {"reference": lambda x: Reference(np.full(len(x), 1 + 1e-6), 1e-9)}),
    "albedo": (lambda u: Draw(u[:, 0], weight=u[:, 0]), ones, LINE, {"eval": lambda x: x, "albedo": 0.5001}),
    "albedo of the second channel": (
        lambda u: Draw(u[:, 0], weight=u[:, :1] * [1.0, 2.0]), ones, LINE,
        {"eval": lambda x: x[:, None] * [1.0, 2.0], "albedo": (0.5, 1.001)}),
    "albedo without quadrature": (
        lambda u: u, ones, SQUARE,
        {"eval": lambda x: x[:, :1] * [1.0, 2.0], "albedo": (0.5, 1.1), "dimensions": 3}),
    "mean weight": (lambda u: Draw(u[:, 0], weight=u[:, 0]), ones, LINE, {"albedo": 0.52}),
    "atom": (
        lambda u: np.where(u[:, 0] < 0.30, np.inf, -np.log1p(-u[:, 1])), lambda x: 0.75 * np.exp(-x), HalfLine(0.0),
        {"atoms": {np.inf: 0.25}, "dimensions": 2}),
    "edge uniforms": (lambda u: np.where(u[:, 0] == 0, np.nan, u[:, 0]), ones, LINE, {}),
    "function of its uniforms": (stateful(), ones, LINE, {}),
    "writes into its uniforms": (lambda u: np.subtract(1 - 2.0**-53, u, out=u)[:, 0].copy(), ones, LINE, {}),
    "calls of ten rows": (lambda u: u[:, 0] ** 2 if len(u) == 10 else u[:, 0], ones, LINE, {}),
    "size of the call": (single_is_special, ones, LINE, {"dimensions": None}),
    "different values of mu": (rounded_cosine, lambda x: np.full(len(x), 0.25 / np.pi), UnitSphere(), {"dimensions": None}),
    "repeated points": (copied(1e-3), ones, LINE, {"dimensions": None}),
    "serial correlation": (
        lambda rng, n: np.concatenate([x := rng.random((n + 1) // 2), 2 * x % 1])[:n], ones, LINE, {"dimensions": None}),
    "pdf against the map": (
        lambda u: sphere(u * [1.0, 0.999]), lambda x: np.full(len(x), 0.25 / np.pi), UnitSphere(),
        {"dimensions": 2, "axis": (0.6, 0.0, 0.8)}),
    "pdf against the map, in one part": (
        lambda u: np.where(u[:, 0] < 0.12, u[:, 0] + 0.12 * 1e-3 * np.sin(2 * np.pi * u[:, 0] / 0.12), u[:, 0]), ones, LINE, {}),
    "cdf against the pdf": (
        by_its_own(flat, 1), lambda x: 1 + 1e-3 * np.cos(2 * np.pi * x), LINE, {"cdf": lambda x: x, "dimensions": None}),
    "cdf against the pdf in the square": (
        by_its_own(np.asarray, 2), lambda x: 1 + 0.02 * np.cos(2 * np.pi * x[:, 0]), UnitSquare(),
        {"cdf": lambda x: x, "dimensions": None}),
    "labels along smooth functions": (by_its_own(bent, 8), ones, Box((0.0,) * 8, (1.0,) * 8), {"dimensions": None}),
    "labels along the axes": (by_its_own(striped, 8), ones, Box((0.0,) * 8, (1.0,) * 8), {"dimensions": None}),
    "continuous part": (given_up(0.0), ones, LINE, {"dimensions": 2, "atoms": {0.5: 0.1}}),
}  # fmt: skip
ALSO = {
    "normalisation": {"cdf against the pdf"},
    "continuous part": {"atom", "normalisation"},
    "returned probability": {"edge uniforms"},
    "event": {"edge uniforms"},
    "event that says nothing": {"edge uniforms"},
    "returned pdf": {"edge uniforms"},
    "weight": {"edge uniforms"},
    "atom": {"continuous part"},
    "domain": {"continuous part"},
    "positive pdf": {"repeated points"},
    "finite pdf": {"returned pdf"},
    "declared events": {"declared event"},
    "cdf against the pdf in the square": {"labels by level of the pdf"},
}
"""What has to see the same: an edge is a sample too, and what one atom has the rest has not."""

ROWS = {
    "weight of the last channel": "weight",
    "event that says nothing": "event",
    "mean cosine about another axis": "mean cosine",
    "pdf off its reference by 1e-6": "pdf against the reference",
    "albedo of the second channel": "albedo of channel 1",
    "albedo without quadrature": "albedo of channel 1",
    "writes into its uniforms": "function of its uniforms",
    "calls of ten rows": "function of its uniforms",
    "cdf against the pdf in the square": "cdf against the pdf",
    "pdf against the map, in one part": "pdf against the map",
}


@pytest.mark.parametrize("name", SAMPLERS)
def test_of_samplers(name):
    sample, pdf, domain, options = SAMPLERS[name]
    verdict = check_sampler(sample, pdf, domain, **{"dimensions": 1, "samples": N, "alpha": 1e-9, **options})
    check = ROWS.get(name, name)
    found = rejecting(verdict)
    assert check in found, str(verdict)
    edges = {"edge uniforms"} if check not in ("edge uniforms", "normalisation") else set()
    assert found <= {check, *ALSO.get(name, ()), *edges}, str(verdict)


def skewed_errors(scale):
    def draw(rng, n):
        x = rng.normal(size=(n, 16))
        return Draws(x.mean(axis=1), stderr=scale * x.std(axis=1, ddof=1) / 4)

    return draw


def ordered(rng, n):
    order = rng.integers(1, 3, n)
    return Draws(np.where(order == 1, 0.9, 1.1) * (0.5 + rng.random(n)), order=order)


def costly(rng, n):
    return Draws(rng.random(n), cost=rng.poisson(3.0, n).astype(float))


def stratified(rng, n):
    return rng.permutation((np.arange(n) + rng.random(n)) / n)


def neighbours(rng, n):
    x = rng.normal(size=n + 1)
    return (x[1:] + 0.3 * x[:-1]) / np.sqrt(1.09)


def from_a_short_stream():
    stream = np.random.default_rng(11).random(70_000)
    at = [0]

    def draw(rng, n):
        at[0] += n
        return stream[np.arange(at[0] - n, at[0]) % len(stream)]

    return draw


ESTIMATORS = {
    "finite values": (lambda rng, n: np.where(np.arange(n) == n - 1, np.inf, rng.random(n)), 0.5, {}),
    "mean": (lambda rng, n: rng.random(n), 0.52, {}),
    "mean of channel 1": (lambda rng, n: rng.random((n, 2)), [0.5, 0.52], {}),
    "mean of order 2": (ordered, {1: 0.45, 2: 0.60}, {}),
    "variance": (lambda rng, n: 0.25 + 0.5 * rng.random(n), 0.5, {"variance": 1 / 12, "bounds": (0, 1)}),
    "cost": (costly, 0.5, {"cost": 3.1}),
    "bounds": (lambda rng, n: 1.2 * rng.random(n), 0.6, {"bounds": (0.0, 1.0)}),
    "square of the error less that of the standard error": (skewed_errors(1.1), 0.0, {"alpha": 1e-6}),
    "correlation of realisations": (neighbours, 0.0, {}),
    "repeated realisations": (from_a_short_stream(), np.random.default_rng(11).random(70_000).mean(), {"samples": 140_000}),
}  # fmt: skip


@pytest.mark.parametrize("name", ESTIMATORS)
def test_of_estimators(name):
    draw, reference, options = ESTIMATORS[name]
    verdict = check_estimator(draw, reference, **{"samples": N, "alpha": 1e-9, **options})
    also = {"realisations that occur twice"} if name == "repeated realisations" else set()
    assert name in rejecting(verdict), str(verdict)
    assert rejecting(verdict) <= {name, *also}, str(verdict)


def test_of_calls_that_scatter_too_little():
    """Each call is stratified: means, neighbours and values are right, calls are too alike."""
    verdict = check_estimator(stratified, 0.5, samples=20 * 65_536, alpha=1e-9)
    assert rejecting(verdict) >= {"scatter of calls", "evenness of calls"}, str(verdict)
    assert rejecting(verdict) <= {"scatter of calls", "evenness of calls", "variance"}


def test_of_calls_whose_values_are_too_even():
    """Stratified in their size and not in their sign: the mean of a call scatters as it should."""
    verdict = check_estimator(
        lambda rng, n: rng.choice([-1.0, 1.0], n) * stratified(rng, n), 0.0, samples=20 * 65_536, alpha=1e-9
    )
    assert rejecting(verdict) == {"evenness of calls"}, str(verdict)


def test_of_coverage():
    """Standard errors whose squares are right on average, and which lie ten times too low where they are needed."""

    def draw(rng, n):
        small = rng.random(n) < 0.5
        spread = np.where(small, np.sqrt(1.9), np.sqrt(0.1))
        told = np.where(small, np.sqrt(0.1), np.sqrt(1.9))
        return Draws(spread * rng.normal(size=n), stderr=told)

    verdict = check_estimator(draw, 0.0, samples=N, alpha=1e-9)
    assert rejecting(verdict) == {"coverage of standard errors"}, str(verdict)


def test_of_comparisons():
    def same(rng, n):
        return rng.normal(size=n)

    assert rejecting(compare_estimators(same, lambda rng, n: rng.normal(0.1, 1, n), samples=N)) == {"difference"}
    last = compare_estimators(
        lambda rng, n: rng.normal(size=(n, 2)), lambda rng, n: rng.normal([0.0, 0.1], 1, (n, 2)), samples=N
    )
    assert rejecting(last) == {"difference in channel 1"}
    assert rejecting(compare_estimators(same, neighbours, samples=N)) <= {
        "correlation of realisations of the second",
        "correlation of realisations",
    }
    wrong = compare_estimators(skewed_errors(1.0), skewed_errors(1.2), samples=80_000)
    assert rejecting(wrong) == {"square of the error less that of the standard error of the second"}, str(wrong)
    right = compare_estimators(skewed_errors(1.0), skewed_errors(1.0), samples=80_000)
    assert right.outcome == "not rejected", str(right)


def test_of_calls_of_a_few_realisations():
    """Asked for less than a hundred at once it is off by as much as a hundred thousand others hide."""
    verdict = check_estimator(lambda rng, n: rng.random(n) + (n < 100), 0.5, samples=2 * 65_536, alpha=1e-9)
    assert rejecting(verdict) == {"scatter of calls"}, str(verdict)


def test_of_one_that_never_varies():
    verdict = compare_estimators(lambda rng, n: np.full(n, 0.5), lambda rng, n: rng.random(n), samples=N)
    assert verdict.outcome == "inconclusive", str(verdict)


def test_of_programs_and_streams():
    def biased(rng, n):
        return rng.random(n).mean() + 0.5 * (n > 500)

    assert rejecting(check_convergence(biased, [100, 1000], reference=0.5)) == {"mean with 1000 samples"}
    worse = check_convergence(lambda rng, n: {1: 1.2, 10: 1.1, 100: 4.0}[n], [1, 10, 100], reference=1.0)
    assert rejecting(worse) == {"error with 100 samples"}

    def shifted(i):
        """Each stream is good; the second number of one is the first of the next."""
        base = np.random.default_rng(3).random(2000)
        return lambda n: np.concatenate([base[i : i + 2], np.random.default_rng([9, i]).random(n - 2)])

    found = rejecting(check_streams(shifted, 1000))
    assert {f for f in found if "1 apart" in f} or found == set()
    outside = check_streams(lambda i: lambda n: np.random.default_rng(i).random(n) + (i == 77) * 0.5, 200)
    assert rejecting(outside) == {"range"}


def test_of_weights_bounds_and_reciprocity():
    uniform, linear = (flat, ones, 1), (lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, 1)

    def balance(x, n=1.0, beta=1.0):
        p = np.stack([n * np.ones(len(x)), 2 * x], axis=-1) ** beta
        return p / p.sum(axis=1, keepdims=True)

    pair = [uniform, linear]
    assert rejecting(check_mis(pair, lambda x: balance(x) * 1.001)) >= {"sum of weights"}
    own = {"weights of strategy 0", "weights of strategy 1"}
    assert rejecting(check_mis(pair, lambda x: balance(x, 2.0))) == own
    assert rejecting(check_mis(pair, balance, counts=[2, 1])) == own
    assert check_mis(pair, lambda x: balance(x, 2.0), counts=[2, 1]).outcome == "not rejected"
    assert rejecting(check_mis(pair, balance, exponent=2.0)) == own
    assert check_mis(pair, lambda x: balance(x, beta=2.0), exponent=2.0).outcome == "not rejected"
    half = (lambda u: 0.5 * u[:, 0], lambda x: np.where(x < 0.5, 2.0, 0.0), 1)
    equal = check_mis([uniform, half], lambda x: np.full((len(x), 2), 0.5), exponent=None)
    assert rejecting(equal) == {"weights without samples"}

    assert rejecting(check_bound(lambda x: np.where(x > 0.999999, 1.03, 0.5), 1.0, LINE)) == {"above everywhere"}
    assert rejecting(check_bound(lambda x: 1 + 0.03 * np.exp(-(((x - 0.3) / 1e-3) ** 2)), 1.0299, LINE)) == {
        "above everywhere"
    }

    def cosine(a, b):
        return np.sum(a * b, axis=1)

    one_way = check_reciprocity(
        lambda a, b: 1 + 0.5 * cosine(a, b) + 0.1 * a[:, 2] * (1 + 0 * b[:, 2]), isotropic=False
    )
    assert rejecting(one_way) == {"reciprocity"}
    turned = check_reciprocity(lambda a, b: 1 + 0.5 * cosine(a, b) + 0.1 * a[:, 2] * b[:, 2])
    assert rejecting(turned) == {"rotation"}
