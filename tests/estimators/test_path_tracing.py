"""Path tracers are unbiased against the exact solutions, however light is gathered and wherever paths end."""

import numpy as np
import pytest
from path_scenes import (
    ABOVE,
    ALPHA,
    ASIDE,
    BALL,
    BLACK,
    BOX,
    COLOURS,
    FOG,
    LAMP,
    ONE,
    SKY,
    SLAB,
    SUN,
    UP,
    accept,
    rows,
    unit,
)

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
from fogproof.errors import InvalidValueError
from fogproof.estimators import (
    CompiledField,
    PathTracer,
    Roulette,
    ScatteringsUnderUniformSky,
)
from fogproof.scene import (
    HenyeyGreenstein,
    LinearMedium,
    Medium,
    Procedural,
    Ray,
    Rayleigh,
    VoxelGrid,
)
from fogproof.scene.lights import PointLight
from fogproof.scene.shapes import HalfSpace, Slab, Unbounded
from fogproof.scene.surfaces import Plane, Surface

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
        2_000_000,  # skewed: fewer do not always decide
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
