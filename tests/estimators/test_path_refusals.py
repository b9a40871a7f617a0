"""What no path tracer can follow is refused by name."""

import numpy as np
import pytest
from path_scenes import (
    ABOVE,
    ASIDE,
    BALL,
    BOX,
    COLOURS,
    FOG,
    LAMP,
    SKY,
    SLAB,
    SUN,
    UNKNOWN,
    UP,
)

from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators import (
    PathTracer,
    PointSourceWalks,
    Roulette,
    ScatteringsUnderUniformSky,
    SpectralPathTracer,
)
from fogproof.scene import (
    LinearMedium,
    Procedural,
    Ray,
)
from fogproof.scene.lights import SpotLight
from fogproof.scene.shapes import HalfSpace
from fogproof.scene.surfaces import Plane, Surface

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
