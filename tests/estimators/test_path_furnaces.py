"""In a furnace every path tracer sees radiance 1: each path alone where it only meets light, the others on average."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from path_scenes import (
    ABOVE,
    ASIDE,
    BALL,
    BOX,
    ONE,
    SKY,
    SLAB,
    UP,
    accept,
    unit,
    voxels,
)

from fogproof.checks import fresh_seed
from fogproof.estimators import (
    MajorantGrid,
    PathTracer,
)
from fogproof.scene import (
    ExponentialMedium,
    HenyeyGreenstein,
    Medium,
    PiecewiseConstantMedium,
    Ray,
    Rayleigh,
)
from fogproof.scene.occluders import Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab
from fogproof.scene.surfaces import Plane, Surface

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
