"""The estimator of a scene has the oracle's mean for every medium and light, and does no work for a term that the plan drops."""

from dataclasses import replace

import numpy as np
import pytest

from fogproof.analytic import radiance
from fogproof.checks import check_estimator
from fogproof.errors import UnsupportedError
from fogproof.plan import plan
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
    HenyeyGreenstein,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    PointLight,
    Procedural,
    Ray,
    Scene,
    VoxelGrid,
)
from fogproof.scene.lights import DirectionalLight, Environment
from fogproof.scene.one_channel import one_channel
from fogproof.scene_estimator import estimator_for

RAY = Ray((0.1, 0.2, 0.0), (0, 0, 1), 2.0)
LAMP = PointLight((0.4, 0.9, 1.1), 3.0)
SOURCES = {"albedo": 0.6, "phase": HenyeyGreenstein(0.4), "emission": 0.7}
CELLS = np.array([0.2, 0.9, 0.5, 1.3, 0.1, 0.7, 0.4, 1.1]).reshape(2, 2, 2)


def smooth(x):
    return 0.6 + 0.4 * np.sin(2 * x[..., 2] + x[..., 0])


MEDIA = {
    "homogeneous": Medium(0.3, 0.4, HenyeyGreenstein(0.4), emission=0.7),
    "linear": LinearMedium(0.1, (0, 0, 0.4), **SOURCES),
    "exponential": ExponentialMedium(0.3, (0, 0, 0.5), **SOURCES),
    "layers": PiecewiseConstantMedium([0, 1, 3], [0.5, 0.9], **SOURCES),
    "anisotropic": AnisotropicMedium(0.5, np.diag([1.0, 1.0, 0.5]), **SOURCES),
    "voxels": VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), "nearest", **SOURCES),
    "trilinear": VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), **SOURCES),
    "procedural": Procedural(smooth, 1.0, detail=0.5, **SOURCES),
    "procedural, sources vary": Procedural(
        smooth, 1.0, detail=0.5, albedo=lambda x: 0.5 + 0.4 * np.cos(x[..., 2]), emission=lambda x: 1 + x[..., 2]
    ),
}
SUN = DirectionalLight((0.0, 0.6, 0.8), 2.0)
LIT = {"homogeneous", "linear", "exponential", "layers", "voxels", "trilinear", "procedural"}


def scenes():
    yield "opengl", Scene(OpenGLFog("exp2", 0.4), Ray((0, 0, 0), (0, 0, 1), 2.0), background=2.0)
    yield "empty", Scene(Medium(0, 0), RAY, background=2.0)
    yield "dark", Scene(Medium(1, 0), RAY)
    for name, medium in MEDIA.items():
        yield f"{name}, background", Scene(medium, RAY, background=2.0)
        yield f"{name}, ambient", Scene(medium, RAY, "ambient", ambient=0.8, background=2.0)
        if name in LIT:
            yield f"{name}, lamp", Scene(medium, RAY, "single", LAMP, background=2.0)
    for name in ("voxels", "trilinear"):
        yield f"{name}, sun", Scene(MEDIA[name], RAY, "single", SUN, background=2.0)
    yield "sun beyond endless fog", Scene(MEDIA["homogeneous"], RAY, "single", SUN, background=2.0)
    yield "endless fog", Scene(MEDIA["homogeneous"], Ray((0, 0, 0), (0, 0, 1)), "single", LAMP)
    yield (
        "coloured fog",
        Scene(Medium((0.1, 0.2, 0.9), 0.4, emission=0.3), RAY, "ambient", ambient=(0.5, 0.2, 0.1), background=1.0),
    )
    yield (
        "coloured lamp",
        Scene(Medium(0.1, (0.4, 0.5, 0.9)), RAY, "single", PointLight((0.4, 0.9, 1.1), (1.0, 2.0, 3.0))),
    )
    yield (
        "coloured voxels",
        Scene(VoxelGrid(np.stack([CELLS, 0.5 * CELLS], axis=-1), (0, 0, 0), (1, 1, 2), **SOURCES), RAY, background=2.0),
    )
    coloured = Procedural(lambda x: np.stack([smooth(x), 0.3 * smooth(x)], axis=-1), 1.0, channels=2, detail=0.5)
    yield "coloured function", Scene(coloured, RAY, background=(1.0, 2.0))
    graded = LinearMedium((0.1, 0.4), ((0, 0, 0.4), (0, 0, -0.1)), albedo=(0.2, 0.3))
    yield "coloured gradient", Scene(graded, RAY, "ambient", ambient=1.0)


SCENES = dict(scenes())


@pytest.mark.parametrize("name", SCENES)
def test_mean(name):
    scene = SCENES[name]
    verdict = check_estimator(estimator_for(scene).draw, radiance(scene), samples=20_000)
    assert verdict.outcome == "not rejected", verdict


@pytest.mark.parametrize("name", SCENES)
def test_parts_are_the_terms_that_the_plan_keeps(name):
    scene = SCENES[name] if SCENES[name].channels is None else one_channel(SCENES[name], 0)
    kept = {term.name for term in plan(scene).terms if term.kept}
    single = scene.scattering == "single"
    expected = set()
    if kept & {"background", "emission"} or ("in-scattering" in kept and not single):
        expected.add("background, emission and ambient")
    if "in-scattering" in kept and single:
        expected.add("in-scattering")
    estimator = estimator_for(scene)
    assert set(estimator.parts) == expected
    cost = estimator.draw(np.random.default_rng(), 10).cost
    assert np.all(cost == 0) == ("attenuation" not in kept or not expected)


def test_a_dropped_term_is_never_looked_at():
    """The same medium counts its look-ups: with a dark lamp as many as without one, and none where nothing can be seen."""
    count = []

    def counted(x):
        count.append(x[..., 0].size)
        return smooth(x)

    def look_ups(scene):
        count.clear()
        estimator_for(scene).draw(np.random.default_rng(7), 200)
        return sum(count)

    medium = Procedural(counted, 1.0, detail=0.5, albedo=0.5)
    dark = replace(LAMP, intensity=0.0)
    plain = look_ups(Scene(medium, RAY, background=1.0))
    assert plain > 0
    assert look_ups(Scene(medium, RAY, "single", dark, background=1.0)) == plain
    assert look_ups(Scene(medium, RAY, "single", LAMP, background=1.0)) > plain
    assert look_ups(Scene(medium, RAY)) == 0


TWINS = {
    "homogeneous and a constant grid": (
        Medium(0.28, 0.42, emission=0.7),
        VoxelGrid(np.full((3, 2, 4), 0.7), (-50, -50, -50), (50, 50, 50), albedo=0.6, emission=0.7),
    ),
    "homogeneous and one layer": (
        Medium(0.28, 0.42, emission=0.7),
        PiecewiseConstantMedium([-np.inf, np.inf], [0.7], albedo=0.6, emission=0.7),
    ),
    "no emission and emission 0": (Medium(0.28, 0.42), Medium(0.28, 0.42, emission=0.0)),
    "grey and three equal channels": (Medium(0.28, 0.42), Medium((0.28,) * 3, (0.42,) * 3)),
}


# shadow rays through layers are tracked: alike on average only, see test_mean
@pytest.mark.parametrize(
    ("name", "scattering"),
    [
        (name, s)
        for name in TWINS
        for s in ("ambient", "single")
        if (name, s) != ("homogeneous and one layer", "single")
    ],
)
def test_twin_scenes_are_alike(name, scattering):
    """The first number of a channel is drawn from the same uniforms: answers agree digit by digit, but for rounding."""
    light = LAMP if scattering == "single" else None
    drawn = []
    for medium in TWINS[name]:
        scene = Scene(medium, RAY, scattering, light, ambient=0.5, background=1.5)
        value = estimator_for(scene).draw(np.random.default_rng(11), 1000).value
        drawn.append(value if value.ndim == 1 else value[:, 0])
    np.testing.assert_allclose(drawn[0], drawn[1], rtol=1e-12)


def test_a_batch_of_rays_is_refused():
    rays = Ray(np.zeros((2, 3)), (0, 0, 1), 1.0)
    with pytest.raises(UnsupportedError, match="one ray"):
        estimator_for(Scene(Medium(0.1, 0.1), rays))


def test_light_from_infinitely_far_is_dropped():
    scene = Scene(MEDIA["homogeneous"], RAY, "single", Environment(1.0))
    assert "no light arrives" in str(plan(scene))
