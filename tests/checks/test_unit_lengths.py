"""Directions have length 1 but for what rounding does; single ones, at the pole of a lobe, may be off by more."""

import numpy as np
import pytest

from fogproof import Interval, Product, SpherePart, SphericalTriangle, UnitHemisphere, UnitSphere, check_sampler

SINGLE = {"dimensions": 2, "precision": "float32", "samples": 50_000}
OBLIQUE = np.linalg.qr(np.array([[1, 1, 0], [2, 0, 1], [2, 0, 0]]))[0].astype(np.float32)


def sphere(u, highest=2.0):
    kind = u.dtype.type
    mu, phi = 1 - kind(highest) * u[:, 0], kind(2 * np.pi) * u[:, 1]
    sine = np.sqrt(np.maximum(1 - mu * mu, kind(0)))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


def even(x):
    return np.full(len(x), 0.25 / np.pi)


def lobe(g):
    def sample(u):
        kind = u.dtype.type
        g_ = kind(g)
        s = (1 - g_ * g_) / (1 - g_ + 2 * g_ * u[:, 0])
        mu, phi = (1 + g_ * g_ - s * s) / (2 * g_), kind(2 * np.pi) * u[:, 1]
        sine = np.sqrt(np.maximum(1 - mu * mu, kind(0)))
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)

    return sample, lambda x: (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]) ** 1.5)


def fisher(u):
    """Von Mises-Fisher with kappa = 1e-3: the cosine is off by all that a logarithm near 1 is, a thousand times as much."""
    kind, k = u.dtype.type, u.dtype.type(1e-3)
    mu, phi = 1 + np.log(u[:, 0] + (1 - u[:, 0]) * np.exp(-2 * k)) / k, kind(2 * np.pi) * u[:, 1]
    sine = np.sqrt(np.maximum(1 - mu * mu, kind(0)))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1) @ OBLIQUE


def fisher_pdf(x):
    return 1e-3 / (4 * np.pi * np.sinh(1e-3)) * np.exp(1e-3 * (x @ OBLIQUE[2].astype(float)))


def kept_apart(sample, highest):
    """The cosine alone is clamped."""

    def clamped(u):
        x = sample(u)
        x[:, 2] = np.minimum(x[:, 2], u.dtype.type(highest))
        return x

    return clamped


def beside_a_distance(sample):
    return lambda u: np.column_stack([u[:, 2], sample(u[:, :2])])


def long_by(off):
    return lambda u: sphere(u) * u.dtype.type(1 + off)


WRONG = {
    "too long": (long_by(1e-4), even, UnitSphere(), {}),
    "too short": (long_by(-1e-5), even, UnitSphere(), {}),
    "in double precision": (long_by(1e-13), even, UnitSphere(), {"precision": "float64"}),
    "one in a hundred": (
        lambda u: np.where(u[:, :1] < 0.01, u.dtype.type(1 + 2e-5), u.dtype.type(1)) * sphere(u), even, UnitSphere(), {}),
    "a cosine clamped, the others kept": (kept_apart(lobe(0.95)[0], 0.9999), lobe(0.95)[1], UnitSphere(), {}),
    "above": (lambda u: sphere(u, 1.0) * u.dtype.type(1 + 1e-4), lambda x: 2 * even(x), UnitHemisphere(), {}),
    "in a part": (
        lambda u: sphere(u, 1.0) * u.dtype.type(1 + 1e-4), lambda x: 2 * even(x), SpherePart(lambda x: x[:, 2] >= 0), {}),
    "beside a distance": (
        beside_a_distance(long_by(1e-4)), even, Product(Interval(0.0, 1.0), UnitSphere()), {"dimensions": 3}),
}  # fmt: skip
RIGHT = {
    "even": (sphere, even, UnitSphere(), {}),
    "in an oblique frame": (lambda u: sphere(u) @ OBLIQUE, even, UnitSphere(), {}),
    "ten frames": (lambda u: sphere(u) @ np.linalg.matrix_power(OBLIQUE, 10), even, UnitSphere(), {}),
    "a textbook lobe that is nearly even": (*lobe(1e-3), UnitSphere(), {}),
    "an oblique lobe of von Mises and Fisher": (fisher, fisher_pdf, UnitSphere(), {}),
    "beside a distance": (beside_a_distance(sphere), even, Product(Interval(0.0, 1.0), UnitSphere()), {"dimensions": 3}),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_direction_is_told(name):
    sample, pdf, domain, options = WRONG[name]
    verdict = check_sampler(sample, pdf, domain, **{**SINGLE, **options})
    assert "unit length" in {f.check for f in verdict.findings if f.outcome == "rejected"}, str(verdict)
    assert verdict.cause == "outside the domain"
    assert "normalise it" in str(verdict)


@pytest.mark.parametrize("name", RIGHT)
def test_rounding_is_forgiven(name):
    sample, pdf, domain, options = RIGHT[name]
    verdict = check_sampler(sample, pdf, domain, **{**SINGLE, **options})
    assert verdict.outcome == "not rejected", str(verdict)


def test_they_leave_length_1_where_it_is_forgiven():
    """Or nothing would be forgiven above."""
    u = np.random.default_rng(1).random((200_000, 2), dtype=np.float32)
    for sample in (lobe(1e-3)[0], fisher):
        off = np.abs(np.linalg.norm(sample(u).astype(float), axis=1) - 1)
        assert off.max() > 1e-5
        assert 0 < np.mean(off > 4e-6) < 2e-4


@pytest.mark.parametrize("scale", [1 + 1e-9, 1 + 1e-6, 1.001, 0.999, 2.0])
@pytest.mark.parametrize("octant", [False, True])
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_directions_of_a_wrong_length_are_told_by_their_length(scale, octant):
    """Whatever the length: it is not an end of the domain that they pass, and clamping is no cure."""
    domain = SphericalTriangle((1, 0, 0), (0, 1, 0), (0, 0, 1)) if octant else UnitSphere()
    sample = lambda u: scale * (np.abs(sphere(u)) if octant else sphere(u))  # noqa: E731
    pdf = lambda x: np.full(len(x), 1 / domain.measure)  # noqa: E731
    verdict = check_sampler(sample, pdf, domain, dimensions=2, samples=2000, seed=1)
    told = {f.check: f for f in verdict.findings if f.outcome == "rejected"}
    assert f"a direction is {abs(scale - 1):.2g} too {'long' if scale > 1 else 'short'}" in told["unit length"].message
    assert told["unit length"].effect == 1
    assert "clamp" not in str(verdict)


def test_a_direction_of_no_length_at_all_is_no_number_of_it():
    """A vector with a part that is no number, or infinite, is outside the domain."""

    def sample(u):
        x = sphere(u)
        x[u[:, 0] < 0.01, 0] = np.nan
        x[u[:, 0] > 0.99, 1] = np.inf
        return x

    verdict = check_sampler(sample, even, UnitSphere(), dimensions=2, samples=2000, seed=1)
    told = {f.check for f in verdict.findings if f.outcome == "rejected"}
    assert "domain" in told
    assert "unit length" not in told
