"""The pdf against the sampler's own map: right ones of every sort are left alone, and what samples do not show is seen."""

import re

import numpy as np
import pytest

from fogproof import (
    Box,
    Discrete,
    Draw,
    HalfLine,
    Interval,
    SphericalTriangle,
    Triangle,
    UnitDisk,
    UnitSphere,
    UnitSquare,
    check_sampler,
)
from fogproof.catalogue import SamplerCase
from fogproof.checks.map_density import NAME, map_density
from fogproof.checks.subject import Subject
from fogproof.verify import select

LINE = Interval(0.0, 1.0)


def subject(sample, pdf, domain=LINE, dimensions=1, **more):
    return Subject(sample, pdf, domain, dimensions, **more)


def found(sample, pdf, domain=LINE, dimensions=1, seed=1, **more):
    """Return the one finding, None where the question is not put."""
    pilot = domain.law(np.empty((0, *domain.shape))).place(
        np.random.default_rng(seed).random((500, 4))[:, : dimensions or 1]
    )
    return next(iter(map_density(subject(sample, pdf, domain, dimensions, **more), pilot, seed)), None)


def ones(x):
    return np.ones(len(x))


def quarter(x):
    return np.full(len(x), 0.25 / np.pi)


def sphere(u):
    sine, phi = 2 * np.sqrt(u[:, 0] * (1 - u[:, 0])), 2 * np.pi * u[:, 1]
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), 1 - 2 * u[:, 0]], axis=-1)


def disk(u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)


def folded(u):
    """The corner beyond the diagonal is turned onto the triangle: two uniforms lead to each point."""
    return np.where((u.sum(axis=1) > 1)[:, None], 1 - u, u)


def one_of_two(u):
    """Two exponential laws, chosen by the uniform that is stretched and used again."""
    first = u[:, 0] < 0.3
    v = np.where(first, u[:, 0] / 0.3, (u[:, 0] - 0.3) / 0.7)
    return -np.log1p(-v) / np.where(first, 5.0, 0.5)


def pdf_of_two(x):
    return 0.3 * 5 * np.exp(-5 * x) + 0.7 * 0.5 * np.exp(-0.5 * x)


def table_of_the_inverse(u):
    """Straight lines between 200 places of the inverse cdf of 2 x: in each cell the samples are even, as the pdf is not."""
    xi = np.linspace(0, 1, 201)
    return np.interp(u[:, 0], xi, np.sqrt(xi))


_SPECKLED = np.random.default_rng(5).random(1 << 20) + 0.5
_SPECKLED /= _SPECKLED.mean()
_SUMS = np.concatenate([[0.0], np.cumsum(_SPECKLED)]) / len(_SPECKLED)


def speckled(u):
    """A table of a million entries, whose cells no step of a derivative can tell from each other."""
    return np.interp(u[:, 0], _SUMS, np.linspace(0, 1, len(_SUMS)))


def pdf_of_the_speckled(x):
    return _SPECKLED[np.clip((x * len(_SPECKLED)).astype(int), 0, len(_SPECKLED) - 1)]


def stopped(u):
    return np.minimum(-np.log1p(-u[:, 0]), 1.0)


RIGHT = {
    "sphere": (sphere, quarter, UnitSphere(), 2, {}),
    "disk": (disk, lambda x: np.full(len(x), 1 / np.pi), UnitDisk(), 2, {}),
    "triangle": (folded, lambda x: np.full(len(x), 2.0), Triangle((0, 0), (1, 0), (0, 1)), 2, {}),
    "two laws": (one_of_two, pdf_of_two, HalfLine(0.0), 1, {}),
    "table of the inverse": (table_of_the_inverse, lambda x: 2 * x, LINE, 1, {}),
    "an atom": (stopped, lambda t: np.exp(-t), HalfLine(0.0), 1, {"atoms": {1.0: float(np.exp(-1))}}),
    "given up": (lambda u: Draw(u[:, 0], valid=u[:, 0] < 0.7), lambda x: np.where(x < 0.7, 1.0, 0.0), LINE, 1, {}),
    "given up, renormalised": (
        lambda u: Draw(u[:, 0], valid=u[:, 0] < 0.7), lambda x: np.where(x < 0.7, 1 / 0.7, 0.0), LINE, 1, {}),
    "32 bits": (lambda u: np.floor(u[:, 0] * 2**32) / 2**32, ones, LINE, 1, {"uniform_bits": 32}),
    "a uniform that is not used": (lambda u: u[:, 1], ones, LINE, 2, {}),
    "a uniform that matters once in ten million times": (
        lambda u: u[:, 1] * np.where(u[:, 0] < 1e-7, 0.5, 1.0),
        lambda x: (1 - 1e-7) + np.where(x < 0.5, 2e-7, 0.0), LINE, 2, {}),
    "four axes": (lambda u: np.sqrt(u), lambda x: np.prod(2 * x, axis=1), Box((0.0,) * 4, (1.0,) * 4), 4, {}),
    "single precision": (
        sphere, quarter, UnitSphere(), 2, {"precision": "float32"}),
    "singular": (lambda u: u[:, 0] ** 10, lambda x: 0.1 * x**-0.9, LINE, 1, {}),
}  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_right_ones_keep_the_inequality(name):
    sample, pdf, domain, dimensions, more = RIGHT[name]
    for seed in range(5):
        finding = found(sample, pdf, domain, dimensions, seed, **more)
        assert finding is not None
        assert finding.outcome == "not rejected", finding.message
        assert "is 1 to within" in finding.message or name in {
            "triangle",
            "two laws",
            "given up, renormalised",
            "table of the inverse",
        }


def rare_bright(n, share, every):
    """The inverse cdf of n cells, each `every`-th of which holds a share of all probability together, and its pdf."""
    heights = np.full(n, (1 - share) * every / (every - 1))
    heights[::every] = share * every
    heights /= heights.mean()
    sums = np.concatenate([[0.0], np.cumsum(heights)]) / n

    def sample(u):
        return np.interp(u[:, 0], sums, np.arange(n + 1) / n)

    return sample, lambda x: heights[np.clip((x * n).astype(int), 0, n - 1)]


def alias(n, share, every):
    """The same by an alias table: each cell keeps its own samples or gives them away, and the rest of the uniform is used again."""
    heights = np.full(n, (1 - share) * every / (every - 1))
    heights[::every] = share * every
    keep, other = np.minimum(heights, 1.0), np.arange(n) // every * every

    def sample(u):
        cell = np.minimum((u[:, 0] * n).astype(int), n - 1)
        rest = u[:, 0] * n - cell
        own = rest < keep[cell]
        again = np.where(own, rest / keep[cell], (rest - keep[cell]) / np.maximum(1 - keep[cell], 1e-300))
        return (np.where(own, cell, other[cell]) + np.clip(again, 0, 1 - 1e-9)) / n

    given = heights.copy()
    given[::every] = keep[::every] + (1 - keep).reshape(-1, every)[:, 1:].sum(axis=1)
    return sample, lambda x: given[np.clip((x * n).astype(int), 0, n - 1)]


def strips(n):
    """One uniform picks a strip of the square and, with what is left of it, the place along; the other the place across."""

    def sample(u):
        strip, along = np.divmod(u[:, 0] * n, 1)
        return np.stack([(strip + u[:, 1]) / n, along], axis=-1)

    return sample


def far_digits(u):
    """A uniform that the last digits of another one make."""
    return (u * 1e6) % 1


FINE = {
    "a table of a million": (speckled, pdf_of_the_speckled, LINE, 1),
    "rare bright cells": (*rare_bright(100_000, 0.01, 1000), LINE, 1),
    "spikes": (*rare_bright(10_000_000, 0.001, 100), LINE, 1),
    "slightly brighter cells": (*rare_bright(1_000_000, 0.0101, 100), LINE, 1),
    "alias": (*alias(100_000, 0.01, 1000), LINE, 1),
    "ten thousand strips": (strips(10_000), ones, UnitSquare(), 2),
    "millions of strips": (strips(1 << 24), ones, UnitSquare(), 2),
    "given up by far digits": (
        lambda u: Draw(np.sqrt(u[:, 0]), valid=far_digits(u[:, 0]) < 0.7), lambda x: 1.4 * x, LINE, 1),
    "always in single precision": (
        lambda u: sphere(u.astype(np.float32)).astype(np.float32), quarter, UnitSphere(), 2),
    "a choice that matters once in a thousand": (
        lambda u: np.where(u[:, 0] < 1e-3, u[:, 1], np.sqrt(u[:, 1])), lambda x: 1e-3 + 0.999 * 2 * x, LINE, 2),
}  # fmt: skip
"""Right ones whose structure is finer than steps that look smooth; with "alias" and "given up" others lead there too."""


@pytest.mark.parametrize("name", FINE)
def test_what_is_rough_far_below_a_step_is_not_judged_by_its_average(name):
    sample, pdf, domain, dimensions = FINE[name]
    precision = "float32" if "single" in name else "float64"
    for seed in range(5):
        finding = found(sample, pdf, domain, dimensions, seed, precision=precision)
        assert finding is None or finding.outcome == "not rejected", finding.message


WRONG = {
    "a thousandth of the turn is never drawn": (lambda u: sphere(u * [1, 0.999]), quarter, UnitSphere(), 2, {}),
    "a constant": (lambda u: u[:, 0], lambda x: np.full(len(x), 0.9999), LINE, 1, {}),
    "along the last of four axes": (
        lambda u: np.concatenate([u[:, :3], u[:, 3:] ** 1.05], axis=1), ones, Box((0.0,) * 4, (1.0,) * 4), 4, {}),
    "with a uniform that is not used": (lambda u: 0.999 * u[:, 1], ones, LINE, 2, {}),
    "another rate": (lambda u: -np.log1p(-u[:, 0]) / 1.001, lambda t: np.exp(-t), HalfLine(0.0), 1, {}),
    "no square root": (lambda u: disk(u**1.01), lambda x: np.full(len(x), 1 / np.pi), UnitDisk(), 2, {}),
    "in a twelfth": (lambda u: np.where(u[:, 0] < 1 / 12, 12 * u[:, 0] ** 2, u[:, 0]), ones, LINE, 1, {}),
    "single precision": (
        lambda u: sphere(u * u.dtype.type([1, 0.998])), quarter, UnitSphere(), 2, {"precision": "float32"}),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_wrong_ones_break_it(name):
    sample, pdf, domain, dimensions, more = WRONG[name]
    for seed in range(5):
        assert found(sample, pdf, domain, dimensions, seed, **more).outcome == "rejected"


@pytest.mark.parametrize(
    ("sample", "domain", "dimensions"),
    [
        (lambda rng, n: rng.random(n), LINE, None),
        (lambda u: np.where(u[:, 0] < 0.3, u[:, 1], u[:, 1] ** 2), LINE, 2),
        (lambda u: u[:, [0, 0]], UnitSquare(), 1),
        (lambda u: np.floor(10 * u[:, 0]).astype(int), Discrete(10), 1),
        (lambda u: np.floor(u[:, 0] * 64) / 64, LINE, 1),
        (lambda u: (np.sin(1e9 * u[:, 0]) * 1e4) % 1, LINE, 1),
        (lambda u: np.where(u[:, 0] < 2e-4, u[:, 1], u[:, 1] ** 2), LINE, 2),
    ],
    ids=["generator", "choice", "curve", "table", "stairs", "hash", "rare choice"],
)
def test_nothing_is_said_without_a_derivative(sample, domain, dimensions):
    assert found(sample, ones, domain, dimensions) is None


def test_the_tolerance_is_what_it_is_said_to_be():
    """Of a constant factor, which is no matter of chance: twice the tolerance is found, half of it is not."""
    for factor, outcome in ((1 - 4e-5, "rejected"), (1 - 1e-5, "not rejected")):
        assert found(lambda u: u[:, 0], lambda x, f=factor: np.full(len(x), f)).outcome == outcome


def test_without_an_integral_nothing_is_called_skipped():
    """A pdf that is too small throughout and samples that miss a part look the same where nobody knows the integral."""
    verdict = check_sampler(
        lambda u: np.sqrt(u),
        lambda x: 0.999 * np.prod(2 * x, axis=1),
        Box((0.0,) * 6, (1.0,) * 6),
        dimensions=6,
        samples=5000,
    )
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} == {NAME}
    assert verdict.cause == "normalisation"


def test_what_samples_do_not_show_is_rejected_all_the_same():
    verdict = check_sampler(
        lambda u: sphere(u * [1, 0.999]), quarter, UnitSphere(), dimensions=2, samples=20_000, axis=(0.6, 0, 0.8)
    )
    assert [f.check for f in verdict.findings if f.outcome == "rejected"] == [NAME]
    assert "1.001001 times as dense" in str(verdict)
    assert "no uniforms lead to" in str(verdict)


def test_samples_are_drawn_until_they_show_the_cause():
    """The map shows a rate of 1.06 at once; which rate it is takes samples, and they are not spared."""
    verdict = check_sampler(
        lambda u: -np.log1p(-u[:, 0]) / 1.06, lambda t: np.exp(-t), HalfLine(0.0), dimensions=1, samples=100_000
    )
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} > {NAME}
    assert verdict.cause == "wrong scale"


def test_an_early_look_does_not_end_what_the_map_alone_rejects():
    verdict = check_sampler(
        lambda u: -np.log1p(-u[:, 0]) / 1.0003, lambda t: np.exp(-t), HalfLine(0.0), dimensions=1, samples=600_000
    )
    assert {f.check for f in verdict.findings if f.outcome == "rejected"} == {NAME}
    assert verdict.samples == 600_000 > verdict.settings["looks"][0]


def test_no_right_sampler_of_the_catalogue_is_rejected():
    """All with a map of their own, by one look each."""
    asked = 0
    for case in select(["cosines", "directions/henyey-greenstein", "free-path", "equiangular"]):
        if not isinstance(case, SamplerCase):
            continue
        s = case.make()
        if s.dimensions is None:
            continue
        precision = case.options.get("precision", "float64")
        made = subject(
            s.sample, s.pdf, s.domain, s.dimensions, atoms=dict(getattr(s, "atoms", {})), precision=precision
        )
        points = made.draw(np.random.default_rng(2), 2000).x
        for finding in map_density(made, points, 2):
            assert finding.outcome == "not rejected", f"{case.name}: {finding.message}"
            asked += 1
    assert asked > 30


def triangle_from_far(s):
    """Return Arvo's (1995) sampler of the spherical triangle (1, 0, 0), (1, s, 0), (1, 0, 2 s), its solid angle and its domain.

    It loses digits on a small one: differences over tiny steps are noise.
    """
    a, b, c = (v / np.linalg.norm(v) for v in np.array([[1, 0, 0], [1, s, 0], [1, 0, 2 * s]]))
    alpha, area = np.pi / 2, SphericalTriangle(tuple(a), tuple(b), tuple(c)).measure
    towards = (c - (c @ a) * a) / np.linalg.norm(c - (c @ a) * a)

    def sample(u):
        sine, cosine = np.sin(u[:, 0] * area - alpha), np.cos(u[:, 0] * area - alpha)
        p, q = cosine - np.cos(alpha), sine + np.sin(alpha) * (a @ b)
        x = ((q * cosine - p * sine) * np.cos(alpha) - q) / ((q * sine + p * cosine) * np.sin(alpha))
        x = np.clip(x, -1, 1)
        third = x[:, None] * a + np.sqrt(1 - x * x)[:, None] * towards
        z = 1 - u[:, 1] * (1 - third @ b)
        across = third - (third @ b)[:, None] * b
        across /= np.linalg.norm(across, axis=1)[:, None]
        return z[:, None] * b + np.sqrt(1 - z * z)[:, None] * across

    return sample, area, SphericalTriangle(tuple(a), tuple(b), tuple(c))


@pytest.mark.parametrize("factor", [1.02, 1.2])
def test_what_noise_hides_is_not_called_right(factor):
    sample, area, domain = triangle_from_far(0.01)
    finding = found(sample, lambda x: np.full(len(x), 1 / (factor * area)), domain, 2)
    assert finding.outcome == "not rejected"
    average, room = map(float, re.findall(r"is ([\d.]+) on average.*more than ([\d.]+) is lacking", finding.message)[0])
    assert average == pytest.approx(1 / factor, abs=1e-4)
    assert 1 - average < room < 0.5


def test_from_nearer_the_same_is_seen():
    sample, area, domain = triangle_from_far(0.3)
    assert found(sample, lambda x: np.full(len(x), 1 / (1.02 * area)), domain, 2).outcome == "rejected"
