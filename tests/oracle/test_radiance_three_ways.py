"""Invariant: closed form, adaptive quadrature and the differential equation give the same radiance for every medium,
within their stated errors; so do exact cells, the emission of the lecture in both conventions, and the furnaces."""

from dataclasses import replace

import media_truth as truth
import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from media_truth import exact, within

from fogproof.analytic import (
    ambient_fog,
    emitted_radiance,
    optical_thickness,
    radiance_by_ode,
    radiance_by_quadrature,
    thermal_furnace,
    transmittance,
    white_furnace,
)
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
    HenyeyGreenstein,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    VoxelGrid,
)

RNG = np.random.default_rng(20)
EYE = (0.1, 0.2, -1.7)
CELLS = {
    "sigma_t": RNG.exponential(size=(3, 2, 4)),
    "lower": (-1, -1, -1),
    "upper": (1, 1, 1),
    "albedo": RNG.random((3, 2, 4)),
    "emission": RNG.random((3, 2, 4)),
}
LAYERS = {"sigma_t": [0.5, 0.0, 2.0], "albedo": [0.2, 0.5, 0.9], "emission": [1.0, 2.0, 0.5]}


def cloud(x):
    return 1.5 + np.sin(2 * x[..., 0]) * np.cos(3 * x[..., 2])


MEDIA = {
    "homogeneous": Medium(0.3, 0.8, emission=0.4),
    "empty": Medium(0.0, 0.0, emission=0.4),
    "thin": Medium(1e-9, 2e-9, emission=0.4),
    "coloured": Medium((0.3, 0.0, 2.0), 0.8, emission=(0.4, 0.1, 0.0)),
    "linear": LinearMedium(0.6, (0.1, 0.2, -0.5), albedo=0.7, emission=0.4),
    "linear channels": LinearMedium((0.6, 0.2), (0.1, 0.2, -0.5), albedo=(0.7, 0.0), emission=0.4),
    "exponential": ExponentialMedium(0.6, (0.1, 0.2, -0.5), albedo=0.7, emission=0.4),
    "layers": PiecewiseConstantMedium([-1, -0.5, 0.1, 0.9], **LAYERS),
    "tilted layers": PiecewiseConstantMedium([-np.inf, -0.5, 0.1, 0.9], axis=(0.6, 0, 0.8), **LAYERS),
    "anisotropic": AnisotropicMedium(0.8, np.diag([1.0, 2.0, 0.3]), albedo=0.6, emission=0.4),
    "nearest": VoxelGrid(**CELLS, interpolation="nearest"),
    "trilinear": VoxelGrid(**CELLS),
    "trilinear, constant source": VoxelGrid(CELLS["sigma_t"], (-1, -1, -1), (1, 1, 1), albedo=0.3, emission=0.4),
    "opengl exp": OpenGLFog("exp", 0.7, eye=EYE, albedo=0.8, emission=0.4),
    "opengl exp2": OpenGLFog("exp2", 0.7, eye=EYE, albedo=0.8, emission=0.4),
    "opengl linear": OpenGLFog("linear", start=0.5, end=3.0, eye=EYE, albedo=0.8, emission=0.4),
    "procedural": Procedural(cloud, majorant=2.5, albedo=0.3, emission=0.4),
    "procedural source": Procedural(
        cloud, majorant=2.5, albedo=lambda x: 0.5 + 0.5 * np.sin(x[..., 1]), emission=lambda x: x[..., 2] ** 2
    ),
}
W = np.array([(0, 0, 1.0), (0, 0.6, 0.8), (-0.6, 0, 0.8), (0.48, 0.36, 0.8)])
RAYS = Ray(EYE, W, [1.3, 2.0, 2.9, 2.2])


def agree(*references):
    for one in references:
        for two in references:
            off = np.abs(one.value - two.value)
            assert (off <= one.error + two.error).all(), f"{one.method} and {two.method} differ by {off}"


@pytest.mark.parametrize("name", MEDIA)
def test_fog(name):
    closed = ambient_fog(MEDIA[name], RAYS, 1.5, 0.25)
    summed = radiance_by_quadrature(MEDIA[name], RAYS, 1.5, 0.25)
    solved = radiance_by_ode(MEDIA[name], RAYS, 1.5, 0.25)
    agree(closed, summed, solved)
    assert (closed.error <= 2e-13 * closed.value).all()
    assert (solved.error <= 1e-8 * solved.value).all()


@pytest.mark.parametrize("name", MEDIA)
def test_transmittance(name):
    medium = replace(MEDIA[name], emission=0.0)
    agree(transmittance(medium, RAYS), radiance_by_quadrature(medium, RAYS, 0, 1), radiance_by_ode(medium, RAYS, 0, 1))


@pytest.mark.parametrize("times_sigma_a", [True, False])
@pytest.mark.parametrize("name", MEDIA)
def test_emission(name, times_sigma_a):
    medium = MEDIA[name]
    found = emitted_radiance(medium, RAYS, times_sigma_a=times_sigma_a)
    agree(
        found,
        radiance_by_quadrature(medium, RAYS, times_sigma_a=times_sigma_a),
        radiance_by_ode(medium, RAYS, times_sigma_a=times_sigma_a),
    )
    assert (found.error <= 2e-13 * found.value + 1e-300).all()


@pytest.mark.parametrize("name", [name for name in MEDIA if not name.startswith("opengl")])
def test_multiplicative(name):
    """T(x, x'') = T(x, x') T(x', x''), except where the extinction belongs to the eye that sees it."""
    medium = replace(MEDIA[name], emission=0.0)
    half = RAYS.length / 2
    middle = RAYS.origin + half[:, None] * RAYS.direction
    whole = transmittance(medium, RAYS).value
    parts = transmittance(medium, Ray(EYE, W, half)).value * transmittance(medium, Ray(middle, W, half)).value
    assert np.allclose(whole, parts, rtol=1e-13, atol=0)


seeds = st.integers(0, 2**32 - 1)


@given(seed=seeds, s=st.one_of(st.just(np.inf), st.floats(0.01, 10)))
def test_cells_against_exact_clipping(seed, s):
    """Front to back over exactly clipped voxels in 60 digits, against compositing from the far end."""
    rng = np.random.default_rng(seed)
    shape = rng.integers(1, 4, size=3)
    arrays = {
        "sigma_t": 10.0 ** rng.uniform(-9, 2, size=shape),
        "albedo": rng.random(shape),
        "emission": rng.random(shape),
    }
    lower, upper = (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)
    w = rng.normal(size=3)
    ray = Ray(rng.normal(size=3), w / np.linalg.norm(w), s)
    grid = VoxelGrid(lower=lower, upper=upper, interpolation="nearest", **arrays)
    met = sorted(truth.cells_met(shape, lower, upper, ray.origin, ray.direction, s), key=lambda cell: cell[1])
    with mp.workdps(truth.DIGITS):
        totals, survived = {True: mp.mpf(0), False: mp.mpf(0)}, mp.mpf(1)
        for index, start, end in met:
            sigma, albedo, emission = (exact(a[index]) for a in arrays.values())
            passed = mp.exp(-sigma * exact(end - start))
            reach = survived * (1 - passed) / sigma
            totals[True] += reach * sigma * (albedo * exact(1.5) + (1 - albedo) * emission)
            totals[False] += reach * emission
            survived *= passed
        within(ambient_fog(grid, ray, 1.5, 0.25), totals[True] + survived * exact(0.25))
        within(emitted_radiance(grid, ray, times_sigma_a=False), totals[False])


@given(
    st.one_of(st.just(0.0), st.floats(-300, 8).map(lambda x: 10.0**x)),
    st.floats(-300, 3).map(lambda x: 10.0**x),
    st.one_of(st.just(np.inf), st.floats(-8, 8).map(lambda x: 10.0**x)),
    st.floats(1e-6, 1e6),
)
def test_emission_without_sigma_a(sigma_a, sigma_s, s, q):
    """q (1 - e^{-tau})/sigma_t in digits to spare, for every thickness."""
    with np.errstate(all="raise"):
        found = emitted_radiance(
            Medium(sigma_a, sigma_s, emission=q), Ray((0, 0, 0), (0, 0, 1), s), times_sigma_a=False
        )
    with mp.workdps(900):
        sigma_t = exact(sigma_a) + exact(sigma_s)
        expected = exact(q) * ((1 - mp.exp(-sigma_t * exact(s))) if s != np.inf else 1) / sigma_t
    assert within(found, expected) <= 1e-14


def test_emission_alone_grows_with_the_ray_and_without_end():
    """The lecture's other convention, in a medium that emits and does nothing else."""
    glow = Medium(0.0, 0.0, emission=2.0)
    found = emitted_radiance(glow, Ray((0, 0, 0), (0, 0, 1), [0.5, 3.0, np.inf]), times_sigma_a=False)
    assert found.value.tolist() == [1.0, 6.0, np.inf]
    assert (emitted_radiance(glow, Ray((0, 0, 0), (0, 0, 1), [0.5, 3.0, np.inf])).value == 0).all()


@pytest.mark.parametrize("name", MEDIA)
def test_thermal_furnace(name):
    """Ambient, emission and background all equal: what the furnace says, and what the solvers find."""
    if name in ("empty", "coloured"):
        medium = replace(MEDIA[name], emission=3.0)
    else:
        medium = replace(MEDIA[name], emission=np.asarray(3.0) if name in ("nearest", "trilinear") else 3.0)
    furnace = thermal_furnace(medium, RAYS, 3.0)
    assert (furnace.value == 3).all()
    assert (furnace.error == 0).all()
    agree(furnace, ambient_fog(medium, RAYS, 3.0, 3.0), radiance_by_quadrature(medium, RAYS, 3.0, 3.0))


def test_white_furnace():
    medium = Medium((0.0, 0.0), (0.5, 7.0), HenyeyGreenstein(0.7))
    furnace = white_furnace(medium, RAYS, 2.0)
    assert furnace.value.shape == (4, 2)
    agree(furnace, ambient_fog(medium, RAYS, 2.0, 2.0), radiance_by_ode(medium, RAYS, 2.0, 2.0))
    assert (white_furnace(Medium(0.0, 0.0), RAYS).value == 1).all()


@pytest.mark.parametrize(
    ("furnace", "medium", "argument"),
    [
        (white_furnace, Medium(0.1, 0.9), "albedo"),
        (white_furnace, Medium(0.0, 0.9, emission=1.0), "emission"),
        (white_furnace, Procedural(cloud, majorant=2.5, albedo=lambda x: x[..., 0]), "albedo"),
        (thermal_furnace, Medium(0.1, 0.9, emission=0.5), "emission"),
    ],
)
def test_what_is_no_furnace_is_refused(furnace, medium, argument):
    with pytest.raises(InvalidValueError) as raised:
        furnace(medium, RAYS)
    assert raised.value.argument == argument


def test_opengl_fog_blends_as_opengl_does():
    """C = f C_fragment + (1 - f) C_fog: fog colour as ambient light of a white medium, or as emission of a black one."""
    ray = Ray(EYE, (0, 0, 1), [0.2, 1.0, 2.5])
    for albedo, ambient, emission in ((1.0, 0.6, 0.0), (0.0, 0.0, 0.6)):
        fog = OpenGLFog("exp2", 0.7, eye=EYE, albedo=albedo, emission=emission)
        f = np.exp(-((0.7 * ray.length) ** 2))
        assert np.allclose(ambient_fog(fog, ray, ambient, 0.1).value, f * 0.1 + (1 - f) * 0.6, rtol=1e-15, atol=0)


def test_the_three_fogs_are_different_media_of_one_kind():
    """Extinction by the definition of each, integrated: what makes OpenGL's modes physical."""
    definitions = {
        "exp": lambda t: 0.7 + 0 * t,
        "exp2": lambda t: 2 * 0.49 * t,
        "linear": lambda t: np.where((t > 0.5) & (t < 3), 1 / (3 - t), 0),
    }
    for mode, sigma in definitions.items():
        fog = OpenGLFog(mode, 0.7, 0.5, 3.0, eye=EYE)
        same = Procedural(lambda x, f=sigma: f(np.linalg.norm(x - EYE, axis=-1)), majorant=100.0)
        agree(optical_thickness(fog, RAYS), optical_thickness(same, RAYS))


def test_a_ray_too_thick_for_the_differential_equation_is_refused():
    with pytest.raises(UnsupportedError, match="quadrature"):
        radiance_by_ode(Medium(1e6, 0.0, emission=1.0), Ray((0, 0, 0), (0, 0, 1), 1.0))


@pytest.mark.parametrize("tau", [1e2, 1e5])
def test_quadrature_of_a_thick_medium(tau):
    medium = Medium(0.3 * tau, 0.7 * tau, emission=0.4)
    agree(ambient_fog(medium, RAYS, 1.5, 0.25), radiance_by_quadrature(medium, RAYS, 1.5, 0.25))


def test_grey_medium_under_coloured_light():
    for name in ("linear", "layers", "trilinear", "procedural source"):
        coloured = ambient_fog(MEDIA[name], RAYS, (1.0, 2.0, 3.0), 0.25)
        assert coloured.value.shape == (4, 3)
        agree(coloured, radiance_by_quadrature(MEDIA[name], RAYS, (1.0, 2.0, 3.0), 0.25))
        one = ambient_fog(MEDIA[name], RAYS, 2.0, 0.25)
        assert (np.abs(one.value - coloured.value[:, 1]) <= one.error + coloured.error[:, 1]).all()
