"""What a verdict says of a cause is true: no 100 % where a part is left, no other error beside the one, no place for a law."""

import numpy as np
import pytest
from scipy import special

from fogproof import Discrete, HalfLine, Product, RealLine, UnitDisk, UnitHemisphere, UnitSphere, check_sampler

N = 100_000
TURN = 2 * np.pi
PAIRS = Product(RealLine(), RealLine())


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def angular_gaussian():
    """Directions of a normal law with covariance S, and their density (Tyler 1987)."""
    s = np.array([[1, 0.5, 0.1], [0.5, 2, 0], [0.1, 0, 0.3]])
    root, inverse, area = np.linalg.cholesky(s), np.linalg.inv(s), 4 * np.pi * np.sqrt(np.linalg.det(s))

    def sample(rng, n):
        return unit(rng.normal(size=(n, 3)) @ root.T)

    return sample, lambda w: np.einsum("ni,ij,nj->n", w, inverse, w) ** -1.5 / area


def test_a_constant_factor_is_all_that_is_wrong():
    sample, pdf = angular_gaussian()
    verdict = check_sampler(sample, lambda w: 0.8 * pdf(w), UnitSphere(), dimensions=None, samples=N)
    assert verdict.cause == "normalisation", str(verdict)
    assert verdict.diagnosis == "the samples fit the pdf but for a constant factor 0.8", str(verdict)


def test_a_constant_factor_is_not_all_that_is_wrong():
    sample, _ = angular_gaussian()
    verdict = check_sampler(
        sample, lambda w: 0.2 / np.pi * (1 + 0.3 * w[:, 0] ** 3), UnitSphere(), dimensions=None, samples=N
    )
    assert "fit the pdf but for a constant" not in verdict.diagnosis, str(verdict)


def correlated(rho):
    return lambda rng, n: rng.multivariate_normal([0, 0], [[1, rho], [rho, 1]], n)


def bell_of_two(x, rho=0.0):
    square = (x[:, 0] ** 2 - 2 * rho * x[:, 0] * x[:, 1] + x[:, 1] ** 2) / (1 - rho**2)
    return np.exp(-0.5 * square) / (TURN * np.sqrt(1 - rho**2))


def test_a_correlation_is_no_stretch():
    """A stretch by .99 gains a fifth of the log-likelihood."""
    verdict = check_sampler(correlated(0.53), lambda x: bell_of_two(x, 0.5), PAIRS, dimensions=None, samples=3 * N)
    assert verdict.outcome == "rejected"
    assert "stretched" not in verdict.diagnosis, str(verdict)
    assert verdict.cause != "wrong scale", str(verdict)


MU, WEIGHT = np.polynomial.legendre.leggauss(400)
KENT = TURN * np.sum(WEIGHT * np.exp(20 * (MU - 1)) * special.i0(8 * (1 - MU * MU)))  # integral of Kent's exponential


def kent(b, bound=0.35):
    """Kent's law (1982) by rejection of a lobe, its bound too low where `bound` is."""

    def sample(rng, n):
        u = rng.random((16 * n, 3))
        mu = 1 + np.log(u[:, 0] + (1 - u[:, 0]) * np.exp(-8)) / 4
        s, phi = np.sqrt(1 - mu * mu), TURN * u[:, 1]
        w = np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)
        return w[np.log(u[:, 2]) < 16 * (mu - 1) + b * (w[:, 0] ** 2 - w[:, 1] ** 2) - bound][:n]

    return sample


def kent_pdf(w):
    return np.exp(20 * (w[:, 2] - 1) + 8 * (w[:, 0] ** 2 - w[:, 1] ** 2)) / KENT


@pytest.mark.parametrize(("b", "bound"), [(7.5, 0.35), (8.0, -0.2)])
def test_a_share_that_is_left_is_seen_or_said(b, bound):
    """Of the misfit a quarter and two thirds are left by the named laws, a power of the cosine and a stretch."""
    verdict = check_sampler(kent(b, bound), kent_pdf, UnitSphere(), dimensions=None, samples=N)
    assert verdict.outcome == "rejected"
    assert "explains 100%" not in verdict.diagnosis, str(verdict)


def visible_normals(u, slope=(0.5, 0.1), to=(0.7, -0.4, 0.25)):
    """Heitz's visible normals (2018) with the second tangent the wrong way: a quarter of them is clamped to the horizon."""
    stretch = np.array([*slope, 1.0])
    view = unit(unit(np.array(to)) * stretch)
    first = unit(np.array([-view[1], view[0], 0.0]))
    second = -np.cross(view, first)
    r, phi, s = np.sqrt(u[:, 0]), TURN * u[:, 1], 0.5 * (1 + view[2])
    a = r * np.cos(phi)
    b = (1 - s) * np.sqrt(1 - a * a) + s * r * np.sin(phi)
    c = np.sqrt(np.maximum(0, 1 - a * a - b * b))
    x = a[:, None] * first + b[:, None] * second + c[:, None] * view
    x[:, 2] = np.maximum(0, x[:, 2])
    return unit(x * stretch)


def visible_pdf(h, slope=(0.5, 0.1), to=(0.7, -0.4, 0.25)):
    to = unit(np.array(to))
    squares = (h[:, 0] / slope[0]) ** 2 + (h[:, 1] / slope[1]) ** 2 + h[:, 2] ** 2
    smith = 0.5 * (1 + np.sqrt(1 + ((slope[0] * to[0]) ** 2 + (slope[1] * to[1]) ** 2) / to[2] ** 2))
    return np.maximum(0, h @ to) / (np.pi * slope[0] * slope[1] * squares**2 * smith * to[2])


def test_a_clamp_is_told_before_a_law():
    verdict = check_sampler(visible_normals, visible_pdf, UnitHemisphere(), dimensions=2, samples=N)
    assert verdict.cause == "atom", str(verdict)
    assert "x[2] = 0" in verdict.diagnosis, str(verdict)


def test_a_law_that_fills_holes_is_not_near():
    """The index is one too low, and 0 where it would be negative: off by two is near to nothing."""
    w = np.array([5, 1, 0, 3, 0.5, 0, 7, 2.0]) / 18.5

    def entry(u):
        return np.maximum(np.searchsorted(np.cumsum(w)[:-1], u[:, 0], side="right") - 1, 0)

    verdict = check_sampler(entry, lambda k: w[np.asarray(k, dtype=int)], Discrete(8), dimensions=1, samples=N)
    assert "near to" not in verdict.diagnosis, str(verdict)
    assert verdict.cause == "claimed hole", str(verdict)


def test_the_same_is_not_said_twice():
    def pdf(k):
        return 0.3 * 0.7**k

    verdict = check_sampler(lambda rng, n: rng.geometric(0.3, n), pdf, Discrete(np.inf), dimensions=None, samples=N)
    assert "off by +1" in verdict.diagnosis, str(verdict)
    assert verdict.diagnosis.count("never reached") <= 1, str(verdict)


def test_all_columns_are_said_to_be_all():
    """A radius of Box and Muller (1958) that is short by the square root of 2."""

    def sample(u):
        r = np.sqrt(-np.log1p(-u[:, :1]))
        return r * np.stack([np.cos(TURN * u[:, 1]), np.sin(TURN * u[:, 1])], axis=-1)

    verdict = check_sampler(sample, bell_of_two, PAIRS, dimensions=2, samples=N)
    assert verdict.cause == "wrong scale", str(verdict)
    assert "all columns" in verdict.diagnosis, str(verdict)


def test_one_column_is_said_to_be_one():
    def sample(rng, n):
        return np.stack([rng.exponential(0.8, n), rng.exponential(1.0, n)], axis=-1)

    domain = Product(HalfLine(0), HalfLine(0))
    verdict = check_sampler(sample, lambda x: np.exp(-x.sum(axis=1)), domain, dimensions=None, samples=N)
    assert verdict.cause == "wrong scale", str(verdict)
    assert "in the column 0" in verdict.diagnosis, str(verdict)


def test_one_deviation_of_two_is_no_power_of_both():
    def sample(rng, n):
        return rng.normal(size=(n, 2)) * [np.sqrt(0.5), 1.0]

    verdict = check_sampler(sample, bell_of_two, PAIRS, dimensions=None, samples=N)
    assert verdict.cause == "wrong scale", str(verdict)
    assert "in the column 0" in verdict.diagnosis, str(verdict)


def test_light_tails_are_no_skipped_band():
    """A normal law in the place of Student's with 30 degrees of freedom."""

    def student(x, nu=30):
        log = special.gammaln(0.5 * (nu + 1)) - special.gammaln(0.5 * nu) - 0.5 * np.log(nu * np.pi)
        return np.exp(log - 0.5 * (nu + 1) * np.log1p(x * x / nu))

    def sample(rng, n):
        return rng.normal(scale=np.sqrt(30 / 28), size=n)

    verdict = check_sampler(sample, student, RealLine(), dimensions=None, samples=2 * N)
    assert verdict.outcome == "rejected"
    assert verdict.cause != "skipped band", str(verdict)


def test_a_squeezed_disk_skips_no_band():
    def sample(u):
        r = np.sqrt(u[:, 0])
        return np.stack([r * np.cos(TURN * u[:, 1]), 0.97 * r * np.sin(TURN * u[:, 1])], axis=-1)

    verdict = check_sampler(sample, lambda x: np.full(len(x), 1 / np.pi), UnitDisk(), dimensions=2, samples=N)
    assert verdict.outcome == "rejected"
    assert verdict.cause != "skipped band", str(verdict)


def test_a_place_is_told_in_a_coordinate():
    """Heights between .1 and .2 are never drawn."""

    def sample(u):
        z = 0.9 * u[:, 0] + 0.1 * (u[:, 0] > 1 / 9)
        s = np.sqrt(1 - z * z)
        return np.stack([s * np.cos(TURN * u[:, 1]), s * np.sin(TURN * u[:, 1]), z], axis=-1)

    verdict = check_sampler(sample, lambda x: np.full(len(x), 1 / TURN), UnitHemisphere(), dimensions=2, samples=N)
    assert verdict.cause == "skipped band", str(verdict)
    assert "< x[2] < 0.2;" in verdict.diagnosis, str(verdict)
