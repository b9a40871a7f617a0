"""Peaks that a bound cuts off, linear dependences, swapped roughnesses of visible normals, parameters of laws of numbers."""

import numpy as np
import pytest
from laws_by_hand import TURN, about, bell, decay, hold, normal
from scipy.stats import chi2, t

from fogproof import HalfLine, Interval, Product, RealLine, Rotations, UnitHemisphere, UnitSphere, check_sampler
from fogproof.checks.diagnosis.points import _ring

N = 60_000
PAIRS = Product(RealLine(), RealLine())


def rejected(proposal, pdf, bound):
    """Return the sampler that accepts proposals (n, ...) of a constant density with the probability pdf / bound."""

    def sample(rng, n):
        x = proposal(rng, 8 * n + 99)
        return x[rng.random(len(x)) * bound < pdf(x)][:n]

    return sample


def directions(rng, n):
    return about(2 * rng.random(n) - 1, TURN * rng.random(n))


def hg(g, axis=(0.0, 0.0, 1.0)):
    return lambda x: (1 - g * g) / (2 * TURN) / (1 + g * g - 2 * g * (x @ np.array(axis))) ** 1.5


def two_lobes(x):
    return 0.6 * hg(0.6)(x) + 0.4 * hg(0.5, (0.8, 0.0, -0.6))(x)


def hump(x):
    return 0.5 * np.pi * np.sin(np.pi * x)


def pairs(covariance):
    return lambda rng, n: rng.multivariate_normal(np.zeros(len(covariance)), covariance, n)


def bell_of(covariance):
    inverse, scale = np.linalg.inv(covariance), np.sqrt(np.linalg.det(TURN * np.array(covariance)))
    return lambda x: np.exp(-0.5 * np.einsum("ni,ij,nj->n", x, inverse, x)) / scale


FACTOR = np.array([[1.5, 0.0], [0.7, 0.6]])
THREE = np.array([[1.0, 0.3, 0.0], [0.3, 2.0, -0.4], [0.0, -0.4, 0.5]])
OTHER = THREE + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.15], [0.0, 0.15, 0.0]])
TO = np.array([0.6, 0.48, 0.64])


def unit(x):
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def visible_normals(slope, to=TO):
    """Heitz's visible normals of GGX (2018)."""
    scale = np.array([*slope, 1.0])
    view = unit(to * scale)
    first = unit(np.array([-view[1], view[0], 0.0]))
    second = np.cross(view, first)

    def sample(u):
        r, phi, s = np.sqrt(u[:, 0]), TURN * u[:, 1], 0.5 * (1 + view[2])
        a = r * np.cos(phi)
        b = (1 - s) * np.sqrt(1 - a * a) + s * r * np.sin(phi)
        c = np.sqrt(np.maximum(0, 1 - a * a - b * b))
        x = a[:, None] * first + b[:, None] * second + c[:, None] * view
        x[:, 2] = np.maximum(x[:, 2], 1e-9)
        return unit(x * scale)

    return sample


def visible_pdf(slope, to=TO):
    smith = 0.5 * (1 + np.sqrt(1 + ((slope[0] * to[0]) ** 2 + (slope[1] * to[1]) ** 2) / to[2] ** 2))

    def pdf(h):
        squares = (h[:, 0] / slope[0]) ** 2 + (h[:, 1] / slope[1]) ** 2 + h[:, 2] ** 2
        return np.maximum(0, h @ to) / (np.pi * slope[0] * slope[1] * squares**2 * smith * to[2])

    return pdf


def leaning(q):
    """A density of rotations as unit quaternions (x, y, z, w) that prefers some: no column is like another."""
    return (1 + 0.8 * q[:, 3] ** 2 - 0.4 * q[:, 1] ** 2 + 0.3 * q[:, 2] ** 2) / (1 + 0.175) / (np.pi**2)


def leaning_rotations(rng, n):
    q = unit(rng.normal(size=(8 * n, 4)))
    return q[rng.random(len(q)) * 2 < 1 + 0.8 * q[:, 3] ** 2 - 0.4 * q[:, 1] ** 2 + 0.3 * q[:, 2] ** 2][:n]


CASES = {  # sampler, pdf, domain, dimensions; the cause and words of what explains it
    "a capped lobe": ((rejected(directions, hg(0.6), 0.3), hg(0.6), UnitSphere(), None), "capped peak", "bound"),
    "capped lobes": ((rejected(directions, two_lobes, 0.2), two_lobes, UnitSphere(), None), "capped peak", "bound"),
    "a capped hump": (
        (rejected(lambda rng, n: rng.random(n), hump, 1.3), hump, Interval(0, 1), None),
        "capped peak",
        "bound",
    ),
    "a correlation": (
        (pairs([[1, 0.56], [0.56, 1]]), bell_of([[1, 0.5], [0.5, 1]]), PAIRS, None),
        "correlation",
        "0.5",
    ),
    "a correlation that should not be": (
        (pairs([[1, 0.3], [0.3, 4]]), bell_of([[1, 0], [0, 4]]), PAIRS, None),
        "correlation",
        "the pdf's is",
    ),
    "one correlation of three": (
        (pairs(OTHER), bell_of(THREE), Product(*[RealLine()] * 3), None),
        "correlation",
        "of the columns 1 and 2",
    ),
    "a factor transposed": (
        (pairs(FACTOR.T @ FACTOR), bell_of(FACTOR @ FACTOR.T), PAIRS, None),
        "transposed matrix",
        "Cholesky",
    ),
    "roughnesses of visible normals": (
        (visible_normals((0.2, 0.6)), visible_pdf((0.6, 0.2)), UnitHemisphere(), 2),
        "swapped axes",
        "visible from (0.600, 0.480, 0.640)",
    ),
    "two parts of a quaternion": (
        (lambda rng, n: leaning_rotations(rng, n)[:, [3, 1, 2, 0]], leaning, Rotations(), None),
        "swapped axes",
        "columns 0 and 3 swapped",
    ),
    "Student's degrees of freedom": (
        (lambda rng, n: 3 + 2 * rng.standard_t(6, n), lambda x: t(4).pdf((x - 3) / 2) / 2, RealLine(), None),
        "another parameter",
        "degrees of freedom; the pdf's are 4",
    ),
    "chi-square's degrees of freedom": (
        (lambda rng, n: rng.chisquare(5, n), chi2(4).pdf, HalfLine(0), None),
        "another parameter",
        "the pdf's is 2",
    ),
    "a factor x of a gamma law": (
        (lambda rng, n: rng.gamma(2, 1, n), decay, HalfLine(0), None),
        "missing Jacobian",
        "a factor x too many",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_cause_is(name):
    hold(CASES[name], N)


def test_a_broader_normal_law_is_no_logarithm():
    """Its variance of 1.44 is near to 1 / ln 2."""
    verdict = check_sampler(lambda u: 1.2 * normal(u), bell, RealLine(), dimensions=1, samples=150_000)
    assert verdict.cause == "wrong scale", str(verdict)
    assert "logarithm" not in verdict.diagnosis, verdict.diagnosis


def test_directions_clamped_to_a_circle_tell_it_however_close_they_lie():
    """The nearest to the mean lie on an arc of thousandths, whose plane rounding tilts."""
    rng, frame = np.random.default_rng(), np.linalg.qr(np.random.default_rng().normal(size=(3, 3)))[0]
    for _ in range(10):
        mu = np.minimum(1 - 0.05 * rng.random(200_000), 0.99)
        axis = _ring(about(mu, TURN * rng.random(len(mu))) @ frame)
        assert axis is not None
        assert abs(axis @ frame[2]) > 1 - 1e-12
