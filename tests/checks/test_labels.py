"""Samplers that no quadrature resolves, on every domain: right ones are passed, each of their errors is found by the label test."""

import math

import numpy as np
import pytest

from fogproof import (
    Ball,
    Box,
    Discrete,
    Draw,
    HalfLine,
    Interval,
    Product,
    RealLine,
    Rectangle,
    Rotations,
    SphericalTriangle,
    Triangle,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
    check_sampler,
)
from fogproof.checks.mixture import MixtureTest
from fogproof.checks.statistics import labels
from fogproof.checks.statistics.labels import Sums
from fogproof.checks.subject import Subject

N = 200_000
TURN = 2 * np.pi


def about(mu, phi):
    s = np.sqrt(np.maximum(1 - mu * mu, 0))
    return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)


def frame(axis):
    axis = np.asarray(axis) / np.linalg.norm(axis)
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first), axis])


def cone(axis, degrees):
    rows, versine = frame(axis), 2 * np.sin(np.radians(degrees) / 2) ** 2

    def sample(u):
        w = versine * u[:, 0]
        s = np.sqrt(w * (2 - w))
        return np.stack([s * np.cos(TURN * u[:, 1]), s * np.sin(TURN * u[:, 1]), 1 - w], axis=-1) @ rows

    def pdf(x):
        return np.where(((x - rows[2]) ** 2).sum(axis=1) / 2 <= versine * (1 + 1e-9), 1 / (TURN * versine), 0.0)

    return sample, pdf


def area_light(low, size, z):
    low, high = np.array(low), np.array(low) + size

    def sample(u):
        q = np.concatenate([low + u * (high - low), np.full((len(u), 1), z)], axis=1)
        return q / np.linalg.norm(q, axis=1)[:, None]

    def pdf(x):
        t = z / np.where(x[:, 2] > 0, x[:, 2], np.nan)
        q = x[:, :2] * t[:, None]
        on = (x[:, 2] > 0) & np.all((q >= low - 1e-12) & (q <= high + 1e-12), axis=1)
        return np.where(on, t * t / (np.prod(high - low) * x[:, 2]), 0.0)

    return sample, pdf


def environment(height, width, sun):
    rng = np.random.default_rng(7)
    table = rng.random((height, width)) ** 2 + 0.01
    table[height // 5, width // 3 : width // 3 + 3] = sun
    table[height // 2 : height // 2 + 3] = 0
    table /= table.sum()
    cumulated = np.cumsum(table.ravel())

    def sample(u):
        j = np.minimum(np.searchsorted(cumulated, u[:, 0] * cumulated[-1], side="right"), table.size - 1)
        return np.stack([(j // width + u[:, 1]) / height, (j % width + u[:, 2]) / width], axis=-1)

    def pdf(x, of=table):
        row = np.minimum((x[:, 0] * height).astype(int), height - 1)
        return of[row, np.minimum((x[:, 1] * width).astype(int), width - 1)] * table.size

    shifted = np.maximum(np.roll(table, 1, axis=1), 1e-12)
    return sample, pdf, lambda x: pdf(x, shifted)


def octant(u):
    """Isotropic directions, folded."""
    return np.abs(about(2 * u[:, 0] - 1, TURN * u[:, 1]))


def quaternions(u):
    r, s = np.sqrt(u[:, 0]), np.sqrt(1 - u[:, 0])
    a, b = TURN * u[:, 1], TURN * u[:, 2]
    return np.stack([r * np.cos(a), r * np.sin(a), s * np.cos(b), s * np.sin(b)], axis=-1)


def in_ball(u):
    return np.array([1.0, -2.0, 0.5]) + 2 * np.cbrt(u[:, :1]) * about(2 * u[:, 1] - 1, TURN * u[:, 2])


def poisson(mean):
    from scipy.special import gammaincc, gammaln

    cdf = gammaincc(np.arange(1, 400), mean)
    return (
        lambda u: np.searchsorted(cdf, u[:, 0], side="right").astype(float),
        lambda k: np.exp(k * math.log(mean) - mean - gammaln(k + 1)),
    )


def normals(correlation):
    from scipy.special import ndtri

    def sample(u):
        z = ndtri(np.clip(u, 1e-16, 1 - 1e-16))
        z[:, 1] = correlation * z[:, 0] + math.sqrt(1 - correlation**2) * z[:, 1]
        return z

    return sample


def normal_pdf(x):
    return np.exp(-0.5 * (x * x).sum(axis=1)) / TURN ** (x.shape[1] / 2)


def path(u):
    """An exponential distance and a direction of density (1 + mu) / 4 pi."""
    return np.column_stack([-np.log1p(-u[:, 0]), about(2 * np.sqrt(u[:, 1]) - 1, TURN * u[:, 2])])


def path_pdf(x):
    return np.exp(-x[:, 0]) * (1 + x[:, 3]) / (2 * TURN)


MIRROR = (0.6, 0.0, 0.8)


def glossy(u):
    lobe = about(np.sqrt(u[:, 0]), TURN * u[:, 1])
    return np.where(u[:, 2:] < 0.3, np.array(MIRROR), lobe)


SUN, LIGHT, MAP = cone((0.3, -0.5, 0.6), 0.2665), area_light((0.2, -0.4), 0.3, 2.8), environment(64, 128, 1e3)
POISSON = poisson(7.3)
FOLD = Triangle((0, 0), (1, 0), (0, 1))
SPACE = ((0.0, 0.0, 1.0), (2.0, 0.0, 0.0), (0.0, 1.0, 1.0))


def in_space(u):
    u = np.where(u.sum(axis=1, keepdims=True) > 1, 1 - u, u)
    a, b, c = np.array(SPACE)
    return a + u[:, :1] * (b - a) + u[:, 1:] * (c - a)


def constant(value):
    return lambda x: np.full(len(x), value)


RIGHT = {
    "sun": (*SUN, UnitSphere(), 2),
    "area light": (*LIGHT, UnitSphere(), 2),
    "map": (*MAP[:2], UnitSquare(), 3),
    "octant": (octant, constant(2 / np.pi), SphericalTriangle((1, 0, 0), (0, 1, 0), (0, 0, 1)), 2),
    "triangle in the square": (
        lambda u: np.where(u.sum(axis=1, keepdims=True) > 1, 1 - u, u),
        lambda x: 2.0 * (x.sum(axis=1) <= 1 + 1e-15), UnitSquare(), 2),
    "triangle": (lambda u: np.where(u.sum(axis=1, keepdims=True) > 1, 1 - u, u), constant(2.0), FOLD, 2),
    "triangle in space": (in_space, constant(1 / Triangle(*SPACE).measure), Triangle(*SPACE), 2),
    "rectangle": (lambda u: u * [2, 0.5] - 1, constant(1.0), Rectangle((-1, -1), (1, -0.5)), 2),
    "ball": (in_ball, constant(1 / Ball(2.0).measure), Ball(2.0, (1.0, -2.0, 0.5)), 3),
    "rotations": (quaternions, constant(1.0), Rotations(), 3),
    "box of five": (lambda u: u, constant(1.0), Box((0,) * 5, (1,) * 5), 5),
    "normals": (normals(0.0), normal_pdf, Product(*[RealLine()] * 5), 5),
    "distance and direction": (path, path_pdf, Product(HalfLine(0), UnitSphere()), 3),
    "lobe and position": (
        lambda u: np.column_stack([u[:, 0] < 0.3, np.where(u[:, 0] < 0.3, np.sqrt(u[:, 1]), u[:, 1])]),
        lambda x: np.where(x[:, 0] == 1, 0.3 * 2 * x[:, 1], 0.7), Product(Discrete(2), Interval(0, 1)), 2),
    "Poisson": (*POISSON, Discrete(math.inf), 1),
}  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_right_samplers_pass_and_a_smaller_pdf_does_not(name):
    sample, pdf, domain, dimensions = RIGHT[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=N, alpha=1e-9)
    assert verdict.outcome == "not rejected", str(verdict)
    factor, samples = (0.98, 2 * N) if name in ("sun", "map") else (0.97, N)
    verdict = check_sampler(sample, lambda x: factor * pdf(x), domain, dimensions=dimensions, samples=samples)
    assert verdict.outcome == "rejected", str(verdict)
    assert verdict.cause == "normalisation", str(verdict)


WRONG = {
    "a cone 3 % too small": ("sun", {"sample": cone((0.3, -0.5, 0.6), 0.2665 * 0.985)[0]}),
    "a map shifted by a texel": ("map", {"pdf": MAP[2]}),
    "barycentric numbers over their sum": (
        "triangle", {"sample": lambda u: u[:, :2] / u.sum(axis=1, keepdims=True), "dimensions": 3}),
    "uniform in radius": ("ball", {"sample": lambda u: in_ball(u**[1.1, 1, 1])}),
    "Euler angles": (
        "rotations", {"sample": lambda u: quaternions(u ** [0.9, 1, 1])}),
    "a correlation of .1": ("normals", {"sample": normals(0.1)}),
    "a direction that knows the distance": (
        "distance and direction", {"sample": lambda u: path(np.stack([u[:, 0], u[:, 1], (u[:, 2] + 0.1 * u[:, 0]) % 1], 1) *
                                                            [1, 1, 0.9] + [0, 0, 0.05])}),
    "a wrong mean": ("Poisson", {"sample": poisson(7.4)[0]}),
    "lobes swapped": ("lobe and position", {"pdf": lambda x: np.where(x[:, 0] == 0, 0.3 * 2 * x[:, 1], 0.7)}),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_errors_of_shape_are_found(name):
    base, changes = WRONG[name]
    sample, pdf, domain, dimensions = RIGHT[base]
    arguments = {"sample": sample, "pdf": pdf, "dimensions": dimensions, **changes}
    verdict = check_sampler(arguments.pop("sample"), arguments.pop("pdf"), domain, samples=N, **arguments)
    assert verdict.outcome == "rejected", str(verdict)
    assert any(f.check.startswith("labels") for f in verdict.findings if f.outcome == "rejected"), str(verdict)


def test_an_unseen_peak_of_half_the_mass_is_found():
    """The samples are isotropic, and so is the pdf wherever they are; the rest of its mass lies in a disk of the sun's size."""

    def isotropic(u):
        return about(2 * u[:, 0] - 1, TURN * u[:, 1])

    peak = cone((0.3, 0.5, -0.7), 0.2665)[1]
    right = check_sampler(isotropic, constant(0.5 / TURN), UnitSphere(), dimensions=2, samples=N)
    known = next(f for f in right.findings if f.check == "normalisation")
    assert "outside features" in str(known.resolution), "what fills less than that may never have been looked at"
    verdict = check_sampler(isotropic, lambda x: 0.5 / TURN + 0.5 * peak(x), UnitSphere(), dimensions=2, samples=N)
    assert verdict.outcome == "rejected", str(verdict)
    whole = next(f for f in verdict.findings if f.check == "labels")
    integral, error = map(float, whole.message.split("integrates to ")[1].split(" +- "))
    assert integral > 1.2, "most of what nobody sampled is found"
    assert abs(integral - 1.5) < max(7 * error, 0.1), str(verdict)


def test_a_mirror_in_a_mixture_is_an_atom_on_the_sphere():
    options = {"dimensions": 3, "samples": N}
    pdf = lambda x: 0.7 * np.maximum(x[:, 2], 1e-30) / np.pi  # noqa: E731
    right = check_sampler(glossy, pdf, UnitHemisphere(), atoms={MIRROR: 0.3}, **options)
    assert right.outcome == "not rejected", str(right)
    wrong = check_sampler(glossy, pdf, UnitHemisphere(), atoms={MIRROR: 0.31}, **options)
    assert wrong.outcome == "rejected", str(wrong)
    forgotten = check_sampler(glossy, lambda x: pdf(x) / 0.7, UnitHemisphere(), **options)
    assert forgotten.outcome == "rejected", str(forgotten)


WI = np.array([0.8, 0, 0.6])


def microfacet(u, wi=WI, alpha=0.5):
    """Beckmann's distribution sampled in full: what is reflected below the horizon is given up (Walter et al. 2007)."""
    cosine = 1 / np.sqrt(1 - alpha * alpha * np.log1p(-u[:, 0]))
    h = about(cosine, TURN * u[:, 1])
    wo = 2 * (h @ wi)[:, None] * h - wi
    return Draw(wo, valid=(wo[:, 2] > 0) & (h @ wi > 0))


def microfacet_pdf(x, wi=WI, alpha=0.5):
    h = x + wi
    h /= np.linalg.norm(h, axis=1)[:, None]
    c = np.maximum(h[:, 2], 1e-9)
    d = np.exp(-(1 - c * c) / (c * alpha) ** 2) / (np.pi * alpha**2 * c**4)
    return d * h[:, 2] / (4 * (h @ wi))


SUCCESS = 0.794847907  # integral of microfacet_pdf over the hemisphere


def test_samples_that_are_given_up_count_one_way_or_the_other():
    options = {"dimensions": 2, "samples": N}
    every = check_sampler(microfacet, microfacet_pdf, UnitHemisphere(), **options)
    assert every.outcome == "not rejected", str(every)
    assert "the pdf counts every sample" in every.findings[0].message
    valid = check_sampler(microfacet, lambda x: microfacet_pdf(x) / SUCCESS, UnitHemisphere(), **options)
    assert valid.outcome == "not rejected", str(valid)
    assert "the pdf is that of the valid ones" in valid.findings[0].message
    for factor in (0.98, 1.02, 0.98 / SUCCESS):
        wrong = check_sampler(microfacet, lambda x, f=factor: f * microfacet_pdf(x), UnitHemisphere(), **options)
        assert wrong.outcome == "rejected", str(wrong)


def test_labels_know_both_conventions_too():
    """A cone of which a tenth is given up: no quadrature resolves it."""
    sample, pdf = SUN

    def tried(u):
        return Draw(sample(u[:, :2]), valid=u[:, 2] < 0.9)

    for factor, outcome in ((1.0, "not rejected"), (0.9, "not rejected"), (0.95, "rejected")):
        verdict = check_sampler(
            tried, lambda x, f=factor: f * pdf(x), UnitSphere(), dimensions=3, samples=2 * N, alpha=1e-9
        )
        assert verdict.outcome == outcome, f"factor {factor}: {verdict}"


def test_a_pdf_that_ripples_where_its_sampler_does_not():
    """Waves of 30 % on a tilted lobe, finer than any cell: their height is told by how often the pdf is high."""
    rows = frame((0.3, -0.5, 0.6))

    def sample(u):
        return about(2 * np.sqrt(u[:, 0]) - 1, TURN * u[:, 1]) @ rows

    def lobe(x):
        return (1 + x @ rows[2]) / (2 * TURN)

    def rippled(x):
        return lobe(x) * (1 + 0.3 * np.sin(400 * x[:, 0]) * np.sin(300 * x[:, 1]))

    options = {"dimensions": 2, "samples": 60_000}
    assert check_sampler(sample, lobe, UnitSphere(), **options).outcome == "not rejected"
    verdict = check_sampler(sample, rippled, UnitSphere(), **options)
    assert "labels by level of the pdf" in [f.check for f in verdict.findings if f.outcome == "rejected"], str(verdict)


def weighted_table(n):
    weight = np.random.default_rng(3).random(n) + 0.5
    weight /= weight.sum()
    cumulated = np.cumsum(weight)
    return weight, lambda u: np.minimum(np.searchsorted(cumulated, u[:, 0] * cumulated[-1], side="right"), n - 1)


@pytest.mark.parametrize("n", [10_000, 100_000])
def test_weights_of_a_table_that_belong_to_its_neighbours(n):
    """Neyman and Pearson would need about 300 samples; four times as many are enough whatever the table's size."""
    weight, sample = weighted_table(n)
    options = {"dimensions": 1, "samples": 1200}
    right = check_sampler(sample, lambda i: weight[i.astype(int)], Discrete(n), alpha=1e-9, **options)
    assert right.outcome != "rejected", str(right)
    wrong = check_sampler(sample, lambda i: np.roll(weight, 1)[i.astype(int)], Discrete(n), **options)
    assert wrong.outcome == "rejected", str(wrong)


HEAVY = {
    "Pareto .1": (lambda u: (1 - u[:, 0]) ** -10.0, lambda x: 0.1 * x**-1.1, HalfLine(1)),
    "Pareto .2": (lambda u: (1 - u[:, 0]) ** -5.0, lambda x: 0.2 * x**-1.2, HalfLine(1)),
    "Cauchy": (
        lambda u: np.tan(np.pi * (u[:, 0] - 0.5)), lambda x: 1 / (np.pi * (1 + x * x)), RealLine()),
    "a pole inside": (
        lambda u: 0.3 + np.where(u[:, 1] < 0.5, 0.7, -0.3) * u[:, 0] ** 10,
        lambda x: 0.05 * np.maximum(np.where(x > 0.3, (x - 0.3) / 0.7, (0.3 - x) / 0.3), 1e-300) ** -0.9
        / np.where(x > 0.3, 0.7, 0.3), Interval(0, 1)),
    "a pole at the far end": (
        lambda u: 1 - u[:, 0] ** 10, lambda x: 0.1 * np.maximum(1 - x, 1e-300) ** -0.9, Interval(0, 1)),
}  # fmt: skip


@pytest.mark.parametrize("name", HEAVY)
def test_heavy_tails_and_poles_are_at_worst_inconclusive(name):
    sample, pdf, domain = HEAVY[name]
    verdict = check_sampler(sample, pdf, domain, dimensions=2, samples=N, alpha=1e-9)
    assert verdict.outcome != "rejected", str(verdict)
    wrong = check_sampler(lambda u: sample(u**1.1), pdf, domain, dimensions=2, samples=N)
    assert wrong.outcome == "rejected", str(wrong)


def _mixed(factor, batches, size):
    """Return the mixture of the sun's cone and, for each batch of `size` samples, its sums when the pdf is off by a factor."""
    sample, pdf = SUN
    subject = Subject(sample, lambda x: factor * pdf(x), UnitSphere(), 2)
    rng = np.random.default_rng()
    points = sample(rng.random((1 << 14, 2)))
    mixture = MixtureTest.of(subject, UnitSphere().law(points), points, int(rng.integers(1 << 60)), 1 << 60)
    found = []
    for index in range(batches):
        x = sample(rng.random((size, 2)))
        good = np.ones(size, dtype=bool)
        found.append(mixture.count(Draw(x), good, subject.density(x), index)[0])
    return mixture, found


def test_p_values_of_labels_are_uniform():
    mixture, found = _mixed(1.0, 300, 4096)
    depth = mixture.tree.depth
    for test in (
        lambda sums: labels.whole("", (sums,), 1e-6),
        lambda sums: labels.levels("", (sums,), 1e-6),
        lambda sums: labels.smooth("", (sums,), 1e-6),
        lambda sums: labels.cells_at("", depth - 3, (sums,), 1e-6),
        lambda sums: labels.cells_at("", 2, (sums,), 1e-6),
    ):
        p = np.sort([test(sums).p_value for sums in found])
        distance = np.max(np.abs(p - (np.arange(len(p)) + 0.5) / len(p)))
        assert distance < math.sqrt(math.log(2 / 1e-9) / (2 * len(p))), p[:5]
    p = np.array([labels.largest("", mixture.describe, (sums,), 1e-6).p_value for sums in found])
    assert np.mean(p < 0.05) < 0.05 + 6 * math.sqrt(0.05 / len(p)), "an upper bound"


def test_the_stated_resolution_of_labels_is_true():
    """An error of exactly the size stated is caught 99 times of 100, and one of half the size is not."""
    alpha = 1e-6
    stated = labels.whole("", (_mixed(1.0, 1, 1 << 15)[1][0],), alpha).resolution.value
    for factor, least, most in ((1 - stated, 0.9, 1.0), (1 + stated, 0.9, 1.0), (1 - stated / 2, 0.0, 0.5)):
        _, found = _mixed(factor, 60, 1 << 15)
        caught = np.mean([labels.whole("", (sums,), alpha).outcome == "rejected" for sums in found])
        assert least <= caught <= most, f"factor {factor}: {caught}"


def test_few_coins_say_nothing():
    none = np.empty(0)
    weighed = np.zeros(5), np.zeros((2, 6, 6)), np.zeros((4, 3, 256))
    nothing = Sums.of(none, none, none.astype(int), 8, np.zeros(5), weighed)
    unweighed = labels.smooth("", (nothing,), 1e-6)
    assert (unweighed.outcome, unweighed.resolution) == ("not rejected", None), "that is for the sum of all to say"
    assert labels.whole("", (nothing,), 1e-6).outcome == "inconclusive"
    assert labels.cells_at("", 2, (nothing,), 1e-6).outcome == "inconclusive"
    assert labels.largest("", lambda d, i: "", (nothing,), 1e-6).outcome == "not rejected"


def test_tails_of_sums_of_residuals_are_never_too_small():
    """Against the exact law of sums of coins with one bias."""
    from scipy.stats import binom

    for n, w in ((40, 0.5), (400, 0.02), (3000, 0.5), (3000, 0.03)):
        hits = np.arange(n + 1)
        p = labels.tail(hits - n * w, np.full(n + 1, n * w * (1 - w)), np.full(n + 1, n * w * (1 - w) * (1 - 2 * w)))
        exact = np.where(hits > n * w, binom.sf(hits - 1, n, w), binom.cdf(hits, n, w))
        assert np.all(p[exact > 1e-12] >= 0.6 * exact[exact > 1e-12]), (n, w)
