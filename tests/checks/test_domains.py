"""Every domain: its known law stays inside, its coordinates undo it, and its density is one."""

import math

import numpy as np
import pytest

from fogproof import (
    Ball,
    Box,
    Discrete,
    HalfLine,
    Interval,
    InvalidValueError,
    Product,
    RealLine,
    Rectangle,
    Rotations,
    SpherePart,
    SphericalTriangle,
    Triangle,
    UnitDisk,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
    check_sampler,
)

N = 20_000
DOMAINS = [
    UnitSphere(),
    UnitHemisphere(),
    SpherePart(lambda x: x[:, 0] > 0.2),
    SphericalTriangle((1, 0, 0), (0, 1, 0), (0.3, 0.1, 2)),
    UnitDisk(),
    UnitSquare(),
    Rectangle((-1, 2), (3, 2.5)),
    Triangle((0, 0), (1, 0), (0.2, 2)),
    Triangle((0, 0, 1), (1, 0, 3), (0, 2, 1)),
    Box((0, 1, 2, 3, -4), (1, 2, 3, 4, 6)),
    Ball(2.0, (1.0, -2.0, 3.0)),
    Rotations(),
    Interval(-2, 5),
    HalfLine(1.0),
    RealLine(),
    Discrete(7),
    Discrete(math.inf),
    Product(Interval(0, 1), UnitSphere(), Discrete(3)),
]


@pytest.mark.parametrize("domain", DOMAINS, ids=lambda domain: type(domain).__name__)
def test_the_known_law_stays_inside_and_its_coordinates_undo_it(domain):
    rng = np.random.default_rng()
    law = domain.law(np.empty((0, *domain.shape)))
    k = len(law.axes)
    u, v = rng.random((N, k)), rng.random((N, k))
    x = law.place(u)
    assert x.shape == (N, *domain.shape)
    part = isinstance(domain, (SpherePart, SphericalTriangle))
    assert part or domain.contains(x, 2e-15).all()
    assert not domain.contains(np.full_like(x, np.nan), 2e-15).any()
    with np.errstate(invalid="ignore"):
        assert not domain.contains(x + np.inf, 2e-15).any()
    back = law.coordinates(x, v)
    assert back.shape == u.shape
    assert back.min() >= 0
    assert back.max() <= 1
    if not law.stepped:
        np.testing.assert_allclose(back, u, atol=1e-9)
    else:  # a place in the interval of the same point, and as uniform
        again = law.place(np.minimum(back, 1 - 1e-16))
        assert np.mean(np.abs(again - x) <= 1e-9 * np.abs(x)) > 0.999
        assert np.all(np.abs(back.mean(axis=0) - 0.5) < 6 / math.sqrt(12 * N))


@pytest.mark.parametrize("domain", DOMAINS, ids=lambda domain: type(domain).__name__)
def test_the_density_of_the_known_law_is_that_of_its_points(domain):
    """The mean of 1 / density over points of the law is the measure of the domain, or of the reach of its quantiles."""
    law = domain.law(np.empty((0, *domain.shape)))
    u = np.random.default_rng().random((N, len(law.axes)))
    x = law.place(u)
    if math.isfinite(domain.measure):
        values = domain.contains(x, 2e-15) / law.density(x)
        assert abs(values.mean() - domain.measure) <= 6 * values.std() / math.sqrt(N) + 1e-12 * domain.measure
    elif domain.shape == () and math.isinf(domain.measure):
        low, high = law.place(np.array([[0.6], [0.8]]))
        values = (x >= low) & (x < high)
        length = np.where(values, 1 / law.density(x), 0.0)
        assert abs(length.mean() - (high - low)) <= 6 * length.std() / math.sqrt(N)


def test_tails_of_the_known_law_follow_the_pilot():
    pareto = (1 - np.random.default_rng().random(N)) ** (-1 / 0.2)
    u = HalfLine(1.0).law(pareto).coordinates(pareto, np.empty(0))
    assert np.ptp(np.quantile(u, [0.01, 0.99])) > 0.5, "no crowd at an end"


def test_measures():
    assert SphericalTriangle((1, 0, 0), (0, 2, 0), (0, 0, 3)).measure == pytest.approx(np.pi / 2, rel=1e-14)
    assert Triangle((0, 0, 0), (1, 0, 0), (0, 1, 1)).measure == pytest.approx(math.sqrt(0.5), rel=1e-14)
    assert Ball(2.0).measure == pytest.approx(32 / 3 * np.pi, rel=1e-14)


BAD = [
    (lambda: Box((0, 0), (1, 0)), "high must be finite and greater than low"),
    (lambda: Rectangle((0, 0, 0), (1, 1, 1)), "low must be two numbers"),
    (lambda: Triangle((0, 0), (1, 1), (2, 2)), "c must lie off the line"),
    (lambda: SphericalTriangle((1, 0, 0), (0, 1, 0), (1, 1, 0)), "c must be a direction off the great circle"),
    (lambda: Ball(0.0), "radius must be > 0"),
    (lambda: Discrete(2.5), "n must be a whole number >= 1, or math.inf"),
    (lambda: Product(UnitSphere()), "parts must be two domains or more"),
    (lambda: check_sampler(lambda u: u, lambda x: x, "sphere", dimensions=1), "domain must be one of"),
    (
        lambda: check_sampler(lambda u: u, lambda x: x, UnitSphere(), dimensions=2, atoms={1.0: 0.5}),
        "atoms must be points of",
    ),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_domains_are_explained(make, message):
    with pytest.raises(InvalidValueError, match=message):
        make()


ENDS = [  # a point at an end, the way out, the size
    (Interval(0.0, 10.0), 0.0, -1.0, 10.0),
    (Interval(-2.0, 5.0), 5.0, 1.0, 7.0),
    (HalfLine(-1.0), -1.0, -1.0, 1.0),
    (Rectangle((-1, 2), (3, 2.5)), (3.0, 2.2), (1.0, 0.0), 4.0),
    (Box((0, 0, 0), (1, 2, 4)), (0.5, 1.0, 0.0), (0.0, 0.0, -1.0), 4.0),
    (UnitDisk(), (1.0, 0.0), (1.0, 0.0), 1.0),
    (Ball(2.0, (0, 0, 0)), (0.0, 2.0, 0.0), (0.0, 1.0, 0.0), 2.0),
    (UnitHemisphere(), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0), 1.0),
    (SphericalTriangle((1, 0, 0), (0, 1, 0), (0, 0, 1)), (math.sqrt(0.5), math.sqrt(0.5), 0.0), (0.0, 0.0, -1.0), 1.0),
    (Triangle((0, 0), (2, 0), (0, 2)), (1.0, 0.0), (0.0, -1.0), 2.0),
]


@pytest.mark.parametrize(("domain", "end", "out", "size"), ENDS, ids=lambda value: type(value).__name__)
def test_rounding_is_forgiven_at_every_end_and_no_more(domain, end, out, size):
    beyond = np.array(end) + np.multiply.outer([0.0, 1e-14, 1e-12, 1e-9, 1e-6], np.array(out)) * size
    assert domain.contains(beyond, 16 * 2.0**-53).tolist() == [True, True, True, False, False]


@pytest.mark.parametrize("size", [1e-8, 1.0, 1e8])
def test_a_half_line_from_0_has_the_size_of_its_points(size):
    points = size * np.array([0.0, -1e-14, -1e-12, -1e-9, 1.0, 1.0, 7.0, 1e6, np.inf])
    within = [True, True, True, False, True, True, True, True, False]
    assert HalfLine(0.0).contains(points, 16 * 2.0**-53).tolist() == within
    assert not HalfLine(0.0).contains(np.array([-1e-14, -1e-14, 1.0]) * size, 16 * 2.0**-53)[0]  # most are beyond it


def equiangular(excess=0.0):
    """Return a sampler and its pdf on [0, 10] that relies on tan and arctan to undo each other, and lies too far out by a share."""
    near, distance, length = 7.0, 0.01, 10.0
    low, high = math.atan2(-near, distance), math.atan2(length - near, distance)

    def sample(u):
        t = near + distance * np.tan(low + (high - low) * u[:, 0])
        return t + excess * length * (2 * (t > 5) - 1)

    def pdf(t):
        inside = (t >= 0) & (t <= length)
        return np.where(inside, distance / ((high - low) * (distance**2 + (t - near) ** 2)), 0.0)

    return sample, pdf


def test_a_sampler_may_miss_the_end_of_its_support_by_rounding():
    sample, pdf = equiangular()
    ends = sample(np.array([[0.0], [1.0]]))
    assert -1e-11 < ends[0] < 0 or 0 < ends[1] - 10 < 1e-11  # it does
    verdict = check_sampler(sample, pdf, Interval(0, 10), dimensions=1, samples=20_000, alpha=1e-7)
    assert verdict.outcome == "not rejected", verdict
    verdict = check_sampler(*equiangular(1e-8), Interval(0, 10), dimensions=1, samples=20_000, alpha=1e-7)
    assert verdict.outcome == "rejected"
    assert "9e-12 of the domain's size" in str(verdict)
    far = check_sampler(*equiangular(1e-3), Interval(0, 10), dimensions=1, samples=20_000, alpha=1e-7)
    assert "of the domain's size" not in str(far)
    beside = check_sampler(
        lambda u: -np.log1p(-u[:, 0]) - 1e-6,
        lambda t: np.exp(-t - 1e-6),
        HalfLine(0),
        dimensions=1,
        samples=20_000,
    )
    assert "9e-12 of the domain's size" in str(beside)
