"""Right samplers of unusual laws are never rejected: zeros inside, coarse uniforms, tiny and far regions, certain atoms."""

import numpy as np
import pytest
from scipy.stats import gamma

from fogproof import (
    Discrete,
    HalfLine,
    Interval,
    Product,
    SpherePart,
    Triangle,
    UnitSphere,
    UnitSquare,
    check_sampler,
)
from fogproof.checks.edges import edge_uniforms
from fogproof.checks.subject import Subject
from fogproof.errors import InvalidValueError

N = 60_000


def ones(x):
    return np.ones(len(x))


def passes(*arguments, **options):
    options = {"dimensions": 1, "samples": N} | options
    verdict = check_sampler(*arguments, **options)
    assert verdict.outcome == "not rejected", str(verdict)
    return verdict


def from_zero_outwards(u):
    return np.sign(u[:, 0] - 0.5) * np.sqrt(np.abs(2 * u[:, 0] - 1))


def light_and_place(u):
    """One of three lights, and a place on it by what is left of the same uniform."""
    share = np.array([0.5, 0.3, 0.2])
    begin = np.array([0.0, 0.5, 0.8])
    light = (u[:, 0] >= 0.5).astype(int) + (u[:, 0] >= 0.8)
    left = np.clip((u[:, 0] - begin[light]) / share[light], 0, 1)
    return np.column_stack([light, np.sqrt(left), u[:, 1]])


def test_a_zero_of_the_pdf_inside_is_an_edge_of_its_support():
    passes(from_zero_outwards, np.abs, Interval(-1, 1))
    law = Product(Discrete(3), UnitSquare())
    passes(light_and_place, lambda x: np.array([0.5, 0.3, 0.2])[x[:, 0].astype(int)] * 2 * x[:, 1], law, dimensions=2)


def test_a_hole_that_half_a_uniform_falls_into_is_still_found():
    def into_the_hole(u):
        return np.where(u[:, 0] == 0.5, 0.0, np.where(u[:, 0] < 0.5, -1, 1) * (0.5 + 0.5 * np.abs(2 * u[:, 0] - 1)))

    verdict = check_sampler(into_the_hole, lambda x: 1.0 * (np.abs(x) >= 0.5), Interval(-1, 1), dimensions=1, samples=N)
    assert verdict.cause == "edge of the uniforms", str(verdict)


@pytest.mark.parametrize("bits", [12, 15])
def test_declared_coarse_uniforms_may_leave_gaps(bits):
    def sample(rng, n):
        return -np.log1p(-rng.integers(0, 2**bits, n) / 2**bits)

    samples = 200_000 if bits == 12 else 1_000_000
    passes(sample, lambda x: np.exp(-x), HalfLine(0), dimensions=None, samples=samples, uniform_bits=bits)


def test_coarse_uniforms_hide_no_more_than_their_step():
    def sample(rng, n):
        return -np.log1p(-rng.integers(0, 2**12, n) / 2**12) / 1.6

    verdict = check_sampler(sample, lambda x: np.exp(-x), HalfLine(0), dimensions=None, samples=N, uniform_bits=12)
    assert verdict.outcome == "rejected"


@pytest.mark.parametrize("width", [1e-9, 1e-11])
def test_a_tiny_cap_has_as_many_directions_as_floating_point_gives_it(width):
    def sample(u):
        z = 1 - width * u[:, 0]
        s, phi = np.sqrt((1 - z) * (1 + z)), 2 * np.pi * u[:, 1]
        return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)

    cap = SpherePart(lambda w: w[:, 2] >= 1 - width * (1 + 1e-3))
    passes(sample, lambda w: 1.0 * (w[:, 2] >= 1 - width) / (2 * np.pi * width), cap, dimensions=2)


def test_a_small_light_far_away_in_single_precision():
    a, b, c = (np.array(p, dtype=np.float64) for p in ((1e4, 2e4, 0), (1e4 + 1, 2e4, 0), (1e4, 2e4 + 1, 1)))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a))

    def sample(u):
        s, v = np.sqrt(u[:, :1]), u[:, 1:]
        f = np.float32
        return (a.astype(f) + (1 - s) * (b - a).astype(f) + s * v * (c - a).astype(f)).astype(f)

    light = Triangle(tuple(a), tuple(b), tuple(c))
    verdict = check_sampler(
        sample, lambda x: np.full(len(x), 1 / area), light, dimensions=2, samples=N, precision="float32"
    )
    assert verdict.outcome != "rejected", str(verdict)


def test_a_pole_at_an_end_whose_mass_lies_within_rounding_is_not_known():
    from scipy.special import beta

    def pdf(x):
        return (np.maximum(x, 1e-300) * np.maximum(1 - x, 1e-17)) ** -0.9 / beta(0.1, 0.1)

    verdict = check_sampler(lambda rng, n: rng.beta(0.1, 0.1, n), pdf, Interval(0, 1), dimensions=None, samples=N)
    assert verdict.outcome != "rejected", str(verdict)
    law = next(f for f in verdict.findings if f.check == "normalisation")
    assert "diverges at x = 1" in law.message


def test_a_support_larger_than_the_domain_changes_nothing():
    verdict = passes(lambda u: u[:, 0], ones, Interval(0, 1), support=Interval(-1, 2))
    assert any("support" in word for word in verdict.unchecked)


def test_points_of_a_sequence_need_no_generator():
    def sequence(rng, n):
        return np.arange(1, n + 1) * 0.5 * (np.sqrt(5) - 1) % 1

    passes(sequence, ones, Interval(0, 1), dimensions=None, quasi_random=True)


def test_an_atom_may_have_all_probability():
    verdict = check_sampler(
        lambda rng, n: np.full(n, 1.5), lambda x: np.zeros(len(x)), Interval(0, 2), dimensions=None, atoms={1.5: 1.0}
    )
    assert verdict.outcome == "not rejected", str(verdict)


def test_an_interval_whose_length_is_no_number_is_refused():
    with pytest.raises(InvalidValueError, match="RealLine"):
        Interval(-1e308, 1e308)
    passes(lambda u: 8e307 * (2 * u[:, 0] - 1), lambda x: np.full(len(x), 1 / 1.6e308), Interval(-8e307, 8e307))


def test_few_of_very_many_numbers_are_decided():
    from scipy.stats import binom

    passes(lambda rng, n: rng.binomial(10**5, 0.5, n), binom(10**5, 0.5).pmf, Discrete(10**5 + 1), dimensions=None)


def square_window(beyond):
    """Return a sampler of a square, seen from distance 1, that starts `beyond` its border, its pdf, and what is seen exactly."""

    def sample(u):
        to = np.column_stack([u * (1 + beyond) - beyond, np.ones(len(u))])
        return to / np.linalg.norm(to, axis=1)[:, None]

    def inside(w):
        x, y = w[:, 0] / w[:, 2], w[:, 1] / w[:, 2]
        return (w[:, 2] > 0) & (x >= 0) & (x <= 1) & (y >= 0) & (y <= 1)

    return sample, lambda w: np.where(inside(w), 1 / np.abs(w[:, 2]) ** 3, 0.0), SpherePart(inside)


@pytest.mark.parametrize(("beyond", "outcome"), [(2.0**-53, "not rejected"), (1e-8, "rejected")])
def test_a_border_that_a_user_draws_exactly_forgives_rounding_alone(beyond, outcome):
    sample, pdf, part = square_window(beyond)
    corner = sample(np.zeros((1, 2)))
    assert not part.inside(corner).any()
    assert part.contains(corner, 2e-15).all() == (outcome == "not rejected")
    for domain in (part, UnitSphere()):
        found = edge_uniforms(Subject(sample, pdf, domain, 2), {})
        assert found.outcome == outcome, found.message


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_an_end_before_which_the_density_underflows_is_the_edge_of_its_support(precision):
    """The quantile at 0 of a gamma law of shape 10^4 is 0; at 6000 the density is what no number holds."""
    law = gamma(1e4)
    kind = np.dtype(precision).type
    sample = lambda u: law.ppf(u[:, 0].astype(float)).astype(kind)  # noqa: E731
    pdf = lambda x: law.pdf(x).astype(kind).astype(float)  # noqa: E731
    finding = edge_uniforms(Subject(sample, pdf, HalfLine(0.0), 1, precision=precision), {})
    assert finding.outcome == "not rejected", finding.message


@pytest.mark.parametrize("inner", [False, True])
def test_a_hole_before_an_end_is_one_and_so_is_an_underflow_inside(inner):
    """A support that ends at 1 does not reach 0; a point inside, where the density underflows, is no end."""
    law = gamma(1e4)
    lost = 3000.0 if inner else 0.0

    def sample(u):
        return np.where(u[:, 0] == 0, lost, law.ppf(np.maximum(u[:, 0], 2.0**-60)) if inner else 1 + u[:, 0])

    pdf = law.pdf if inner else lambda x: np.where((x >= 1) & (x <= 2), 1.0, 0.0)
    finding = edge_uniforms(Subject(sample, pdf, HalfLine(0.0), 1), {})
    assert "not at the edge of its support" in finding.message
