"""Invariant: the optical thickness of every medium is the integral of its extinction within the stated error, against
exact rational arithmetic or 60 digits; and its inverse inverts it."""

import media_truth as truth
import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from media_truth import exact, within

from fogproof.analytic import (
    free_path,
    optical_thickness,
    transmittance,
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

STRICT = {"over": "raise", "invalid": "raise", "divide": "raise"}
components = st.one_of(
    st.just(0.0),
    st.floats(-4, 4).filter(lambda x: x == 0 or abs(x) > 1e-90),  # what counts as 0 has a test of its own
    st.floats(-90, 2).map(lambda x: -(10.0**x)),
)
vectors = st.tuples(components, components, components)
directions = vectors.filter(lambda v: np.linalg.norm(v) > 1e-3).map(lambda v: tuple(np.array(v) / np.linalg.norm(v)))
lengths = st.one_of(st.just(np.inf), st.floats(-6, 2).map(lambda x: 10.0**x))
seeds = st.integers(0, 2**32 - 1)


def check(medium, ray, tau, relative=None):
    """Thickness and transmittance keep their promise; `relative` bounds the promise itself where it can."""
    with np.errstate(**STRICT):
        thickness, survived = optical_thickness(medium, ray), transmittance(medium, ray)
    with mp.workdps(truth.DIGITS):
        tau = exact(tau)
        within(thickness, tau)
        within(survived, mp.exp(-tau) if tau != mp.inf else mp.mpf(0))
    if relative is not None and mp.mpf(1e-280) < tau < mp.inf:
        assert thickness.error <= relative * thickness.value
    return thickness


@given(st.floats(-3, 3), vectors, vectors, directions, lengths)
def test_linear(sigma_0, gradient, origin, direction, s):
    ray = Ray(origin, direction, s)
    tau = truth.linear_tau(sigma_0, gradient, ray.origin, ray.direction, s)
    check(LinearMedium(sigma_0, gradient), ray, tau)


@given(st.floats(0.1, 3), st.floats(-3, 3), st.floats(0, 30), st.floats(-6, 2))
def test_linear_is_accurate_where_it_is_well_conditioned(sigma_0, slope, depth, log_s):
    ray = Ray((0, 0, -depth), (0, 0, 1), 10.0**log_s)
    tau = truth.linear_tau(sigma_0, (0, 0, slope), ray.origin, ray.direction, 10.0**log_s)
    check(LinearMedium(sigma_0, (0, 0, slope)), ray, tau, 1e-14)


@given(st.one_of(st.just(0.0), st.floats(-8, 3).map(lambda x: 10.0**x)), vectors, vectors, directions, lengths)
def test_exponential(sigma_0, rate, origin, direction, s):
    ray = Ray(origin, direction, s)
    tau = truth.exponential_tau(sigma_0, rate, ray.origin, ray.direction, s)
    if tau == mp.inf or tau < 1e300:
        check(ExponentialMedium(sigma_0, rate), ray, tau, 1e-14)


@given(seeds, st.integers(1, 6), vectors, directions, lengths, st.booleans())
def test_layers(seed, n, origin, direction, s, endless):
    rng = np.random.default_rng(seed)
    boundaries = np.sort(rng.normal(size=n + 1))
    sigma_t = rng.exponential(size=n) * (rng.random(n) < 0.8)
    if endless:
        boundaries[0] = -np.inf
    medium, ray = PiecewiseConstantMedium(boundaries, sigma_t), Ray(origin, direction, s)
    tau = truth.Fraction(0)
    for low, high, sigma in zip(boundaries[:-1], boundaries[1:], sigma_t, strict=True):
        bounds = [[None if np.isinf(b) else truth.Fraction(b)] for b in (low, high)]
        found = truth.overlap(*bounds, truth.fractions(origin[2:]), truth.fractions(ray.direction[2:]), s)
        if found and sigma:
            tau = (
                tau + truth.Fraction(sigma) * (found[1] - found[0])
                if found[1] is not None and tau != mp.inf
                else mp.inf
            )
    check(medium, ray, tau, 1e-15)


@pytest.mark.parametrize("interpolation", ["nearest", "trilinear"])
@given(seed=seeds, origin=vectors, direction=directions, s=lengths)
def test_voxels(interpolation, seed, origin, direction, s):
    """Every cell clipped alone in exact fractions, against all crossings sorted at once."""
    rng = np.random.default_rng(seed)
    shape = rng.integers(1, 5, size=3)
    sigma_t = rng.exponential(size=shape) * (rng.random(shape) < 0.8) * 10.0 ** rng.integers(-3, 3)
    lower = np.round(rng.normal(size=3), rng.integers(0, 4))
    upper = lower + rng.integers(1, 4, size=3)
    ray = Ray(origin, direction, s)
    integral = truth.nearest_tau if interpolation == "nearest" else truth.trilinear_tau
    tau = integral(sigma_t, lower, upper, ray.origin, ray.direction, s)
    # A direction of 1e-300 along an axis meets its planes at an unknown place; the error says so, and is not small.
    meets = np.abs(ray.direction)[ray.direction != 0].min()
    check(VoxelGrid(sigma_t, lower, upper, interpolation), ray, tau, 1e-14 if meets > 1e-12 else None)


@pytest.mark.parametrize("interpolation", ["nearest", "trilinear"])
@pytest.mark.parametrize("distance", [0.0, 1e3, 1e9])
def test_voxels_from_far_away(interpolation, distance):
    """The camera's distance costs nothing, although a float64 position out there is good to 1e-7 only."""
    rng = np.random.default_rng(7)
    sigma_t = rng.exponential(size=(3, 4, 5))
    direction = np.array([2.0, -1.0, 2.0]) / 3
    origin = np.array([0.5, 2.0, 0.25]) - distance * direction
    integral = truth.nearest_tau if interpolation == "nearest" else truth.trilinear_tau
    ray = Ray(origin, direction)
    tau = integral(sigma_t, (0, 0, 0), (1, 2, 1), ray.origin, ray.direction, np.inf)
    assert tau > 0
    check(VoxelGrid(sigma_t, (0, 0, 0), (1, 2, 1), interpolation), ray, tau, 1e-14)


@pytest.mark.parametrize(
    ("origin", "direction", "tau"),
    [
        ((-1.0, 1.0, 0.5), (1.0, 0.0, 0.0), 4.0),  # inside the plane between the voxels: the upper one
        ((-1.0, 2.0, 0.5), (1.0, 0.0, 0.0), 0.0),  # inside the upper face: vacuum
        ((-1.0, 0.0, 0.5), (1.0, 0.0, 0.0), 2.0),  # inside the lower face: the voxel above it
        ((0.5, -1.0, 0.5), (0.0, 1.0, 0.0), 6.0),
        ((0.5, 3.0, 0.5), (0.0, -1.0, 0.0), 6.0),
        ((0.5, 3.0, 0.5), (0.0, 1.0, 0.0), 0.0),  # behind the camera
        ((-1.0, 1.0, -1e-200), (1.0, 0.0, 0.0), 0.0),  # hardly outside
        ((-1.0, 1.0, 1e-200), (1.0, 0.0, 0.0), 4.0),  # hardly inside
    ],
)
def test_voxels_along_their_faces(origin, direction, tau):
    grid = VoxelGrid(np.array([[[2.0], [4.0]]]), (0, 0, 0), (1, 2, 1), "nearest")
    with np.errstate(**STRICT):
        assert optical_thickness(grid, Ray(origin, direction)).value == tau


def test_components_below_1e_100_count_as_zero():
    ray, exact_ray = Ray((0, 0, 0), (1, 1e-150, 0)), Ray((0, 0, 0), (1, 0, 0))
    assert optical_thickness(LinearMedium(0.0, (1e-150, 0, 0)), exact_ray).value == 0
    for medium in (LinearMedium(0.0, (0, 1, 0)), VoxelGrid(np.ones((2, 2, 2)), (-1, 0, 0), (1, 1, 1), "nearest")):
        assert optical_thickness(medium, ray).value == optical_thickness(medium, exact_ray).value


@given(seeds, directions, st.floats(-3, 3).map(lambda x: 10.0**x))
def test_anisotropic(seed, direction, s):
    A = np.random.default_rng(seed).normal(size=(3, 3))
    S = A @ A.T
    S = (S + S.T) / 2
    ray = Ray((0, 0, 0), direction, s)
    with mp.workdps(truth.DIGITS):
        w = ray.direction
        square = sum(exact(w[i]) * exact(S[i, j]) * exact(w[j]) for i in range(3) for j in range(3))
        check(AnisotropicMedium(0.7, S), ray, exact(0.7) * mp.sqrt(square) * exact(s), 1e-15)


@pytest.mark.parametrize(
    ("mode", "factor"),
    [
        ("exp", lambda d, a, b, s: mp.exp(-d * s)),
        ("exp2", lambda d, a, b, s: mp.exp(-((d * s) ** 2))),
        ("linear", lambda d, a, b, s: min(mp.mpf(1), max(mp.mpf(0), (b - s) / (b - a)))),
    ],
)
@given(density=st.floats(0, 3), start=st.floats(0, 5), size=st.floats(0.01, 20), s=st.floats(1e-6, 30))
def test_opengl_fog_factor(mode, factor, density, start, size, s):
    fog = OpenGLFog(mode, density, start, start + size, eye=(1, 2, 3))
    with np.errstate(**STRICT):
        survived = transmittance(fog, Ray((1, 2, 3), (0, 0.6, 0.8), s))
    with mp.workdps(truth.DIGITS):
        within(survived, factor(*map(exact, (fog.density, fog.start, fog.end, s))))


def test_opengl_linear_fog_of_the_textbook():
    survived = transmittance(OpenGLFog("linear", start=2, end=10), Ray((0, 0, 0), (0, 0, 1), [1.0, 7.0, 10.0, np.inf]))
    assert np.allclose(survived.value, [1.0, 0.375, 0.0, 0.0], rtol=4e-16, atol=0)


@pytest.mark.parametrize("mode", ["exp", "exp2", "linear"])
def test_opengl_fog_is_a_medium_for_rays_from_anywhere(mode):
    fog = OpenGLFog(mode, 0.7, 0.4, 3.0, eye=(0.1, 0.0, 0.2))
    ray = Ray((-0.5, 0.3, -1.2), (0.0, 0.6, 0.8), 2.1)

    def sigma(t):
        r = mp.sqrt(sum((mp.mpf(float(o + 0.0)) + t * mp.mpf(float(w)) - mp.mpf(float(e))) ** 2
                        for o, w, e in zip(ray.origin, ray.direction, fog.eye, strict=True)))  # fmt: skip
        return {"exp": mp.mpf(0.7), "exp2": 2 * mp.mpf(0.7) ** 2 * r}.get(mode) or (
            1 / (3 - r) if r > mp.mpf(0.4) else mp.mpf(0)
        )

    with mp.workdps(30):
        check(fog, ray, mp.quad(sigma, mp.linspace(0, mp.mpf(2.1), 12)), 1e-11)
    beyond = optical_thickness(fog, Ray((-0.5, 0.3, -1.2), (0.0, 0.6, 0.8)))
    assert beyond.value == np.inf
    if mode == "linear":  # what enters the end of the fog does not come out
        assert optical_thickness(fog, Ray((0, 0, -9), (0, 0, 1), 7.0)).value == np.inf


PROCEDURAL = {
    "polynomial": (lambda x: x[..., 2] ** 2, lambda t: t**3 / 3, {}),
    "waves": (lambda x: 1 + np.sin(9 * x[..., 2]), lambda t: t + (1 - mp.cos(9 * t)) / 9, {}),
    "peak": (
        lambda x: np.exp(-((8 * x[..., 2] - 4) ** 2)),
        lambda t: (mp.erf(8 * t - 4) + mp.erf(4)) * mp.sqrt(mp.pi) / 16,
        {},
    ),
    "step": (lambda x: 1.0 * (x[..., 2] > 0.3), lambda t: max(t - mp.mpf(0.3), 0), {}),
    "cusp": (lambda x: np.sqrt(np.abs(x[..., 2])), lambda t: 2 * t ** mp.mpf(1.5) / 3, {}),
    "box": (lambda x: 2 + 0 * x[..., 2], lambda t: 2 * min(t, mp.mpf(0.5)), {"upper": (np.inf, np.inf, 0.5)}),
    "narrow": (
        lambda x: np.exp(-((1000 * x[..., 2] - 333) ** 2)),
        lambda t: (mp.erf(1000 * t - 333) + mp.erf(333)) * mp.sqrt(mp.pi) / 2000,
        {"detail": 0.01},
    ),
}


@pytest.mark.parametrize("name", PROCEDURAL)
@pytest.mark.parametrize("s", [1e-3, 0.37, 1.0, 2.0])
def test_procedural(name, s):
    """Smooth, kinked and discontinuous functions, none of which the quadrature is told anything about."""
    function, integral, options = PROCEDURAL[name]
    medium, ray = Procedural(function, majorant=4.0, **options), Ray((0, 0, 0), (0, 0, 1), s)
    with mp.workdps(truth.DIGITS):
        thickness = check(medium, ray, integral(exact(s)))
    if thickness.value == 0 and "detail" not in options:  # no node saw anything: the majorant alone bounds the rest
        assert np.isclose(thickness.error, 4.0 * s)
    else:
        assert thickness.error <= 1e-11 * thickness.value + 1e-17


def test_directional_extinction():
    S = np.diag([1.0, 4.0, 9.0])

    def flakes(x, w):
        return 0.3 * np.sqrt(np.sum(w * w * [1.0, 4.0, 9.0], axis=-1)) + 0 * x[..., 0]

    rng = np.random.default_rng(3)
    w = rng.normal(size=(20, 3))
    ray = Ray(rng.normal(size=(20, 3)), w / np.linalg.norm(w, axis=-1, keepdims=True), rng.exponential(size=20))
    closed = optical_thickness(AnisotropicMedium(0.3, S), ray)
    summed = optical_thickness(Procedural(flakes, majorant=1.0, directional=True), ray)
    assert (np.abs(closed.value - summed.value) <= closed.error + summed.error).all()
    assert len(np.unique(closed.value / ray.length)) == 20


@pytest.mark.parametrize(
    ("function", "argument", "rule"),
    [
        (lambda x: 5 + 0 * x[..., 0], "sigma_t", "majorant"),
        (lambda x: -x[..., 2], "sigma_t", "majorant"),
        (lambda x: np.full(x.shape[:-1], np.nan), "sigma_t", "majorant"),
        (lambda x: x, "sigma_t", "shape"),
        (lambda x: "thick", "sigma_t", "number"),
    ],
)
def test_a_bad_function_is_named(function, argument, rule):
    with pytest.raises(InvalidValueError, match=rule) as raised:
        optical_thickness(Procedural(function, majorant=2.0), Ray((0, 0, 0), (0, 0, 1), 1.0))
    assert raised.value.argument == argument


def test_an_infinite_ray_needs_an_end():
    function = lambda x: np.exp(-(x[..., 2] ** 2))  # noqa: E731
    with pytest.raises(UnsupportedError, match="infinite ray"):
        optical_thickness(Procedural(function, majorant=1.0), Ray((0, 0, 0), (0, 0, 1)))
    box = Procedural(function, majorant=1.0, lower=(-1, -1, -1), upper=(1, 1, 1))
    with mp.workdps(truth.DIGITS):
        check(box, Ray((0, 0, -5), (0, 0, 1)), mp.erf(1) * mp.sqrt(mp.pi), 1e-13)


@given(st.floats(-3, 3), vectors, vectors, directions, st.floats(-12, 3).map(lambda x: 10.0**x))
def test_linear_free_path(sigma_0, gradient, origin, direction, tau):
    ray = Ray(origin, direction)
    with np.errstate(**STRICT):
        found = free_path(LinearMedium(sigma_0, gradient), ray, tau)
    with mp.workdps(900):
        a = exact(truth.Fraction(sigma_0) + truth.dot(gradient, ray.origin))
        b = exact(truth.dot(gradient, ray.direction))
        square = max(a, mp.mpf(0)) ** 2 + 2 * b * exact(tau)
        if (a <= 0 and b <= 0) or square < 0 or (b == 0 and a <= 0):
            t = mp.inf
        elif b == 0:
            t = exact(tau) / a
        else:
            t = (mp.sqrt(square) - a) / b
        within(found, t)


@given(st.floats(-8, 3), vectors, vectors, directions, st.floats(-12, 3).map(lambda x: 10.0**x))
def test_exponential_free_path(log_sigma, rate, origin, direction, tau):
    ray, sigma_0 = Ray(origin, direction), 10.0**log_sigma
    with np.errstate(**STRICT):
        found = free_path(ExponentialMedium(sigma_0, rate), ray, tau)
    with mp.workdps(900):
        e, k = exact(truth.dot(rate, ray.origin)), exact(truth.dot(rate, ray.direction))
        q = exact(tau) / (exact(sigma_0) * mp.exp(e))
        t = q if k == 0 else mp.inf if k * q <= -1 else mp.log(1 + k * q) / k
        if t == mp.inf or t < 1e300:
            within(found, t)


MEDIA = [Medium(0.2, 0.5), LinearMedium(1.0, (0.1, 0, -0.02)), ExponentialMedium(0.5, (0, 0.1, -0.2), albedo=0.5)]


@pytest.mark.parametrize("medium", MEDIA, ids=lambda m: type(m).__name__)
def test_free_path_inverts_thickness(medium):
    rng = np.random.default_rng(11)
    w = rng.normal(size=(40, 3))
    w /= np.linalg.norm(w, axis=-1, keepdims=True)
    s = 10.0 ** rng.uniform(-4, 0.5, size=40)
    thickness = optical_thickness(medium, Ray(np.zeros(3), w, s))
    found = free_path(medium, Ray(np.zeros(3), w), thickness.value)
    assert np.allclose(found.value, s, rtol=1e-14, atol=0)
    assert np.isinf(free_path(medium, Ray(np.zeros(3), w, s), 2 * thickness.value).value).all()
    assert (free_path(medium, Ray(np.zeros(3), w, s), 0.0).value == 0).all()


BRACKETED = {
    "layers": (PiecewiseConstantMedium([-1, 0.2, 1, 4], [1.0, 0.0, 3.0]), 1e-14),
    "nearest": (VoxelGrid(np.arange(8.0).reshape(2, 2, 2), (-1, -1, -1), (1, 1, 5), "nearest"), 1e-14),
    "trilinear": (VoxelGrid(np.arange(1.0, 9.0).reshape(2, 2, 2), (-1, -1, -1), (1, 1, 5)), 1e-13),
    "anisotropic": (AnisotropicMedium(1.0, np.diag([1.0, 0.2, 3.0])), 1e-14),
    "procedural": (Procedural(lambda x: 1 + np.sin(x[..., 2]), majorant=2.0, detail=1.0), 1e-11),
}


@pytest.mark.parametrize("name", BRACKETED)
def test_free_path_without_a_closed_form_is_enclosed(name):
    medium, tight = BRACKETED[name]
    direction = np.array([0.1, 0.2, np.sqrt(0.95)])
    for t in (0.15, 1.1, 2.9):
        tau = optical_thickness(medium, Ray((0, 0, 0), direction, t))
        found = free_path(medium, Ray((0, 0, 0), direction, 3.5), tau.value)
        # In vacuum a thickness has many places; the first one counts, which the thickness there tells.
        again = optical_thickness(medium, Ray((0, 0, 0), direction, float(found.value)))
        assert found.value <= t + found.error + 1e-15
        assert abs(again.value - tau.value) <= 9.0 * found.error + tau.error + again.error
        assert found.error <= tight * t
    longer = optical_thickness(medium, Ray((0, 0, 0), direction, 3.5)).value * 1.01
    assert free_path(medium, Ray((0, 0, 0), direction, 3.5), longer).value == np.inf
    assert free_path(medium, Ray((0, 0, 0), direction, 3.5), 0.0).value == 0


def test_free_path_of_an_endless_ray_is_searched_for():
    flakes = AnisotropicMedium(1e-4, np.eye(3))
    found = free_path(flakes, Ray((0, 0, 0), (0, 0, 1)), 5.0)
    assert abs(found.value - 5e4) <= found.error <= 1e-10
    layers = PiecewiseConstantMedium([0, 1, 2], [1.0, 2.0])
    assert free_path(layers, Ray((0, 0, 0), (0, 0, 1)), 3.5).value == np.inf
    assert abs(free_path(layers, Ray((0, 0, 0), (0, 0, 1)), 2.0).value - 1.5) <= 1e-15


def test_free_path_refuses_a_negative_thickness():
    with pytest.raises(InvalidValueError, match="tau"):
        free_path(Medium(1.0, 0.0), Ray((0, 0, 0), (0, 0, 1)), -1.0)


CHANNELS = {
    "linear": LinearMedium((1.0, 2.0), [(0, 0, 0.1), (0, 0.2, 0)]),
    "linear, grey gradient": LinearMedium((1.0, 2.0), (0, 0, 0.1)),
    "exponential": ExponentialMedium(1.0, [(0, 0, 0.1), (0, 0.2, 0)]),
    "layers": PiecewiseConstantMedium([-1, 0.2, 1], [(1.0, 2.0), (3.0, 0.0)]),
    "nearest": VoxelGrid(np.arange(16.0).reshape(2, 2, 2, 2), (-1, -1, -1), (1, 1, 1), "nearest"),
    "trilinear": VoxelGrid(np.arange(16.0).reshape(2, 2, 2, 2), (-1, -1, -1), (1, 1, 1)),
    "grey grid, coloured emission": VoxelGrid(
        np.ones((2, 2, 2)), (-1, -1, -1), (1, 1, 1), emission=np.ones((2, 2, 2, 2))
    ),
    "anisotropic": AnisotropicMedium((1.0, 2.0), np.eye(3)),
    "procedural": Procedural(lambda x: x[..., :2] ** 2, majorant=10.0, channels=2),
    "opengl": OpenGLFog("exp2", eye=(0.1, 0.2, -0.7), albedo=(0.5, 1.0)),
}


@pytest.mark.parametrize("name", CHANNELS)
def test_channels_come_last(name):
    medium, w = CHANNELS[name], np.array([(0, 0, 1.0), (0, 0.6, 0.8), (0.6, 0, 0.8)])
    ray = Ray((0.1, 0.2, -0.7), np.broadcast_to(w, (4, 3, 3)), np.array([[0.1], [0.5], [1.0], [2.0]]))
    thickness = optical_thickness(medium, ray)
    assert thickness.value.shape == thickness.error.shape == (4, 3, 2)
    one = optical_thickness(medium, Ray(ray.origin[2, 1], ray.direction[2, 1], ray.length[2, 1]))
    assert np.array_equal(one.value, thickness.value[2, 1])
    empty = optical_thickness(medium, Ray(np.zeros((0, 3)), np.ones((0, 3)), np.ones(0)))
    assert empty.value.shape == (0, 2)
