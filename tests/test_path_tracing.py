"""Invariant: path tracers are unbiased against the exact solutions, however light is gathered, wherever paths end, and at
the extremes; and what they cut off they say."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import (
    ambient_fog,
    ball_radiance,
    mean_scatterings,
    single_scattering,
    slab_emissivity,
    slab_reflectance,
    slab_transmittance,
)
from fogproof.catalogue.broken_paths import LiteralPaths
from fogproof.checks import check_estimator, fresh_seed
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators import (
    CompiledField,
    MajorantGrid,
    PathTracer,
    PointSourceWalks,
    Roulette,
    ScatteringsUnderUniformSky,
    SpectralPathTracer,
)
from fogproof.scene import (
    ExponentialMedium,
    Hazy,
    HenyeyGreenstein,
    LinearMedium,
    Medium,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    Rayleigh,
    VoxelGrid,
)
from fogproof.scene.lights import DirectionalLight, Environment, PointLight, SpotLight
from fogproof.scene.occluders import Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab, Unbounded
from fogproof.scene.surfaces import Plane, Surface

ALPHA = 1e-9
UP = (0.0, 0.0, 1.0)
SLAB, BALL = Slab((0, 0, 0), UP, 1.0), Ball((0, 0, 0), 1.0)
BOX = Box((-1, -1, -1), (1, 1, 1))
SKY, BLACK = Environment(1.0), Surface(Plane((0, 0, -2), UP))
FOG = Medium(0.1, 0.9)
ABOVE, ASIDE = Ray((0, 0, 3), (np.sqrt(0.75), 0, -0.5)), Ray((0.3, 0, 3), (0, 0, -1))
ONE = Reference(np.asarray(1.0), np.asarray(0.0), "", "")


def accept(estimator, reference, samples=200_000):
    seed = fresh_seed()
    verdict = check_estimator(estimator.draw, reference, samples=samples, alpha=ALPHA, seed=seed)
    assert verdict.outcome == "not rejected", f"seed {seed}: {verdict}"


def rows(value):
    return Reference(np.asarray(value, float), np.full(np.shape(value), 1e-12), "", "")


def voxels(channels=()):
    sigma = np.random.default_rng(3).random((4, 3, 5, *channels)) * 3
    return VoxelGrid(sigma, (-1, -1, -1), (1, 1, 1), "trilinear", 1.0)


def unit(phase=None, emission=0.0, albedo=1.0):
    """A medium of a furnace of radiance 1."""
    parts = (3 * (1 - albedo), 3 * albedo)
    return Medium(*parts, phase or HenyeyGreenstein(0.3), emission=emission)


FURNACES = {
    "ball, forward": ((unit(HenyeyGreenstein(0.99)), BALL, ASIDE, SKY), {}),
    "ball, backward": ((unit(HenyeyGreenstein(-0.99), 1.0, 0.9), BALL, ASIDE, SKY), {}),
    "ball, from within": ((unit(Rayleigh()), BALL, Ray((0.5, 0.2, 0.1), (0, 0.6, 0.8)), SKY), {}),
    "box, glowing": ((unit(emission=1.0, albedo=0.7), BOX, ASIDE, SKY), {}),
    "slab, glowing": ((unit(emission=1.0, albedo=0.8), SLAB, ABOVE, SKY), {}),
    "half space, glowing": ((unit(emission=1.0, albedo=0.9), HalfSpace((0, 0, 0), UP), ABOVE, SKY), {}),
    "grey sphere": (
        (unit(emission=1.0, albedo=0.8), BALL, ASIDE, SKY, Surface(Sphere((0, 0, 0), 0.5), 0.4, radiance=0.6)),
        {},
    ),
    "mirror sphere": (
        (unit(emission=1.0, albedo=0.8), BALL, ASIDE, SKY, Surface(Sphere((0, 0, 0), 0.5), 0.4, "mirror", 0.6)),
        {},
    ),
    "within a grey sphere": (
        (unit(), BALL, Ray((0.1, 0, 0), (0, 0, 1)), None, Surface(Sphere((0, 0, 0), 2.0), 0.4, radiance=0.6)),
        {},
    ),
    "plane through a box": ((unit(), BOX, ASIDE, SKY, Surface(Plane((0, 0, 0.2), (0.6, 0, 0.8)), 1.0)), {}),
    "glass ball": ((unit(emission=1.0, albedo=0.9), BALL, ASIDE, SKY), {"refractive_index": 1.5}),
    "bubble": ((unit(), BALL, ASIDE, SKY), {"refractive_index": 0.7}),
    "glass box": (
        (unit(emission=1.0, albedo=0.9), BOX, Ray((0, 0.1, 0.2), (0.6, 0, 0.8)), SKY),
        {"refractive_index": 2.0},
    ),
    "glass ball round a mirror": (
        (unit(), BALL, ASIDE, SKY, Surface(Sphere((0.2, 0, 0), 0.3), 1.0, "mirror")),
        {"refractive_index": 1.3},
    ),
    "voxels": ((voxels(), BOX, ASIDE, SKY), {}),
    "voxels, majorant in blocks": ((voxels(), BOX, ASIDE, SKY), {"majorant": MajorantGrid.of(voxels(), 2)}),
    "layers in a ball": (
        (PiecewiseConstantMedium((-1.0, -0.3, 0.2, 1.0), (1.0, 0.0, 5.0), UP, 1.0), BALL, ASIDE, SKY),
        {},
    ),
    "exponential in a ball": ((ExponentialMedium(1.0, (0.5, 1.0, -1.0), 1.0), BALL, ASIDE, SKY), {}),
}


@pytest.mark.parametrize("name", FURNACES)
def test_every_path_that_only_meets_light_sees_one_in_a_furnace(name):
    """Without roulette there is no variance: what was absorbed on the way has been made up for by emission."""
    args, more = FURNACES[name]
    value = PathTracer(*args, **more, gathering="met", roulette=None).draw(np.random.default_rng(1), 5000).value
    assert np.abs(value - 1).max() <= 1e-12


@pytest.mark.parametrize("name", FURNACES)
def test_furnaces(name):
    args, more = FURNACES[name]
    accept(PathTracer(*args, **more), ONE)


SLABS = {
    "met": lambda: (PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "met"), slab_reflectance(0.9, 1.0, 0.5)),
    "no roulette": lambda: (
        PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, roulette=None),
        slab_reflectance(0.9, 1.0, 0.5),
    ),
    "early roulette": lambda: (
        PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, roulette=Roulette(0, 0.75)),
        slab_reflectance(0.9, 1.0, 0.5),
    ),
    "tilted": lambda: (
        PathTracer(
            FOG, Slab((1, 2, 3), (0.6, 0, 0.8), 1.0), Ray((4, 2, 7), (-0.6, 0, -0.8)), None,
            Surface(Plane((0, 0, -3), (0.6, 0, 0.8)), radiance=1.0),
        ),
        slab_transmittance(0.9, 1.0, 1.0),
    ),
    "glowing": lambda: (
        PathTracer(Medium(0.1, 0.9, HenyeyGreenstein(-0.6), emission=1.0), SLAB, ABOVE),
        slab_emissivity(0.9, 1.0, 0.5, HenyeyGreenstein(-0.6)),
    ),
    "linear": lambda: (
        PathTracer(LinearMedium(2.0, (0, 0, 1.8), 0.9), SLAB, ABOVE, SKY, BLACK),
        slab_reflectance(0.9, 1.1, 0.5),
    ),
    "given majorant": lambda: (
        PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, majorant=2.5),
        slab_reflectance(0.9, 1.0, 0.5),
    ),
    "ambient": lambda: (
        PathTracer(FOG, SLAB, Ray((0, 0, 1), (0, 0, -1)), None, Surface(Plane((0, 0, -2), UP), radiance=0.3), ambient=0.8),
        ambient_fog(FOG, Ray((0, 0, 0), UP, 1.0), 0.8, 0.3),
    ),
    "unscattered": lambda: (
        PathTracer(FOG, SLAB, Ray((0, 0, 1), (0, 0, -1)), SKY, deepest=0),
        rows(np.exp(-1.0)),
    ),
    "once": lambda: (
        PathTracer(FOG, Unbounded(), Ray((0, 0, -2), UP), PointLight((0.6, -0.8, 0.5), 3.0), deepest=1),
        single_scattering(FOG, Ray((0, 0, -2), UP), PointLight((0.6, -0.8, 0.5), 3.0)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SLABS)
def test_exact_solutions(name):
    accept(*SLABS[name]())


def test_a_users_function_is_a_medium():
    import numba

    field = CompiledField(numba.njit(lambda x, y, z: 1.0 + x * x))
    medium = Procedural(field, 2.0, lower=(-1, -1, -1), upper=(1, 1, 1), albedo=1.0)
    accept(PathTracer(medium, BOX, ASIDE, SKY), ONE, 60_000)
    low = Procedural(field, 1.2, lower=(-1, -1, -1), upper=(1, 1, 1), albedo=1.0)
    with pytest.raises(InvalidValueError, match="majorant"):
        PathTracer(low, BOX, ASIDE, SKY).draw(np.random.default_rng(1), 10_000)


COLOURS = Medium((0.1, 0.2, 0.05), (0.4, 1.0, 2.0))
SPECTRAL = {
    "met": lambda: (
        SpectralPathTracer(COLOURS, SLAB, ABOVE, SKY, BLACK, "met"),
        slab_reflectance(COLOURS.albedo, COLOURS.sigma_t, 0.5),
    ),
    "looked for": lambda: (
        SpectralPathTracer(COLOURS, SLAB, ABOVE, SKY, BLACK, "looked for", roulette=Roulette(1, 0.95)),
        slab_reflectance(COLOURS.albedo, COLOURS.sigma_t, 0.5),
    ),
    "coloured light": lambda: (
        SpectralPathTracer(FOG, BALL, ASIDE, Environment((1.0, 2.0))),
        rows(ball_radiance(0.9, 1.0, 0.3).value * np.array([1, 2])),
    ),
    "furnace": lambda: (
        SpectralPathTracer(
            Medium((0.1, 2.0), (1.0, 0.0), emission=(1.0, 2.0)), BALL, ASIDE, Environment((1.0, 2.0)),
            Surface(Sphere((0, 0, 0), 0.4), 1.0),
        ),
        rows([1.0, 2.0]),
    ),
    "voxels": lambda: (
        SpectralPathTracer(voxels((3,)), BOX, ASIDE, SKY, Surface(Sphere((0, 0, 0), 0.4), 1.0, "mirror")),
        rows([1.0, 1.0, 1.0]),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SPECTRAL)
def test_colours(name):
    accept(*SPECTRAL[name](), 400_000)


def test_a_path_weighs_no_more_than_the_number_of_channels():
    tracer = SpectralPathTracer(Medium(0.0, (0.1, 1.0, 30.0)), BALL, ASIDE, SKY, gathering="met", roulette=None)
    value = tracer.draw(np.random.default_rng(2), 20_000).value
    assert value.max() <= 3 + 1e-12
    assert value.min() >= 0


@pytest.mark.parametrize(
    ("tracer", "reference"),
    [
        (LiteralPaths(FOG, SLAB, ABOVE, SKY, UP), lambda: slab_reflectance(0.9, 1.0, 0.5)),
        (LiteralPaths(FOG, SLAB, ABOVE, SKY, UP, looked_for=True, roulette=2), lambda: slab_reflectance(0.9, 1.0, 0.5)),
        (
            LiteralPaths(Medium(0.1, 0.9, HenyeyGreenstein(0.3)), SLAB, ABOVE, SKY, UP, looked_for=True, met=False),
            lambda: slab_reflectance(0.9, 1.0, 0.5, HenyeyGreenstein(0.3)),
        ),
        (LiteralPaths(COLOURS, SLAB, ABOVE, SKY, UP), lambda: slab_reflectance(COLOURS.albedo, COLOURS.sigma_t, 0.5)),
        (
            LiteralPaths(Medium(0.3, 0.7, emission=2.0), SLAB, ABOVE),
            lambda: rows(2 * slab_emissivity(0.7, 1.0, 0.5).value),
        ),
        (
            LiteralPaths(FOG, BALL, ASIDE, PointLight((0, 2, 0.5), 3.0), looked_for=True, met=False, deepest=1),
            lambda: single_scattering(FOG, ASIDE, PointLight((0, 2, 0.5), 3.0), shape=BALL),
        ),
    ],
)
def test_the_plain_tracer_of_the_broken_twins_is_right_without_their_errors(tracer, reference):
    accept(tracer, reference(), 100_000)


@given(
    st.floats(0, 1),
    st.floats(-6, 4).map(lambda x: 10.0**x),
    st.sampled_from([0.0, 0.99, -0.99]),
    st.sampled_from([1.0, 1.5]),
)
@settings(max_examples=15, deadline=None)
def test_extremes_finish_and_stay_within_what_is_possible(albedo, tau, g, index):
    medium = Medium(tau * (1 - albedo), tau * albedo, HenyeyGreenstein(g), emission=1.0)
    tracer = PathTracer(medium, SLAB, ABOVE, SKY, refractive_index=index, gathering="met", events=20_000)
    paths = tracer.paths(np.random.default_rng(fresh_seed()), 200)
    assert np.isfinite(paths.value).all()
    # In a thermal furnace nothing is brighter than 1 but what the roulette makes up for.
    assert paths.value.mean() <= 1 + 12 * (paths.value.std() + 1e-12) / np.sqrt(200)


def test_a_thick_slab_that_absorbs_next_to_nothing():
    albedo = 1 - 1e-9
    tracer = PathTracer(Medium(1e3 * (1 - albedo), 1e3 * albedo), SLAB, ABOVE, SKY, BLACK, "met", roulette=None)
    paths = tracer.paths(np.random.default_rng(fresh_seed()), 3000)
    exact = float(slab_reflectance(albedo, 1e3, 0.5).value)
    off = abs(paths.value.mean() - exact)
    assert off <= paths.cut.mean() + 6 * paths.value.std() / np.sqrt(3000) + 1e-6


def test_what_is_cut_is_told():
    tracer = PathTracer(unit(), Ball((0, 0, 0), 3.0), ASIDE, SKY, gathering="met", roulette=None, events=5)
    paths = tracer.paths(np.random.default_rng(5), 20_000)
    assert set(np.unique(paths.cut)) == {0.0, 1.0}
    # Cut paths would have seen the furnace's 1 as well: value and cut make it whole.
    assert np.all(paths.value[:, 0] + paths.cut == 1)
    assert np.all(paths.scatterings <= 5)


def test_batches_do_not_prefer_short_paths():
    """A batch of one has the same distribution of path lengths as a batch of many."""
    tracer = PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "met", roulette=None)
    rng = np.random.default_rng(fresh_seed())
    ones = np.concatenate([tracer.paths(rng, 1).scatterings for _ in range(4000)])
    many = tracer.paths(rng, 400_000).scatterings
    z = (ones.mean() - many.mean()) / np.sqrt(ones.var() / len(ones) + many.var() / len(many))
    assert abs(z) < 6.5


def test_the_seed_decides():
    tracer = PathTracer(FOG, BALL, ASIDE, PointLight((0, 2, 0), 1.0), columns=4)
    one, two = (tracer.draw(np.random.default_rng(9), 1000) for _ in range(2))
    assert np.array_equal(one.value, two.value)
    assert one.value.shape == (1000, 4)
    assert np.array_equal(one.cost, two.cost)


@pytest.mark.parametrize("shape", [BALL, BOX, Slab((0, 0, 0), UP, 0.7)])
def test_scatterings_under_a_uniform_sky(shape):
    accept(ScatteringsUnderUniformSky(Medium(5.0, 1.5, HenyeyGreenstein(0.8)), shape), mean_scatterings(shape, 1.5))


def test_scatterings_in_voxels():
    grid = VoxelGrid(np.random.default_rng(3).random((4, 3, 5)) * 3, (-1, -1, -1), (1, 1, 1), "nearest", 1.0)
    accept(ScatteringsUnderUniformSky(grid, BOX), mean_scatterings(BOX, float(grid.sigma_t.mean())))


SUN, LAMP = DirectionalLight((0, 0, -1), 1.0), PointLight((0, 2, 0), 1.0)
MIRROR = Surface(Plane((0, 0, -2), UP), 0.5, "mirror")


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: PathTracer(FOG, BALL, ASIDE, LAMP, gathering="both"), InvalidValueError, "looked for"),
        (lambda: PathTracer(FOG, BALL, ASIDE, SUN, refractive_index=1.5), UnsupportedError, "Environment"),
        (lambda: PathTracer(FOG, BALL, ASIDE, SUN, MIRROR), UnsupportedError, "mirror"),
        (lambda: PathTracer(FOG, BALL, ASIDE, SKY, gathering="both", refractive_index=2.0), InvalidValueError, "met"),
        (lambda: PathTracer(FOG, BALL, ASIDE, SKY, gathering="guessed"), InvalidValueError, "gathering"),
        (lambda: PathTracer(FOG, BALL, ASIDE, columns=0), InvalidValueError, "columns"),
        (lambda: PathTracer(FOG, BALL, ASIDE, deepest=-1), InvalidValueError, "deepest"),
        (lambda: PathTracer(FOG, BALL, ASIDE, events=0), InvalidValueError, "events"),
        (lambda: PathTracer(FOG, BALL, ASIDE, refractive_index=0.0), InvalidValueError, "refractive_index"),
        (lambda: PathTracer(FOG, BALL, Ray(np.zeros((2, 3)), UP)), UnsupportedError, "one ray"),
        (lambda: Roulette(survival=0.0), InvalidValueError, "survival"),
        (lambda: SpectralPathTracer(FOG, BALL, ASIDE, SKY), UnsupportedError, "channels"),
        (lambda: PointSourceWalks(1.0, (1.0,)), InvalidValueError, "albedo"),
        (lambda: Surface(Plane((0, 0, 0), UP), 1.5), InvalidValueError, "albedo"),
        (lambda: Surface((0, 0, 0)), InvalidValueError, "place"),
        (lambda: Surface(Plane((0, 0, 0), UP), 0.5, "shiny"), InvalidValueError, "finish"),
    ],
)
def test_bad_arguments_are_named(make, error, words):
    with pytest.raises(error, match=words):
        make()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: PathTracer(Medium(0.1, 0.9, Hazy()), BALL, ASIDE, SKY), "Hazy"),
        (lambda: PathTracer(FOG, BALL, ASIDE, SpotLight((0, 2, 0), (0, -1, 0), 1.0, 0.5)), "SpotLight"),
        (lambda: PathTracer(COLOURS, BALL, ASIDE, SKY), "channels"),
        (lambda: PathTracer(LinearMedium(1.0, (1, 0, 0)), SLAB, ABOVE, SKY), "bounded"),
        (lambda: PathTracer(Procedural(lambda x: x[..., 0], 1.0), BOX, ASIDE, SKY), "compiled"),
        (lambda: ScatteringsUnderUniformSky(FOG, HalfSpace((0, 0, 0), UP)), "HalfSpace"),
    ],
)  # fmt: skip
def test_what_cannot_be_traced_is_refused(make, words):
    with pytest.raises(UnsupportedError, match=words):
        make().draw(np.random.default_rng(1), 10)
