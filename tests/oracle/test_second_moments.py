"""Invariant: the stated variance and cost of every tracker are what a tracker has, in homogeneous and other media: within
the stated error of the integrals in 60 digits, and of a simulation that shares nothing with the formulas."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import DIGITS, exact, within

from fogproof.analytic import (
    ambient_fog_variance,
    transmittance,
    transmittance_lookups,
    transmittance_second_moment,
    transmittance_variance,
)
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    VoxelGrid,
)

EPS = 2.0**-52
Z = (0.0, 0.0, 1.0)
sigmas = st.one_of(st.just(0.0), st.floats(-9, 2.5).map(lambda e: 10.0**e))
rates = st.floats(-9, 3).map(lambda e: 10.0**e)
lengths = st.floats(-6, 2).map(lambda e: 10.0**e)


def moment(p, sigma, majorant, control, s):
    """E[w^p] of a Poisson product along a homogeneous ray."""
    return mp.exp(-s * (p * control + majorant * (1 - (1 - (sigma - control) / majorant) ** p)))


@settings(max_examples=400, deadline=None)
@given(sigma_a=sigmas, sigma_s=sigmas, majorant=rates, control=sigmas, s=lengths)
def test_homogeneous(sigma_a, sigma_s, majorant, control, s):
    medium, ray = Medium(sigma_a, sigma_s), Ray((0, 0, 0), Z, s)
    with mp.workdps(DIGITS + 400):
        sigma, mu, s_ = exact(sigma_a) + exact(sigma_s), exact(majorant), exact(s)
        T = mp.exp(-sigma * s_)
        for c, tracking in ((0.0, "ratio"), (control, "residual-ratio")):
            second = moment(2, sigma, mu, exact(c), s_)
            variance = second - T**2
            if second > mp.mpf(1e300):
                continue
            within(transmittance_second_moment(medium, ray, tracking, majorant, c), second)
            result = transmittance_variance(medium, ray, tracking, majorant, c)
            within(result, variance)
            if variance > 1e-280:
                condition = 1 + sigma * s_ + (sigma - exact(c)) ** 2 / mu * s_
                assert result.error <= 40 * EPS * condition * variance
            lookups = transmittance_lookups(medium, ray, tracking, majorant, c)
            within(lookups, mu * s_)
        within(transmittance_variance(medium, ray, "delta"), T * (1 - T))
        within(transmittance_second_moment(medium, ray, "delta"), T)
        bound = float(2 * (sigma_a + sigma_s) + 1)
        expected = exact(bound) * ((1 - T) / sigma if sigma else s_)
        within(transmittance_lookups(medium, ray, "delta", bound), expected)


def test_ratio_tracking_never_loses_to_delta_with_a_bounding_majorant():
    medium, ray = Medium(0.0, [0.1, 1.0, 3.0]), Ray((0, 0, 0), Z, [[0.1], [1.0], [10.0]])
    delta = transmittance_variance(medium, ray, "delta").value
    for majorant in (3.0, 4.0, 100.0):
        assert (transmittance_variance(medium, ray, "ratio", majorant).value < delta * (1 + 1e-12)).all()
    same = transmittance_variance(Medium(0.0, 3.0), ray, "ratio", 3.0).value
    assert same == pytest.approx(transmittance_variance(Medium(0.0, 3.0), ray, "delta").value, rel=1e-13)


def test_a_control_equal_to_the_extinction_leaves_no_variance():
    assert transmittance_variance(Medium(0.2, 0.3), Ray((0, 0, 0), Z, 2.0), "residual-ratio", 1.0, 0.5).value == 0


@pytest.mark.parametrize("excess", [1e-9, 0.03])
def test_delta_tracking_with_a_majorant_that_is_exceeded_has_no_moments(excess):
    medium, ray = Medium(0.2, 0.3), Ray((0, 0, 0), Z, 2.0)
    assert transmittance_variance(medium, ray, "delta", 0.5).value > 0
    with pytest.raises(InvalidValueError, match="delta tracking is biased there"):
        transmittance_variance(medium, ray, "delta", 0.5 / (1 + excess))
    assert transmittance_variance(medium, ray, "ratio", 0.5 / (1 + excess)).value > 0


def test_limits():
    ray = Ray((0, 0, 0), Z, np.inf)
    assert transmittance_variance(Medium(0.0, 0.0), ray, "ratio", 1.0).value == 0
    assert transmittance_variance(Medium(0.0, 0.5), ray, "ratio", 1.0).value == 0
    assert transmittance_variance(Medium(0.0, 0.5), ray, "delta", 1.0).value == 0
    assert transmittance_lookups(Medium(0.0, 0.5), ray, "delta", 1.0).value == 2
    assert transmittance_lookups(Medium(0.0, 0.5), ray, "ratio", 1.0).value == np.inf
    assert transmittance_lookups(Medium(0.0, 0.0), ray, "delta", 1.0).value == np.inf
    # A majorant below half the extinction lets the weights grow: the variance is finite for every length, not for none.
    assert transmittance_second_moment(Medium(0.0, 1.0), ray, "ratio", 0.4).value == np.inf
    assert transmittance_second_moment(Medium(0.0, 1.0), ray, "ratio", 0.5).value == 1
    assert transmittance_variance(Medium(0.0, 1.0), Ray((0, 0, 0), Z, 1e6), "ratio", 0.4).value == np.inf


def trilinear_column(grid, x, y, z):
    """sigma_t of a trilinear grid over the unit cube, at (x, y, z), in mpmath."""
    total = mp.mpf(0)
    n = grid.shape
    for i in range(n[0]):
        for j in range(n[1]):
            for k in range(n[2]):
                weight = mp.mpf(1)
                for c, index, size in ((x, i, n[0]), (y, j, n[1]), (z, k, n[2])):
                    place = min(max(mp.mpf(c) * size - mp.mpf(1) / 2, mp.mpf(0)), mp.mpf(size - 1))
                    weight *= max(mp.mpf(0), 1 - abs(place - index))
                total += weight * mp.mpf(float(grid[i, j, k]))
    return total


GRID = np.array([[[0.5, 2.0, 1.0, 0.0], [1.5, 0.0, 3.0, 1.0]], [[0.0, 1.0, 2.5, 2.0], [0.25, 0.5, 4.0, 1.0]]])
LAYERS = [-0.5, 0.25, 1.0, 1.5]
SLANT = (0.6, 0.0, 0.8)

# medium, origin, direction, length, sigma_t(t) in mpmath, its breaks
HETEROGENEOUS = {
    "linear": (
        LinearMedium(-0.3, (0, 0, 0.7)),
        (0, 0, 0),
        Z,
        2.0,
        lambda t: max(mp.mpf(0), mp.mpf(-0.3) + mp.mpf(0.7) * t),
        [mp.mpf(0.3) / mp.mpf(0.7)],
    ),
    "exponential": (
        ExponentialMedium(1.5, (0, 0, -0.8)),
        (0, 0, 0),
        SLANT,
        3.0,
        lambda t: mp.mpf(1.5) * mp.exp(-mp.mpf(0.8) * mp.mpf(0.8) * t),
        [],
    ),
    "layers": (
        PiecewiseConstantMedium(LAYERS, [0.5, 2.0, 1.0]),
        (0, 0, -1.0),
        Z,
        3.0,
        lambda t: [mp.mpf(0), mp.mpf(0.5), mp.mpf(2), mp.mpf(1), mp.mpf(0)][sum(t - 1 >= b for b in LAYERS)],
        [0.5, 1.25, 2.0, 2.5],
    ),
    "nearest": (
        VoxelGrid(GRID, (0, 0, 0), (1, 1, 1), "nearest"),
        (0.3, 0.7, -0.5),
        Z,
        2.0,
        lambda t: mp.mpf(float(GRID[0, 1, int((t - 0.5) * 4)])) if 0.5 <= t < 1.5 else mp.mpf(0),
        [0.5, 0.75, 1.0, 1.25, 1.5],
    ),
    "trilinear": (
        VoxelGrid(GRID, (0, 0, 0), (1, 1, 1)),
        (0.375, 0.625, -0.5),
        Z,
        2.0,
        lambda t: trilinear_column(GRID, 0.375, 0.625, t - 0.5) if 0.5 <= t < 1.5 else mp.mpf(0),
        [0.5, 0.625, 0.875, 1.125, 1.375, 1.5],
    ),
    "anisotropic": (
        AnisotropicMedium(2.0, np.diag([1.0, 1.0, 0.25])),
        (0, 0, 0),
        SLANT,
        1.5,
        lambda t: 2 * mp.sqrt(mp.mpf(0.6) ** 2 + mp.mpf(0.8) ** 2 / 4),
        [],
    ),
    "fog exp": (OpenGLFog("exp", density=0.7), (0, 0, 0), Z, 1.3, lambda t: mp.mpf(0.7), []),
    "fog exp2": (OpenGLFog("exp2", density=0.7), (0, 0, 0), Z, 1.3, lambda t: 2 * mp.mpf(0.7) ** 2 * t, []),
    "fog linear": (
        OpenGLFog("linear", start=0.5, end=3.0),
        (0, 0, 0),
        Z,
        2.0,
        lambda t: 1 / (3 - t) if t > 0.5 else mp.mpf(0),
        [0.5],
    ),
    "procedural": (
        Procedural(lambda x: 1 + np.sin(3 * x[..., 2]), 2.0),
        (0, 0, 0),
        Z,
        2.0,
        lambda t: 1 + mp.sin(3 * t),
        [],
    ),
}


@pytest.mark.parametrize("name", HETEROGENEOUS)
def test_heterogeneous(name):
    medium, origin, direction, s, sigma, breaks = HETEROGENEOUS[name]
    ray, mu, c = Ray(origin, direction, s), 2.5, 0.75
    with mp.workdps(30):
        points = [mp.mpf(0), *(mp.mpf(b) for b in breaks if b < s), mp.mpf(s)]
        tau = mp.quad(sigma, points)
        if isinstance(medium, VoxelGrid):  # trackers, and their control with them, stay in the box
            points = [b for b in points if 0.5 <= b <= 1.5]
        for control, tracking in ((0.0, "ratio"), (c, "residual-ratio")):
            V = mp.quad(lambda t, k=control: (sigma(t) - k) ** 2, points) / mp.mpf(mu)
            second, variance = mp.exp(V - 2 * tau), mp.exp(-2 * tau) * mp.expm1(V)
            for reference, truth in (
                (transmittance_second_moment(medium, ray, tracking, mu, control), second),
                (transmittance_variance(medium, ray, tracking, mu, control), variance),
            ):
                assert abs(mp.mpf(float(reference.value)) - truth) <= float(reference.error) + mp.mpf(10) ** -25
                assert reference.error <= 1e-11 * truth
        delta = transmittance_variance(medium, ray, "delta")
        truth = mp.exp(-tau) * (1 - mp.exp(-tau))
        assert abs(mp.mpf(float(delta.value)) - truth) <= float(delta.error) + mp.mpf(10) ** -25


def simulate(sigma, s, majorant, control, rng, n):
    """Delta and (residual) ratio tracking as they are written on slides; returns (score, weight, delta's look-ups)."""
    t, weight, looked = np.zeros(n), np.exp(-control * s) * np.ones(n), np.zeros(n)
    survived, flying = np.ones(n, bool), np.ones(n, bool)
    while flying.any():
        t[flying] -= np.log1p(-rng.random(flying.sum())) / majorant
        flying &= t < s
        here = np.where(flying, sigma(t), 0.0)
        weight = np.where(flying, weight * (1 - (here - control) / majorant), weight)
        looked += flying & survived
        survived &= ~(flying & (rng.random(n) < here / majorant))
    return survived.astype(float), weight, looked


def assert_mean(samples, expected, what):
    """A z-test with a false-alarm probability of 1e-9."""
    error = samples.std(ddof=1) / np.sqrt(samples.size)
    assert abs(samples.mean() - expected) < 6.1 * error, (what, samples.mean(), expected, error)


SIMULATED = {
    "homogeneous": (Medium(0.3, 0.5), lambda t: np.full_like(t, 0.8)),
    "linear": (HETEROGENEOUS["linear"][0], lambda t: np.maximum(0, -0.3 + 0.7 * t)),
    "layers": (
        PiecewiseConstantMedium([0.0, 0.5, 1.5, 4.0], [0.5, 2.0, 0.1]),
        lambda t: np.where(t < 0.5, 0.5, np.where(t < 1.5, 2.0, 0.1)),
    ),
}


@pytest.mark.parametrize("name", SIMULATED)
def test_simulation(name):
    seed = 20250611
    print("seed", seed)
    rng = np.random.default_rng(seed)
    medium, sigma = SIMULATED[name]
    s, majorant, n = 2.0, 2.25, 400_000
    ray = Ray((0, 0, 0), Z, s)
    T = float(transmittance(medium, ray).value)
    for control, tracking in ((0.0, "ratio"), (0.6, "residual-ratio")):
        survived, weight, looked = simulate(sigma, s, majorant, control, rng, n)
        assert_mean(weight, T, tracking)
        expected = transmittance_variance(medium, ray, tracking, majorant, control).value
        assert_mean((weight - T) ** 2, expected, tracking)
    assert_mean((survived - T) ** 2, transmittance_variance(medium, ray, "delta", majorant).value, "delta")
    assert_mean(looked, transmittance_lookups(medium, ray, "delta", majorant).value, "look-ups")


def test_channels_and_shapes():
    ray = Ray(np.zeros((4, 1, 3)), Z, np.ones((1, 2)))
    assert transmittance_variance(Medium(0.1, 0.2), ray, "ratio", 1.0).value.shape == (4, 2)
    coloured = Medium(0.1, [0.2, 0.3, 0.4])
    for function in (transmittance_variance, transmittance_second_moment, transmittance_lookups):
        for tracking in ("delta", "ratio"):
            assert function(coloured, ray, tracking, 1.0).value.shape == (4, 2, 3)
            assert function(coloured, ray, tracking, [1.0, 2.0, 3.0]).error.shape == (4, 2, 3)
    assert transmittance_variance(Medium(0.1, 0.2), ray, "ratio", [1.0, 2.0]).value.shape == (4, 2, 2)
    assert ambient_fog_variance(Medium(0.1, 0.2), ray, [1.0, 2.0, 3.0]).value.shape == (4, 2, 3)
    assert transmittance_lookups(HETEROGENEOUS["trilinear"][0], ray, "delta", 4.0).value.shape == (4, 2)


def test_what_makes_no_sense_is_refused():
    medium, ray = Medium(0.5, 0.5), Ray((0, 0, 0), Z, 1.0)
    bad = [
        (lambda: transmittance_variance(medium, ray, "woodcock", 1.0), "tracking must be one of"),
        (lambda: transmittance_variance(medium, ray, "ratio"), "majorant must be a number"),
        (lambda: transmittance_variance(medium, ray, "ratio", 0.0), "majorant must be > 0"),
        (lambda: transmittance_variance(medium, ray, "delta", 0.9), "majorant must not lie below sigma_t"),
        (lambda: transmittance_variance(medium, ray, "delta", 1 - 1e-9), "majorant must not lie below sigma_t"),
        (
            lambda: transmittance_lookups(PiecewiseConstantMedium((0, 1, 2), (1.0, 3.0)), ray, "delta", 2.99),
            "reaches 3",
        ),
        (lambda: transmittance_lookups(HETEROGENEOUS["linear"][0], Ray((0, 0, 0), Z, 5.0), "delta", 1.0), "majorant"),
        (lambda: transmittance_variance(medium, ray, "ratio", 1.0, 0.5), "control must be 0 for ratio"),
    ]
    for call, message in bad:
        with pytest.raises(InvalidValueError, match=message):
            call()
    patchy = VoxelGrid(GRID, (0, 0, 0), (1, 1, 1), albedo=GRID / 10)
    with pytest.raises(UnsupportedError, match="constant in space"):
        ambient_fog_variance(patchy, ray)
    with pytest.raises(UnsupportedError, match="infinite"):
        transmittance_variance(OpenGLFog("linear", start=0.0, end=1.0), Ray((0, 0, 0), Z, 2.0), "ratio", 1.0)
