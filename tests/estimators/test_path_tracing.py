"""Invariant: path tracers are unbiased against the exact solutions, however light is gathered, wherever paths end, and at
the extremes; and what they cut off they say."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import (
    ambient_fog,
    ball_radiance,
    ball_radiance_orders,
    half_space_reflectance,
    half_space_reflectance_orders,
    mean_scatterings,
    single_scattering,
    slab_emissivity,
    slab_reflectance,
    slab_reflectance_orders,
    slab_transmittance,
    slab_transmittance_orders,
)
from fogproof.catalogue.twins.paths import LiteralPaths
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
    VaryingPhase,
    VoxelGrid,
)
from fogproof.scene.lights import DirectionalLight, Environment, PointLight, SpotLight
from fogproof.scene.occluders import Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab, Unbounded
from fogproof.scene.surfaces import Plane, Surface
from fogproof.verify import run, select

ALPHA = 1e-9
UP = (0.0, 0.0, 1.0)
SLAB, BALL = Slab((0, 0, 0), UP, 1.0), Ball((0, 0, 0), 1.0)
BOX = Box((-1, -1, -1), (1, 1, 1))
SKY, BLACK = Environment(1.0), Surface(Plane((0, 0, -2), UP))
FOG = Medium(0.1, 0.9)
UNKNOWN = VaryingPhase(Hazy(), Rayleigh(), lambda x: 0.5 + 0 * x[..., 0])
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
    value = PathTracer(*args, **more, light_sampling="bsdf", roulette=None).draw(np.random.default_rng(1), 5000).value
    assert np.abs(value - 1).max() <= 1e-12


@pytest.mark.parametrize("name", FURNACES)
def test_furnaces(name):
    args, more = FURNACES[name]
    accept(PathTracer(*args, **more), ONE)


points = st.tuples(*[st.floats(-2, 2)] * 3)
directions = points.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: tuple(np.array(v) / np.linalg.norm(v)))
shapes = st.one_of(
    st.builds(Ball, points, st.floats(0.2, 2)),
    st.builds(lambda low, sides: Box(low, tuple(np.array(low) + sides)), points, st.tuples(*[st.floats(0.2, 2)] * 3)),
    st.builds(Slab, points, directions, st.floats(0.2, 2)),
    st.builds(HalfSpace, points, directions),
)
places = st.one_of(st.builds(Plane, points, directions), st.builds(Sphere, points, st.floats(0.2, 2)))
surfaces = st.builds(
    lambda place, albedo, finish: Surface(place, albedo, finish, 1 - albedo),
    places, st.floats(0, 1), st.sampled_from(["lambert", "mirror"]),
)  # fmt: skip


@given(
    shapes, st.none() | surfaces, st.sampled_from([0.6, 1.0, 1.5]), points, directions, st.floats(0, 1), st.floats(0, 1)
)
@settings(max_examples=200, deadline=None)
def test_any_furnace(shape, surface, index, eye, direction, albedo, g):
    if index != 1:
        surface = None  # it might touch the boundary
    medium = Medium(3 * (1 - albedo), 3 * albedo, HenyeyGreenstein(0.99 * g), emission=1.0)
    tracer = PathTracer(
        medium, shape, Ray(eye, direction), SKY, surface, "bsdf", refractive_index=index, roulette=None, events=500
    )
    paths = tracer.paths(np.random.default_rng(fresh_seed()), 50)
    assert np.abs(paths.value[:, 0] + paths.cut - 1).max() <= 1e-12


SUN, LAMP = DirectionalLight((0, 0, -1), 1.0), PointLight((0, 2, 0), 1.0)
BLUE = Medium(0.1, 0.9, Rayleigh())
SLABS = {
    "bsdf": lambda: (PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "bsdf"), slab_reflectance(0.9, 1.0, 0.5)),
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
    "once, Rayleigh": lambda: (
        PathTracer(BLUE, SLAB, ABOVE, SUN, deepest=1),
        single_scattering(BLUE, ABOVE, SUN, shape=SLAB),
    ),
    "once, forward": lambda: (
        PathTracer(unit(HenyeyGreenstein(0.7)), BALL, ASIDE, LAMP, deepest=1),
        single_scattering(unit(HenyeyGreenstein(0.7)), ASIDE, LAMP, shape=BALL),
    ),
}  # fmt: skip


def test_ambient_light_counts_as_scattered_once():
    tracer = PathTracer(FOG, SLAB, ABOVE, None, Surface(Plane((0, 0, -2), UP), radiance=0.3), ambient=0.8, columns=3)
    value = tracer.draw(np.random.default_rng(1), 1000).value
    assert {tuple(row) for row in value.tolist()} == {(0.3, 0.0, 0.0), (0.0, 0.9 * 0.8, 0.0)}


def test_from_within_glass_the_boundary_is_a_mirror():
    """From the centre of a glowing ball of optical radius 1: one radius, then diameters by what the boundary turns back."""
    tracer = PathTracer(Medium(1.0, 0.0, emission=1.0), BALL, Ray((0, 0, 0), (0.6, 0, 0.8)), refractive_index=4.0)
    back, radius = ((4.0 - 1) / (4 + 1)) ** 2, np.exp(-1.0)
    turned = back * radius * (1 - radius**2) / (1 - back * radius**2)
    accept(tracer, rows(1 - radius + turned))


@pytest.mark.parametrize(
    ("shape", "ray", "passes"),
    [
        (BOX, Ray((0.5, 3.0, 3.0), (0, 0, -1)), True),
        (BOX, Ray((0.5, 1.0 + 1e-9, 3.0), (0, 0, -1)), True),
        (BOX, Ray((0.5, 1.0 - 1e-9, 3.0), (0, 0, -1)), False),
        (SLAB, Ray((0, 0, 1e-9), (1, 0, 0)), True),
        (SLAB, Ray((0, 0, -1e-9), (1, 0, 0)), False),
        (BALL, Ray((1.0 + 1e-9, 0, 3), (0, 0, -1)), True),
        (HalfSpace((0, 0, 0), UP), Ray((0, 0, 1), (0.6, 0, 0.8)), True),
        (HalfSpace((0, 0, 0), UP), Ray((0, 0, 1), (0.6, 0, -0.8)), False),
    ],
)
def test_rays_beside_the_medium_pass_it_and_rays_within_do_not(shape, ray, passes):
    tracer = PathTracer(Medium(1e3, 0.0), shape, ray, SKY)
    assert set(tracer.draw(np.random.default_rng(1), 100).value) == {float(passes)}


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
    "bsdf": lambda: (
        SpectralPathTracer(COLOURS, SLAB, ABOVE, SKY, BLACK, "bsdf"),
        slab_reflectance(COLOURS.albedo, COLOURS.sigma_t, 0.5),
    ),
    "nee": lambda: (
        SpectralPathTracer(COLOURS, SLAB, ABOVE, SKY, BLACK, "nee", roulette=Roulette(1, 0.95)),
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


@pytest.mark.parametrize("surface", [None, Surface(Sphere((0, 0, 0), 0.5), 0.4, "lambert", 0.6)])
@pytest.mark.parametrize("medium", [Medium(0.0, (0.1, 1.0, 30.0)), voxels((3,))])
def test_the_channels_of_a_path_in_a_white_furnace_have_one_as_their_mean(medium, surface):
    tracer = SpectralPathTracer(medium, BALL, ASIDE, SKY, surface, "bsdf", roulette=None)
    value = tracer.draw(np.random.default_rng(2), 20_000).value
    assert np.abs(value.mean(axis=1) - 1).max() <= 1e-12
    assert value.min() >= 0
    assert np.abs(value - 1).max() > 0.1


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


ALBEDO = 1 - 1e-9
EXTREMES = {
    "albedo": st.sampled_from([0.0, ALBEDO, 1.0]) | st.floats(0, 1),
    "tau": st.sampled_from([1e-6, 1e4]) | st.floats(-6, 4).map(lambda x: 10.0**x),
    "g": st.sampled_from([0.0, 0.99, -0.99]) | st.floats(-0.99, 0.99),
    "index": st.sampled_from([0.7, 1.0, 1.5, 2.5]),
}


@given(**EXTREMES)
@settings(max_examples=60, deadline=None)
def test_at_extremes_each_path_and_what_was_cut_of_it_make_the_furnace_whole(albedo, tau, g, index):
    medium = Medium(tau * (1 - albedo), tau * albedo, HenyeyGreenstein(g), emission=1.0)
    tracer = PathTracer(
        medium, SLAB, ABOVE, SKY, light_sampling="bsdf", refractive_index=index, roulette=None, events=2000
    )
    paths = tracer.paths(np.random.default_rng(fresh_seed()), 50)
    assert np.abs(paths.value[:, 0] + paths.cut - 1).max() <= 1e-11


@given(**EXTREMES)
@settings(max_examples=20, deadline=None)
def test_extremes_with_everything_else_stay_finite(albedo, tau, g, index):
    medium = Medium(tau * (1 - albedo), tau * albedo, HenyeyGreenstein(g), emission=1.0)
    rng = np.random.default_rng(fresh_seed())
    for how in ({"refractive_index": index}, {"light_sampling": "mis"}, {"light_sampling": "nee"}):
        paths = PathTracer(medium, SLAB, ABOVE, SKY, BLACK, **how, events=2000).paths(rng, 30)
        assert np.isfinite(paths.value).all()
        assert paths.value.min() >= 0
        assert np.isfinite(paths.cut).all()


HARD = {  # albedo, tau, g, refractive index, paths, events
    "thin": (ALBEDO, 1e-3, 0.0, 1.0, 1_000_000, 1000),
    "thin glass": (ALBEDO, 1e-6, 0.0, 1.5, 200_000, 1000),
    "forward": (ALBEDO, 100.0, 0.99, 1.0, 5_000, 10_000),
    "backward": (0.9, 100.0, -0.99, 1.0, 50_000, 10_000),
    "backward, nothing absorbed": (ALBEDO, 100.0, -0.99, 1.0, 50_000, 10_000),
    "thick": (ALBEDO, 1e4, 0.0, 1.0, 50_000, 10_000),
    "thick glass": (ALBEDO, 1e4, 0.0, 1.5, 50_000, 10_000),
    "thick, forward": (ALBEDO, 1e3, 0.99, 1.0, 10_000, 10_000),
}


@pytest.mark.parametrize("name", HARD)
def test_hard_slabs_are_unbiased_but_for_what_is_cut(name):
    """Values lie in [0, 1]: the bounds are Maurer & Pontil's (2009), which hold for every law."""
    albedo, tau, g, index, n, events = HARD[name]
    medium = Medium(tau * (1 - albedo), tau * albedo, HenyeyGreenstein(g))
    tracer = PathTracer(medium, SLAB, ABOVE, SKY, BLACK, "bsdf", refractive_index=index, roulette=None, events=events)
    seed = fresh_seed()
    paths = tracer.paths(np.random.default_rng(seed), n)
    exact = slab_reflectance(albedo, tau, 0.5, HenyeyGreenstein(g) if g else None, index)
    low, high = paths.value[:, 0], paths.value[:, 0] + paths.cut
    assert high.max() <= 1 + 1e-12
    assert low.mean() - reach(low) <= exact.value + exact.error, f"seed {seed}"
    assert high.mean() + reach(high) >= exact.value - exact.error, f"seed {seed}"


def reach(x):
    """How far the mean of numbers in [0, 1] may lie from its expectation, but for ALPHA."""
    log = np.log(2 / ALPHA)
    return np.sqrt(2 * x.var(ddof=1) * log / len(x)) + 7 * log / (3 * (len(x) - 1))


def test_survivors_of_the_roulette_weigh_that_much_more():
    tracer = PathTracer(unit(), BALL, ASIDE, SKY, light_sampling="bsdf", roulette=Roulette(1, 0.5))
    value, _, scatterings, _ = tracer.paths(np.random.default_rng(5), 5000)
    left = value[:, 0] > 0
    assert np.array_equal(value[left, 0], 2.0 ** scatterings[left])
    assert 0 < left.mean() < 1


def test_what_is_cut_is_told():
    tracer = PathTracer(unit(), Ball((0, 0, 0), 3.0), ASIDE, SKY, light_sampling="bsdf", roulette=None, events=5)
    paths = tracer.paths(np.random.default_rng(5), 20_000)
    assert set(np.unique(paths.cut)) == {0.0, 1.0}
    # Cut paths would have seen the furnace's 1 as well: value and cut make it whole.
    assert np.all(paths.value[:, 0] + paths.cut == 1)
    assert paths.scatterings.max() == 5


def test_batches_do_not_prefer_short_paths():
    """What a path is worth depends on the paths before it alone: neither on how many follow, nor on which end first."""
    for tracer in (
        PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "bsdf", roulette=None),
        PathTracer(FOG, BALL, ASIDE, PointLight((0, 2, 0), 1.0), columns=4),
        SpectralPathTracer(COLOURS, SLAB, ABOVE, SKY, BLACK),
    ):
        few, many = (tracer.paths(np.random.default_rng(9), n) for n in (1000, 5000))
        for part, whole in zip(few, many, strict=True):
            assert np.array_equal(part, whole[:1000])


def test_workers_do_not_change_a_bit():
    cases = select(["paths/slab/met", "paths/slab/colours", "paths/box/voxels", "paths/walks"])
    one, two = (
        {r.case.name: r.verdict.to_dict()["findings"] for r in run(cases, seed=9, alpha=1e-6, workers=n)}
        for n in (1, 2)
    )
    assert one == two
    assert len(one) == len(cases)


SQUARES = {
    "slab, forward": lambda: (
        PathTracer(Medium(0.1, 0.9, HenyeyGreenstein(0.6)), SLAB, ABOVE, SKY, BLACK, "bsdf", roulette=None),
        [slab_reflectance(c, 1.0, 0.5, HenyeyGreenstein(0.6)) for c in (0.9, 0.9**2)],
    ),
    "glass": lambda: (
        PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, refractive_index=1.5, roulette=None),
        [slab_reflectance(c, 1.0, 0.5, None, 1.5) for c in (0.9, 0.9**2)],
    ),
    "transmitted": lambda: (
        PathTracer(FOG, SLAB, ABOVE, None, Surface(Plane((0, 0, -2), UP), radiance=1.0), roulette=None),
        [slab_transmittance(c, 1.0, 0.5) for c in (0.9, 0.9**2)],
    ),
    "half space": lambda: (
        PathTracer(
            Medium(0.2, 0.8), HalfSpace((0, 0, 0), UP), ABOVE, SKY, light_sampling="bsdf", deepest=200, roulette=None
        ),
        [half_space_reflectance(c, 0.5) for c in (0.8, 0.8**2)],
    ),
    "ball": lambda: (
        PathTracer(Medium(1.0, 3.0), BALL, ASIDE, SKY, light_sampling="bsdf", roulette=None),
        [ball_radiance(c, 4.0, 1.2) for c in (0.75, 0.75**2)],
    ),
}


@pytest.mark.parametrize("name", SQUARES)
def test_the_square_of_a_walk_weighs_like_a_walk_of_the_squared_albedo(name):
    """A walk that weighs c^n when it leaves has E[w] = R(c), so E[w^2] = R(c^2)."""
    tracer, (first, second) = SQUARES[name]()
    variance = Reference(second.value - first.value**2, second.error + 3 * first.error, "", "")
    seed = fresh_seed()
    verdict = check_estimator(tracer.draw, first, variance=variance, samples=400_000, alpha=ALPHA, seed=seed)
    assert verdict.outcome == "not rejected", f"seed {seed}: {verdict}"
    assert any(finding.check == "variance" for finding in verdict.findings)


ORDERS = {
    "reflected forward": lambda: (
        PathTracer(Medium(0.0, 1.0, HenyeyGreenstein(0.6)), SLAB, ABOVE, SKY, BLACK, columns=6, deepest=5),
        slab_reflectance_orders(1.0, 0.5, 5, HenyeyGreenstein(0.6)),
    ),
    "transmitted": lambda: (
        PathTracer(Medium(0.0, 1.0), SLAB, ABOVE, None, Surface(Plane((0, 0, -2), UP), radiance=1.0), columns=6, deepest=5),
        slab_transmittance_orders(1.0, 0.5, 5),
    ),
    "half space": lambda: (
        PathTracer(Medium(0.0, 1.0), HalfSpace((0, 0, 0), UP), ABOVE, SKY, columns=6, deepest=5, light_sampling="nee"),
        half_space_reflectance_orders(0.5, 5),
    ),
    "ball": lambda: (
        PathTracer(Medium(0.0, 2.0), BALL, ASIDE, SKY, columns=6, deepest=5, light_sampling="bsdf"),
        ball_radiance_orders(2.0, 0.6, 5),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ORDERS)
def test_orders(name):
    accept(*ORDERS[name](), 400_000)


@pytest.mark.parametrize("shape", [BALL, BOX, Slab((0, 0, 0), UP, 0.7)])
def test_scatterings_under_a_uniform_sky(shape):
    accept(ScatteringsUnderUniformSky(Medium(5.0, 1.5, HenyeyGreenstein(0.8)), shape), mean_scatterings(shape, 1.5))


def test_scatterings_in_voxels():
    grid = VoxelGrid(np.random.default_rng(3).random((4, 3, 5)) * 3, (-1, -1, -1), (1, 1, 1), "nearest", 1.0)
    accept(ScatteringsUnderUniformSky(grid, BOX), mean_scatterings(BOX, float(grid.sigma_t.mean())))


MIRROR = Surface(Plane((0, 0, -2), UP), 0.5, "mirror")


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: PathTracer(FOG, BALL, ASIDE, LAMP, light_sampling="mis"), InvalidValueError, "nee"),
        (lambda: PathTracer(FOG, BALL, ASIDE, SUN, refractive_index=1.5), UnsupportedError, "Environment"),
        (lambda: PathTracer(FOG, BALL, ASIDE, SUN, MIRROR), UnsupportedError, "mirror"),
        (
            lambda: PathTracer(FOG, BALL, ASIDE, SKY, light_sampling="mis", refractive_index=2.0),
            InvalidValueError,
            "bsdf",
        ),
        (lambda: PathTracer(FOG, BALL, ASIDE, SKY, light_sampling="guessed"), InvalidValueError, "light_sampling"),
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
        (lambda: PathTracer(LinearMedium(1.0, (0, 0, 0), phase=UNKNOWN), BALL, ASIDE, SKY), "share .* Ramp"),
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
