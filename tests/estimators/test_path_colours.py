"""Path tracers of many channels are unbiased in each of them."""

import numpy as np
import pytest
from path_scenes import (
    ABOVE,
    ASIDE,
    BALL,
    BLACK,
    BOX,
    COLOURS,
    FOG,
    SKY,
    SLAB,
    accept,
    rows,
    voxels,
)

from fogproof.analytic import (
    ball_radiance,
    slab_reflectance,
)
from fogproof.estimators import (
    Roulette,
    SpectralPathTracer,
)
from fogproof.scene import (
    Medium,
)
from fogproof.scene.lights import Environment
from fogproof.scene.occluders import Sphere
from fogproof.scene.surfaces import Surface

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
