"""Invariant: a kind of phase function that gives its density and a sampler works everywhere. This one is made here.

f(mu) = (n + 1)/(2 pi 2^(n+1)) (1 + mu)^n: three files, found by their name; no table and no list of the package knows them.
"""

import importlib
import sys

import mpmath as mp
import numpy as np
import pytest

import fogproof
from fogproof.analytic import (
    airlight_integral,
    phase_cdf,
    phase_legendre_moments,
    phase_mean_cosine,
    phase_pdf,
    phase_quantile,
    single_scattering,
    slab_emissivity,
)
from fogproof.checks import check_estimator, check_sampler, fresh_seed
from fogproof.contracts import Reference
from fogproof.domains import UnitSphere
from fogproof.errors import UnsupportedError
from fogproof.estimators import Airlight, Cosines, Directions, PathTracer, SpectralPathTracer
from fogproof.scene import Environment, Isotropic, Medium, Mixture, PointLight, Ray, Slab

FILES = {
    "scene": """
from dataclasses import dataclass
from fogproof.scene.phase.phase_function import PhaseFunction

@dataclass(frozen=True)
class CosinePower(PhaseFunction):
    n: float
""",
    "analytic": """
import numpy as np

SOURCE, METHOD = "made up", "closed form"

def pdf(phase, mu):
    n = phase.n
    value = (n + 1) / (2 * np.pi * 2 ** (n + 1)) * (1 + mu) ** n
    return value, 1e-15 * (n + 8) * value
""",
    "estimators": """
import numpy as np
from fogproof.estimators.phase.polar import Polar

def density(phase, versine, coversine):
    n = phase.n
    return (n + 1) / (4 * np.pi) * (coversine / 2) ** n

def polar(phase, xi):
    u = xi ** (1 / (phase.n + 1))
    rest = -np.expm1(np.log(np.maximum(xi, 1e-300)) / (phase.n + 1))
    return Polar(2 * rest, 2 * u, density(phase, 2 * rest, 2 * u))
""",
}
N, ALPHA = 6.5, 1e-9
POLE, RAY, LAMP = (0.0, 0.0, 1.0), Ray((0, 0, 0), (0, 0, 1), 4.0), PointLight((1.0, 0.5, 2.0), 3.0)


@pytest.fixture(scope="module")
def phase(tmp_path_factory):
    """One of the new kind."""
    packages = {side: importlib.import_module(f"fogproof.{side}.phase") for side in FILES}
    for side, text in FILES.items():
        folder = tmp_path_factory.mktemp(side)
        (folder / "cosine_power.py").write_text(text)
        packages[side].__path__.append(str(folder))
    yield importlib.import_module("fogproof.scene.phase.cosine_power").CosinePower(N)
    for side, package in packages.items():
        package.__path__.pop()
        sys.modules.pop(f"fogproof.{side}.phase.cosine_power", None)


def test_values(phase):
    mu = np.linspace(-1, 1, 101)
    assert np.allclose(phase_pdf(phase, mu).value, (N + 1) / (4 * np.pi) * ((1 + mu) / 2) ** N, rtol=1e-13)
    cdf = phase_cdf(phase, mu)
    assert cdf.method == "quadrature of the pdf"
    assert np.all(np.abs(cdf.value - ((1 + mu) / 2) ** (N + 1)) <= cdf.error)
    assert np.max(cdf.error) < 1e-12
    xi = np.array([0.0, 1e-6, 0.3, 0.999, 1.0])
    quantile = phase_quantile(phase, xi)
    assert np.all(np.abs(quantile.value - (2 * xi ** (1 / (N + 1)) - 1)) <= quantile.error + 1e-15)


def test_moments(phase):
    """n!(n+1)!/((n-l)!(n+l+1)!), whatever n."""
    found = phase_legendre_moments(phase, 60)
    right = [mp.gamma(N + 1) * mp.gamma(N + 2) / (mp.gamma(N - l + 1) * mp.gamma(N + l + 2)) for l in range(61)]  # noqa: E741
    assert all(abs(v - r) <= e + 1e-15 for v, r, e in zip(found.value, right, found.error, strict=True))
    assert np.max(found.error) < 1e-12
    mean = phase_mean_cosine(phase)
    assert abs(mean.value - N / (N + 2)) <= mean.error


def test_airlight(phase):
    for sigma, h, a, b in ((0.7, 0.5, -3.0, 4.0), (0.0, 2.0, 0.0, np.inf), (3.0, 0.01, -1.0, 1.0)):
        found = airlight_integral(sigma, h, a, b, phase)

        def integrand(s, sigma=sigma, h=h, a=a):
            return mp.exp(-sigma * (h * mp.exp(s) - a)) / (h * mp.cosh(s)) * (N + 1) * ((1 - mp.tanh(s)) / 2) ** N

        end = mp.asinh(b / h) if b < np.inf else mp.inf
        right = mp.quad(integrand, [mp.asinh(a / h), 0, end] if a < 0 else [0, 1, 5, end])
        assert abs(found.value - right) <= found.error
        assert found.error < 1e-11 * found.value
    with pytest.raises(UnsupportedError, match="nothing is proven for the phase function CosinePower"):
        airlight_integral(1.0, 1.0, 0.0, 1.0, phase, rigorous=True)


def test_samplers(phase):
    mean = float(phase_mean_cosine(phase).value)
    directions = Directions(phase)
    verdict = check_sampler(
        directions.sample, directions.pdf, UnitSphere(), dimensions=2, axis=POLE, mean_cosine=mean, alpha=ALPHA,
        reference=lambda x: phase_pdf(phase, np.clip(x[:, 2], -1, 1)), samples=100_000, seed=fresh_seed(),
    )  # fmt: skip
    verdict.raise_unless_passed()
    wrong = Directions(type(phase)(N + 0.2))
    assert check_sampler(
        wrong.sample, directions.pdf, UnitSphere(), dimensions=2, axis=POLE, samples=100_000, seed=fresh_seed()
    ).outcome == "rejected"  # fmt: skip
    assert abs(np.mean(Cosines(phase).sample(np.random.default_rng(1).random((100_000, 1))).x) - mean) < 0.01


def test_single_scattering(phase):
    medium = Medium(0.1, 0.9, phase)
    right = single_scattering(medium, RAY, LAMP)
    check_estimator(
        Airlight(medium, RAY, LAMP).draw, right, samples=50_000, alpha=ALPHA, seed=fresh_seed()
    ).raise_if_rejected()
    assert right.error < 1e-10 * right.value


@pytest.mark.parametrize("mixed", [False, True])
def test_paths(phase, mixed):
    used = Mixture((phase, Isotropic()), (0.6, 0.4)) if mixed else phase
    ray, slab = Ray((0, 0, 1.0), (0.8, 0, -0.6), np.inf), Slab((0, 0, 0), POLE, 2.0)
    e = slab_emissivity(0.9, 2.0, 0.6, used)
    assert e.error < 1e-6
    reference = Reference(1 - e.value, e.error + 1e-5)
    tracer = PathTracer(Medium(0.1, 0.9, used), slab, ray, Environment(1.0))
    check_estimator(tracer.draw, reference, samples=50_000, alpha=ALPHA, seed=fresh_seed()).raise_if_rejected()
    colours = SpectralPathTracer(Medium((0.1, 0.2), (0.9, 0.8), used), slab, ray, Environment(1.0))
    both = Reference([1 - e.value, 1 - slab_emissivity(0.8, 2.0, 0.6, used).value], [e.error + 1e-5] * 2)
    check_estimator(colours.draw, both, samples=50_000, alpha=ALPHA, seed=fresh_seed()).raise_if_rejected()


def test_a_kind_without_formulas_is_refused_by_name():
    class Unknown(fogproof.scene.PhaseFunction):
        """Nobody has a formula for it."""

        def __repr__(self):
            return "Unknown()"

    with pytest.raises(UnsupportedError, match=r"the oracle has no formula for the phase function Unknown\(\)"):
        phase_pdf(Unknown(), 0.0)
    with pytest.raises(UnsupportedError, match=r"nothing draws from the phase function Unknown\(\)"):
        Directions(Unknown()).sample(np.zeros((1, 2)))
