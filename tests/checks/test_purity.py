"""A sampler that is no pure function of its uniforms is found out and named; a right one is not, whatever its calls look like."""

import numpy as np
import pytest
from scipy.special import ndtri

from fogproof import Box, Discrete, Draw, HalfLine, Interval, UnitSphere, UnitSquare, check_sampler
from fogproof.checks.call_sizes import CALLS, one_law
from fogproof.checks.subject import Subject

UNIT = Interval(0, 1)


def ones(x):
    return np.ones(len(x))


class Stale:
    """Samples with the exponent that the call before it left behind."""

    def __init__(self):
        self.exponent = 1.0

    def __call__(self, u):
        exponent, self.exponent = self.exponent, 1 + u[-1, 0]
        return u[:, 0] ** exponent


class Alternating:
    """Another exponent in every so manyth call."""

    def __init__(self, period):
        self.period, self.calls = period, 0

    def __call__(self, u):
        self.calls += 1
        return u[:, 0] ** (1.0 if self.calls % self.period else 1.5)


def in_place(u):
    u *= 0.5
    return 2 * u[:, 0]


def own_generator(generator):
    return lambda u: generator.random(len(u))


def newton(u):
    """Solve x + sin(x) / 4 = c u for all rows at once, until the slowest is there."""
    c, x = 1 + 0.25 * np.sin(1.0), u[:, 0].copy()
    for _ in range(50):
        step = (x + 0.25 * np.sin(x) - c * u[:, 0]) / (1 + 0.25 * np.cos(x))
        x = x - step
        if np.all(np.abs(step) < 1e-9):
            break
    return np.clip(x, 0, 1)


IMPURE = {
    "hidden generator": (lambda: own_generator(np.random.default_rng(9)), "hidden state"),
    "parameter of the call before": (Stale, "hidden state"),
    "every second call": (lambda: Alternating(2), "hidden state"),
    "every fifth call": (lambda: Alternating(5), "hidden state"),
    "seeds itself": (lambda: lambda u: np.random.default_rng(3).random(len(u)), "ignores its uniforms"),
    "works in place": (lambda: in_place, "writes into its uniforms"),
    "one row too late": (lambda: lambda u: np.roll(u[:, 0], 1), "order of the rows"),
    "stratified over the call": (lambda: lambda u: (np.arange(len(u)) + u[:, 0]) / len(u), "order of the rows"),
    "other law in small calls": (lambda: lambda u: u[:, 0] if len(u) > 100 else u[:, 0] ** 2, "size of the call"),
    "other law in calls of one": (lambda: lambda u: u[:, 0] if len(u) > 1 else u[:, 0] ** 2, "size of the call"),
    "fails in calls of one": (lambda: lambda u: np.squeeze(u), "size of the call"),
    "weights by the call": (lambda: lambda u: Draw(u[:, 0], weight=np.full(len(u), 1e4 / len(u))), "size of the call"),
}


@pytest.mark.parametrize("name", IMPURE)
def test_impure_samplers_are_named(name):
    make, cause = IMPURE[name]
    verdict = check_sampler(make(), ones, UNIT, dimensions=1, samples=20_000)
    finding = next(f for f in verdict.findings if f.check == "function of its uniforms")
    assert finding.outcome == "rejected", str(verdict)
    assert verdict.cause == cause, str(verdict)


def test_rounding_and_unused_columns_are_no_fault():
    scale = 1 + 0.25 * np.sin(1.0)
    verdict = check_sampler(newton, lambda x: (1 + 0.25 * np.cos(x)) / scale, UNIT, dimensions=2, samples=20_000)
    finding = next(f for f in verdict.findings if f.check == "function of its uniforms")
    assert verdict.outcome == "not rejected", str(verdict)
    assert finding.message.endswith("depends on: 1")


def steps(u):
    """-log u: infinite for u = 0, in five dimensions of which one is used."""
    return -np.log(u[:, 3])


def empty_segment(u):
    """The medium begins at x = 1, and u = 0 is found in the empty space before it."""
    return np.where(u[:, 0] == 0, 0.0, 1 - np.log1p(-u[:, 0]))


def table(probabilities):
    p = np.array(probabilities)
    return {
        "sample": lambda u: np.searchsorted(np.cumsum(p), u[:, 0], side="left"),
        "pdf": lambda i: p[i.astype(int)],
        "domain": Discrete(len(p)),
    }


def returning(**parts):
    return lambda u: Draw(u[:, 0], **{name: part(u[:, 0]) for name, part in parts.items()})


EDGES = {
    "log of zero in five dimensions": ({"sample": steps, "pdf": lambda x: np.exp(-x), "domain": HalfLine(0)}, 5),
    "scatters in empty space": (
        {"sample": empty_segment, "pdf": lambda x: np.where(x >= 1, np.exp(1 - np.maximum(x, 1)), 0.0), "domain": HalfLine(0)}, 1),
    "a gap at 0 before a root": (
        {"sample": lambda u: np.where(u[:, 0] == 0, 0.0, 0.001 + 0.999 * np.sqrt(u[:, 0])),
         "pdf": lambda x: np.where(x > 0.001, 2 * (x - 0.001) / 0.999**2, 0.0)}, 1),
    "a density that is no number at its edge": (
        {"sample": lambda u: np.sqrt(u[:, 0]), "pdf": lambda x: np.where(x == 0, np.nan, 2 * x)}, 1),
    "an event of probability 0": (table([0, 0.5, 0.5]), 1),
    "returned pdf infinite": ({"sample": returning(pdf=lambda x: np.where(x == 0, np.inf, 1.0))}, 1),
    "weight not a number": ({"sample": returning(weight=lambda x: np.where(x == 0, np.nan, 1.0))}, 1),
}  # fmt: skip


@pytest.mark.parametrize("name", EDGES)
def test_edge_uniforms_keep_every_promise(name):
    subject, dimensions = EDGES[name]
    arguments = {"sample": lambda u: u[:, 0], "pdf": ones, "domain": UNIT, **subject}
    sample, pdf, domain = (arguments.pop(key) for key in ("sample", "pdf", "domain"))
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=20_000)
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} == {"edge uniforms"}, str(verdict)
    assert verdict.cause == "edge of the uniforms"


def levy(u):
    """Its density exp(-1 / (2 x)) x^-1.5 / sqrt(2 pi) is 0 to every order at x = 0, and underflows long before."""
    with np.errstate(divide="ignore"):
        return 1 / ndtri(u[:, 0] / 2) ** 2


def levy_pdf(x):
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(x > 0, np.exp(-0.5 / x) * x**-1.5 / np.sqrt(2 * np.pi), 0.0)


SOUND = {
    "density 0 to every order at its edge": (levy, levy_pdf, HalfLine(0), 1),
    "a limit that is approached very slowly": (
        lambda u: np.maximum(-np.log(np.maximum(u[:, 0], 5e-324)), 1e-300) ** -0.1 * (u[:, 0] > 0),
        lambda x: 10 * np.exp(-np.maximum(x, 1e-20) ** -10) * np.maximum(x, 1e-20) ** -11, HalfLine(0), 1),
    "the same where 1 - u is 1": (
        lambda u: levy(1 - (1 - u)), levy_pdf, HalfLine(0), 1),
    "the same at the upper end": (
        lambda u: 1 / (1 + levy(u)), lambda y: levy_pdf(1 / y - 1) / y**2, UNIT, 1),
    "beside a second coordinate": (
        lambda u: np.stack([1 / (1 + levy(u)), u[:, 1]], axis=-1),
        lambda y: levy_pdf(1 / y[:, 0] - 1) / y[:, 0] ** 2, UnitSquare(), 2),
    "density 0 at its own edge": (lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, UNIT, 1),
    "a fifth root": (lambda u: u[:, 0] ** 0.2, lambda x: 5 * x**4, UNIT, 1),
    "density infinite at its edge": (lambda u: u[:, 0] ** 2, lambda x: 0.5 / np.sqrt(x), UNIT, 1),
    "eleven dimensions": (lambda u: u[:, 10], ones, UNIT, 11),
    "weight known in closed form": (
        lambda u: Draw(np.sqrt(u[:, 0]), weight=np.full(len(u), 0.5)), lambda x: 2 * x, UNIT, 1),
    "its own generator": (lambda rng, n: rng.random(n), ones, UNIT, None),
}  # fmt: skip


@pytest.mark.parametrize("name", SOUND)
def test_what_is_right_at_the_edges_is_left_alone(name):
    sample, pdf, domain, dimensions = SOUND[name]
    options = {"eval": lambda x: x, "albedo": 0.5} if name.startswith("weight") else {}
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=20_000, alpha=1e-9, **options)
    assert not [f for f in verdict.findings if f.outcome == "rejected"], str(verdict)
    finding = next(f for f in verdict.findings if f.check == "edge uniforms")
    assert ("dimensions=None" in finding.message) == (dimensions is None)


@pytest.mark.parametrize("part", ["weight", "pdf"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_nothing_returned_may_be_no_number(part, value):
    sample = returning(**{part: lambda x: np.where(x < 1e-3, value, 1.0)})
    verdict = check_sampler(sample, ones, UNIT, dimensions=1, albedo=1.0, samples=20_000)
    assert "not a number" in [f.cause for f in verdict.findings if f.check == f"finite {part}"], str(verdict)


def test_shares_of_events_are_tested_where_declared_and_reported_where_not():
    def sample(u):
        return Draw(u[:, 0], event=(u[:, 1] < 0.33).astype(int))

    def check(**options):
        return check_sampler(sample, ones, UNIT, dimensions=2, samples=100_000, **options)

    silent = check()
    assert silent.outcome == "not rejected"
    assert "event labels" in silent.unchecked[0]
    assert "unchecked: event labels" in str(silent)
    right = check(events={0: 0.67, 1: 0.33})
    assert right.outcome == "not rejected", str(right)
    assert not right.unchecked
    assert check(events={0: 0.7, 1: 0.3}).cause == "wrong event label"
    assert check(events={0: 0.67, 2: 0.33}).cause == "wrong event label", "a label that is not declared"
    weighted = check_sampler(returning(weight=ones), ones, UNIT, dimensions=1, samples=20_000)
    assert "weights" in weighted.unchecked[0]


def sphere(u):
    mu, phi = 2 * u[:, 0] - 1, 2 * np.pi * u[:, 1]
    return np.stack([np.sqrt(1 - mu * mu) * np.cos(phi), np.sqrt(1 - mu * mu) * np.sin(phi), mu], axis=-1)


def test_the_sphere_has_edges_too():
    verdict = check_sampler(sphere, lambda x: np.full(len(x), 0.25 / np.pi), UnitSphere(), dimensions=2, samples=20_000)
    assert verdict.outcome == "not rejected", str(verdict)


@pytest.mark.parametrize(("g", "precision"), [(0.99, "float64"), (0.999, "float64"), (0.9, "float32")])
def test_a_textbook_cosine_may_leave_its_range_by_rounding_but_a_length_may_not_be_wrong(g, precision):
    """1 + g^2 - s^2 loses digits in a narrow lobe: mu = -1 - 2e-15 for g = 0.99, which is the same direction."""

    def scattered(u):
        kind = u.dtype.type
        s = (kind(1) - kind(g * g)) / (kind(1) - kind(g) + kind(2 * g) * u[:, 0])
        mu, phi = (kind(1 + g * g) - s * s) / kind(2 * g), kind(2 * np.pi) * u[:, 1]
        sine = np.sqrt(np.maximum(kind(1) - mu * mu, kind(0)))
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)

    def pdf(x):
        return (1 - g * g) / (4 * np.pi * ((1 - g) ** 2 + g * np.sum((x - [0, 0, 1]) ** 2, axis=-1)) ** 1.5)

    arguments = {"dimensions": 2, "samples": 20_000, "precision": precision}
    verdict = check_sampler(scattered, pdf, UnitSphere(), **arguments)
    assert verdict.outcome != "rejected", str(verdict)
    off = 1e-6 if precision == "float64" else 1e-2
    verdict = check_sampler(lambda u: scattered(u) * u.dtype.type(1 + off), pdf, UnitSphere(), **arguments)
    assert "domain" in {f.check for f in verdict.findings if f.outcome == "rejected"}


def turned(rng, n):
    """Directions, all of one meridian where they are asked for one by one."""
    return sphere(np.stack([rng.random(n), rng.random(n) if n > 1 else np.zeros(n)], axis=-1))


OWN = {
    "one sample is special": (lambda rng, n: rng.random(n) ** (1 if n > 1 else 6), ones, UNIT),
    "few samples are special": (lambda rng, n: rng.random(n) ** (1 if n > 100 else 3), ones, UNIT),
    "a thousand are still special": (lambda rng, n: rng.random(n) ** (1 if n > 1000 else 1.3), ones, UNIT),
    "directions one by one": (turned, lambda x: np.full(len(x), 0.25 / np.pi), UnitSphere()),
    "integers": (lambda rng, n: rng.integers(0, 6, n) if n > 10 else np.zeros(n), lambda i: np.full(len(i), 1 / 6), Discrete(6)),
}  # fmt: skip


@pytest.mark.parametrize("name", OWN)
def test_a_sampler_with_its_own_uniforms_has_one_law_in_calls_of_any_size(name):
    sample, pdf, domain = OWN[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=None, samples=20_000)
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} == {"size of the call"}, str(verdict)
    assert verdict.cause == "size of the call"
    right = check_sampler(lambda rng, n: sample(rng, n + 2000)[:n], pdf, domain, dimensions=None, samples=20_000)
    assert right.outcome == "not rejected", str(right)


def test_the_p_value_of_small_calls_is_an_upper_bound():
    """Of 400 right samplers, no more have p <= 0.05 than a twentieth and six standard deviations."""
    subject = Subject(lambda rng, n: rng.random(n), ones, UNIT, None, {})
    p = []
    for seed in range(400):
        pilot = np.random.default_rng().random(4000)
        calls = {size: np.random.default_rng().random(count * size) for size, count in CALLS.items()}
        p.append(one_law("size", subject, calls, pilot, seed, 1e-6).p_value)
    assert np.mean(np.array(p) <= 0.05) <= 0.05 + 6 * np.sqrt(0.05 * 0.95 / 400)


def test_an_interval_may_lie_far_from_0():
    far = Interval(1e9, 1e9 + 1)
    verdict = check_sampler(lambda u: 1e9 + u[:, 0], lambda x: np.ones(len(x)), far, dimensions=1, samples=50_000)
    assert verdict.outcome == "not rejected", str(verdict)
    stateful = own_generator(np.random.default_rng())
    verdict = check_sampler(lambda u: 1e9 + stateful(u), lambda x: np.ones(len(x)), far, dimensions=1, samples=50_000)
    assert verdict.cause == "hidden state"


@pytest.mark.parametrize("corner", [0.0, 1e12, -1e12])
def test_a_box_may_lie_far_from_0(corner):
    box = Box((corner,) * 3, (corner + 1,) * 3)
    verdict = check_sampler(lambda u: corner + u, lambda x: np.ones(len(x)), box, dimensions=3, samples=50_000)
    assert verdict.outcome == "not rejected", str(verdict)


def test_a_pdf_with_a_state_of_its_own_is_found():
    rng = np.random.default_rng()
    noisy = lambda x: 1 + 0.1 * rng.normal(size=len(x))  # noqa: E731
    verdict = check_sampler(lambda u: u[:, 0], noisy, Interval(0, 1), dimensions=1, samples=20_000)
    assert "function of its point" in [f.check for f in verdict.findings if f.outcome == "rejected"]


def test_a_pdf_that_writes_into_its_points_is_named():
    def pdf(x):
        x *= 2
        return x

    verdict = check_sampler(lambda u: np.sqrt(u[:, 0]), pdf, UNIT, dimensions=1, samples=2000)
    assert (verdict.outcome, verdict.cause) == ("rejected", "writes into its points"), str(verdict)


def test_numbers_that_round_alike_do_not_ignore_their_uniforms():
    verdict = check_sampler(lambda u: u[:, 0] + 1e15, ones, Interval(1e15, 1e15 + 1), dimensions=1, samples=2000)
    assert verdict.outcome == "inconclusive", str(verdict)
