"""Every combination of medium, scattering, light, shadow, ambient light, background and colour: right terms, the oracle's mean."""

from itertools import product

import numpy as np
import pytest

from fogproof.analytic import radiance
from fogproof.checks import check_estimator
from fogproof.plan import plan
from fogproof.scene import (
    DirectionalLight,
    ExponentialMedium,
    HenyeyGreenstein,
    LinearMedium,
    Medium,
    PiecewiseConstantMedium,
    PointLight,
    Ray,
    Scene,
    VoxelGrid,
)
from fogproof.scene.occluders import Disk, Sphere
from fogproof.scene_estimator import estimator_for

RAY = Ray((0.1, 0.2, 0.0), (0, 0, 1), 2.0)
LOBE = {"phase": HenyeyGreenstein(0.4)}
CELLS = np.array([0.2, 0.9, 0.5, 1.3, 0.1, 0.7, 0.4, 1.1]).reshape(2, 2, 2)
MEDIA = {
    "homogeneous": Medium(0.3, 0.4, emission=0.7, **LOBE),
    "coloured": Medium((0.3, 0.1), (0.4, 0.6), emission=0.7, **LOBE),
    "absorbing": Medium(0.5, 0.0),
    "scattering": Medium(0.0, 0.5, emission=0.7, **LOBE),
    "empty": Medium(0.0, 0.0),
    "linear, 0 at the origin": LinearMedium(0.0, (0, 0, 0.4), albedo=0.6, emission=0.7, **LOBE),
    "linear, begins on the ray": LinearMedium(-0.3, (0, 0, 0.5), albedo=(0.6, 0.2), emission=0.7, **LOBE),
    "linear, ends on the ray": LinearMedium((0.5, 0.9), (0, 0.1, -0.6), albedo=0.6, **LOBE),
    "exponential": ExponentialMedium((0.3, 0.5), (0, 0, 0.5), albedo=0.6, emission=(0.7, 0.0), **LOBE),
    "layers": PiecewiseConstantMedium([0, 1, 3], [0.5, 0.9], albedo=0.6, emission=0.7, **LOBE),
    "voxels": VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), "nearest", albedo=0.6, **LOBE),
    "unlike voxels": VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), "nearest", albedo=CELLS / 2, emission=CELLS, **LOBE),
}
LAMP, SUN = PointLight((0.4, 0.9, 1.1), 3.0), DirectionalLight((0.0, 0.6, 0.8), (2.0, 0.5))
LIT = [("none", None), ("none", LAMP), ("ambient", None), ("ambient", LAMP), ("single", LAMP), ("single", SUN),
       ("single", PointLight((0.4, 0.9, 1.1), 0.0))]  # fmt: skip
SHADOWS = [(), (Sphere((0.25, 0.5, 0.6), 0.15), Disk((0.2, 0.6, 1.4), (0, 1, 0), 0.2))]
AMBIENT, BACKGROUND = [0.0, 0.8, (0.4, 0.0)], [0.0, 2.0, (0.0, 3.0)]


def scenes_of(medium):
    for (scattering, light), shadows, ambient, background in product(LIT, SHADOWS, AMBIENT, BACKGROUND):
        if not shadows or scattering == "single":
            yield Scene(MEDIA[medium], RAY, scattering, light, shadows, ambient, background)


def terms_of(name, scene):
    """The terms of the rendering equation that are not 0, by what the scene was made of."""
    present, scatters = name != "empty", name not in ("empty", "absorbing")
    glows = (
        name in ("homogeneous", "coloured", "exponential", "layers", "unlike voxels")
        or "0 at" in name
        or "begins" in name
    )
    far_in_endless = scene.light is SUN and name in ("homogeneous", "coloured", "scattering", "absorbing", "empty")
    lit = scene.scattering == "single" and (scene.light is LAMP or (scene.light is SUN and not far_in_endless))
    return {
        "attenuation": present,
        "background": bool(np.any(scene.background)),
        "emission": glows,
        "in-scattering": scatters and (lit or (scene.scattering == "ambient" and bool(np.any(scene.ambient)))),
        "colour": scene.channels is not None,
    }


@pytest.mark.parametrize("name", MEDIA)
def test_the_plan_keeps_what_is_not_0(name):
    for scene in scenes_of(name):
        assert {term.name: term.kept for term in plan(scene).terms} == terms_of(name, scene), scene


@pytest.mark.parametrize("name", MEDIA)
def test_the_estimator_has_the_oracles_mean(name):
    """An eighth of all combinations, drawn anew each time; a wrong term is as large as the others."""
    scenes = list(scenes_of(name))
    for i in np.random.default_rng().permutation(len(scenes))[: len(scenes) // 8]:
        scene = scenes[i]
        if plan(scene).refused:
            continue
        right, estimator = radiance(scene), estimator_for(scene)
        drawn = np.atleast_2d(estimator.draw(np.random.default_rng(), 16).value.T)
        steady = np.ptp(drawn, axis=1) <= 1e-12 * np.abs(drawn).max(axis=1)
        off = np.abs(drawn.mean(axis=1) - right.value)
        assert np.all((off <= np.asarray(right.error) + 1e-10 * np.abs(right.value))[steady]), scene
        verdict = check_estimator(estimator.draw, right, samples=4000, alpha=1e-9)
        assert verdict.outcome != "rejected", (scene, str(verdict))
