"""Invariant: the second moment of single scattering under each way of placing the event is its integral within the stated
error, enclosed by ball arithmetic, and what a simulation has; equiangular sampling has the airlight of twice the density."""

import math
from itertools import pairwise

import numpy as np
import pytest
from airlight_truth import phase_factor
from flint import acb, arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import (
    airlight_integral,
    airlight_second_moment,
    phase_pdf,
    single_scattering,
    single_scattering_second_moment,
    single_scattering_variance,
)
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import (
    HenyeyGreenstein,
    Isotropic,
    Medium,
    Mie,
    Mixture,
    Murky,
    PointLight,
    Ray,
    Rayleigh,
    Schlick,
    Tabulated,
)

SAMPLINGS = ("equiangular", "free-path", "distance", "uniform")
Z = (0.0, 0.0, 1.0)


def true_moment(sigma, h, a, b, phase, sampling):
    """The definition int (F e^{-sigma ((t-a)+r)} / r^2)^2 / p dt, with t = h sinh s, as an arb."""
    ctx.prec = 120
    S, H, A = arb(sigma), arb(h), arb(a)
    # Beyond s = 40 the attenuation alone is below e^-1e7 for every sigma and h that the test draws.
    low, high = (A / H).asinh(), (arb(b) / H).asinh() if b < math.inf else arb(40)
    theta = (arb(b) / H).atan() - (A / H).atan() if b < math.inf else arb.pi() / 2 - (A / H).atan()

    def inverse_pdf(t, r):
        match sampling:
            case "equiangular":
                return theta / H * r * r
            case "free-path":
                return (S * (t - A)).exp() / S
            case "distance":
                whole = 1 - (-S * (arb(b) - A)).exp() if b < math.inf else arb(1)
                return (S * (t - A)).exp() * whole / S
        return arb(b) - A

    def integrand(s, analytic):
        t, r = H * s.sinh(), H * s.cosh()
        F = phase_factor(phase, -s.tanh(), analytic)
        return F * F * (-2 * S * ((t - A) + r)).exp() / (r * r * r) * inverse_pdf(t, r)

    return acb.integral(integrand, low, high, rel_tol=arb(2) ** -70, abs_tol=arb(2) ** -2000, eval_limit=10**6).real


phases = st.one_of(
    st.sampled_from([Isotropic(), Rayleigh(), Murky()]),
    st.floats(-0.99, 0.99).map(HenyeyGreenstein),
    st.floats(-0.95, 0.95).map(Schlick),
    st.floats(-0.9, 0.9).map(lambda g: Mixture((HenyeyGreenstein(g), Rayleigh()), (0.25, 0.75))),
)


@settings(max_examples=60, deadline=None)
@given(
    sigma=st.floats(-4, 1.5).map(lambda e: 10.0**e),
    h=st.floats(-6, 1).map(lambda e: 10.0**e),
    a=st.floats(-5, 5),
    length=st.one_of(st.just(math.inf), st.floats(-3, 1.3).map(lambda e: 10.0**e)),
    phase=phases,
    sampling=st.sampled_from(SAMPLINGS),
)
def test_moment_is_within_its_error(sigma, h, a, length, phase, sampling):
    if math.isinf(length) and sampling == "uniform":
        length = 10.0
    b = a + length
    result = airlight_second_moment(sigma, h, a, b, phase, sampling)
    truth = true_moment(sigma, h, a, b, phase, sampling)
    assert abs(arb(float(result.value)) - truth) <= float(result.error), (truth, result)
    if truth > 1e-290:
        short = (1 + abs(a) + h) / min(length, 1)  # the ends of a short segment, rounded in s
        assert result.error <= 1e-12 * (1 + sigma * (abs(a) + min(length, 30))) * short * float(truth.mid())


@settings(max_examples=200, deadline=None)
@given(
    sigma=st.floats(-6, 2).map(lambda e: 10.0**e),
    h=st.floats(-9, 1).map(lambda e: 10.0**e),
    a=st.floats(-5, 5),
    length=st.floats(-2, 2).map(lambda e: 10.0**e),
)
def test_equiangular_is_the_airlight_of_twice_the_density(sigma, h, a, length):
    b = a + length
    theta = np.arctan2(h * (b - a), h * h + a * b)
    twice = airlight_integral(2 * sigma, h, a, b)
    moment = airlight_second_moment(sigma, h, a, b)
    slack = moment.error + theta / h * (twice.error + 1e-14 * twice.value)
    assert abs(moment.value - theta / h * twice.value) <= slack


def test_kinks_and_lorenz_mie():
    """Against a trapezoidal rule cut where the table has kinks, which knows eight digits."""
    pytest.importorskip("miepython", reason="python -m pip install 'fogproof[mie]'")
    table = Tabulated.normalised((-1, 0, 0.3, 1), (1, 0, 0, 2))
    cuts = [-1.5, -0.4 * 0.3 / math.sqrt(1 - 0.09), 0.0, 2.5]
    pieces = [np.linspace(low, high, 30_001) for low, high in pairwise(cuts)]
    for phase, rtol in ((table, 1e-12), (Mie(2e-6, 0.5e-6, 1.33), 1e-10)):
        airlight = []
        for t in pieces:
            r = np.hypot(t, 0.4)
            F = 4 * np.pi * phase_pdf(phase, -t / r).value
            airlight.append(F * np.exp(-0.7 * ((t + 1.5) + r)) / r**2)
        for sampling in SAMPLINGS:
            result = airlight_second_moment(0.7, 0.4, -1.5, 2.5, phase, sampling)
            assert result.error <= rtol * result.value
            moments = (
                np.trapezoid(f**2 / density(sampling, 0.7, 0.4, -1.5, 2.5, t), t)
                for f, t in zip(airlight, pieces, strict=True)
            )
            assert result.value == pytest.approx(sum(moments), rel=1e-7)


def density(sampling, sigma, h, a, b, t):
    match sampling:
        case "equiangular":
            return h / ((np.arctan(b / h) - np.arctan(a / h)) * (h * h + t * t))
        case "free-path":
            return sigma * np.exp(-sigma * (t - a))
        case "distance":
            return sigma * np.exp(-sigma * (t - a)) / -np.expm1(-sigma * (b - a))
    return np.full_like(t, 1 / (b - a))


def place(sampling, sigma, h, a, b, u):
    """Positions by inversion of each distribution."""
    match sampling:
        case "equiangular":
            low, high = np.arctan(a / h), np.arctan(b / h)
            return h * np.tan(low + u * (high - low))
        case "free-path":
            return a - np.log1p(-u) / sigma
        case "distance":
            return a - np.log1p(u * np.expm1(-sigma * (b - a))) / sigma
    return a + u * (b - a)


@pytest.mark.parametrize("sampling", SAMPLINGS)
@pytest.mark.parametrize("phase", [Isotropic(), HenyeyGreenstein(0.6)], ids=repr)
def test_simulation(phase, sampling):
    seed = 20250612
    print("seed", seed)
    medium = Medium(0.2, 0.5, phase)
    ray, light = Ray((0, 0, 0), Z, 3.0), PointLight((0.5, 0.0, 1.25), 7.0)
    h, a, b, sigma = 0.5, -1.25, 1.75, 0.7
    t = place(sampling, sigma, h, a, b, np.random.default_rng(seed).random(400_000))
    r = np.hypot(t, h)
    f = 0.5 * 7.0 * phase_pdf(phase, -t / r).value * np.exp(-sigma * ((t - a) + r)) / r**2
    X = np.where(t < b, f / density(sampling, sigma, h, a, b, t), 0.0)
    L = float(single_scattering(medium, ray, light).value)
    second = single_scattering_second_moment(medium, ray, light, sampling).value
    variance = single_scattering_variance(medium, ray, light, sampling).value
    for samples, expected in ((X, L), (X**2, second), ((X - L) ** 2, variance)):
        error = samples.std(ddof=1) / np.sqrt(samples.size)
        assert abs(samples.mean() - expected) < 6.1 * error  # false alarms: 1e-9


def test_equiangular_wins_beside_the_light():
    medium, ray = Medium(0.0, 0.2), Ray((0, 0, 0), Z, 10.0)
    relative = {s: [] for s in SAMPLINGS}
    for h in (0.1, 0.01, 0.001):
        light = PointLight((h, 0.0, 5.0), 1.0)
        L = single_scattering(medium, ray, light).value
        for sampling in SAMPLINGS:
            relative[sampling].append(float(single_scattering_variance(medium, ray, light, sampling).value / L**2))
    assert all(v < 2 for v in relative["equiangular"])
    for sampling in SAMPLINGS[1:]:  # E[X^2] grows as h^-3, L^2 as h^-2
        assert relative[sampling][2] / relative[sampling][1] == pytest.approx(10, rel=0.15)


def test_limits():
    ray = Ray((0, 0, 0), Z, 4.0)
    for sampling in SAMPLINGS:
        on_ray = single_scattering_variance(Medium(0.1, 0.2), ray, PointLight((0, 0, 2.0), 1.0), sampling)
        assert on_ray.value == np.inf
        no_scattering = single_scattering_variance(Medium(0.1, 0.0), ray, PointLight((0, 1.0, 2.0), 1.0), sampling)
        assert no_scattering.value == no_scattering.error == 0
        assert airlight_second_moment(0.5, 1.0, 2.0, 2.0, None, sampling).value == 0
        behind = airlight_second_moment(0.5, [0.0, 1e-9], 1.0, 3.0, HenyeyGreenstein(0.5), sampling).value
        assert behind[0] == pytest.approx(behind[1], rel=1e-12)
    assert airlight_second_moment(0.0, 1.0, -1.0, 1.0, None, "free-path").value == np.inf
    flat = airlight_second_moment(0.0, 1.0, -1.0, 1.0, None, "distance").value
    assert flat == pytest.approx(airlight_second_moment(0.0, 1.0, -1.0, 1.0, None, "uniform").value, rel=1e-13)


def test_channels_and_refusals():
    rays, light = Ray(np.zeros((2, 3)), Z, 1.0), PointLight((0, 1, 0.5), (1.0, 2.0, 3.0))
    assert single_scattering_variance(Medium(0.1, 0.2), rays, light, "uniform").value.shape == (2, 3)
    endless = Ray((0, 0, 0), Z)
    with pytest.raises(UnsupportedError, match="no density on an infinite segment"):
        single_scattering_variance(Medium(0.1, 0.2), endless, light, "uniform")
    with pytest.raises(InvalidValueError, match="sampling must be one of equiangular, free-path"):
        airlight_second_moment(1.0, 1.0, 0.0, 1.0, None, "exponential")
    with pytest.raises(InvalidValueError, match="b must be >= a"):
        airlight_second_moment(1.0, 1.0, 0.0, -1.0)
    with pytest.raises(InvalidValueError, match="sigma_t must be finite and >= 0"):
        airlight_second_moment(-1.0, 1.0, 0.0, 1.0)
