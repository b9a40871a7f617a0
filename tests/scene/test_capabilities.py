"""No promise that cannot be kept: plan, estimator and oracle agree on every pair of a medium and a light, refused or drawn."""

import re
from itertools import product

import numpy as np
import pytest

from fogproof.analytic import radiance
from fogproof.capabilities import capabilities
from fogproof.checks import check_estimator
from fogproof.errors import UnsupportedError
from fogproof.plan import plan
from fogproof.scene import (
    AnisotropicMedium,
    DirectionalLight,
    Environment,
    ExponentialMedium,
    HenyeyGreenstein,
    Isotropic,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    PointLight,
    Procedural,
    Ramp,
    Ray,
    Scene,
    SpotLight,
    VaryingPhase,
    VoxelGrid,
)
from fogproof.scene.lights import KINDS as LIGHT_KINDS
from fogproof.scene.lights.disk import DiskLight
from fogproof.scene.lights.environment_map import EnvironmentMap
from fogproof.scene.lights.rectangle import RectangleLight
from fogproof.scene.lights.sphere import SphereLight
from fogproof.scene.media import FROM_PYTHON, KINDS
from fogproof.scene.media.composite import CompositeMedium
from fogproof.scene.media.gaussian_puffs import GaussianPuffs
from fogproof.scene.media.temperature_grid import TemperatureGrid
from fogproof.scene.media.transformed import TransformedMedium
from fogproof.scene.shapes import Box
from fogproof.scene_estimator import estimator_for

EYE = (0.1, 0.2, 0.0)
RAYS = {"short": Ray(EYE, (0, 0, 1), 2.0), "endless": Ray(EYE, (0, 0, 1))}
SAME = {"albedo": 0.6, "phase": HenyeyGreenstein(0.4), "emission": 0.7}
BLEND = VaryingPhase(Isotropic(), HenyeyGreenstein(0.5), Ramp((0, 0, 0), (0, 0, 2)))
CELLS = np.array([0.2, 0.9, 0.5, 1.3, 0.1, 0.7, 0.4, 1.1]).reshape(2, 2, 2)
FOG = {"albedo": 0.6, "emission": 0.7, "eye": EYE}


def smooth(x):
    return 0.6 + 0.4 * np.sin(2 * x[..., 2] + x[..., 0])


VARYING = {"albedo": lambda x: 0.5 + 0.4 * np.cos(x[..., 2]), "emission": lambda x: 1 + x[..., 2]}
MEDIA = {
    "homogeneous": Medium(0.3, 0.4, HenyeyGreenstein(0.4), emission=0.7),
    "empty": Medium(0.0, 0.0),
    "linear": LinearMedium(0.1, (0, 0, 0.4), **SAME),
    "vacuum on the ray": LinearMedium(-1.0, (0, 0, -0.4), **SAME),
    "exponential": ExponentialMedium(0.3, (0, 0, 0.5), **SAME),
    "layers": PiecewiseConstantMedium([0, 1, 3], [0.5, 0.9], **SAME),
    "unlike layers": PiecewiseConstantMedium([0, 1, 3], [0.5, 0.9], albedo=[0.2, 0.9], emission=[1, 2], phase=BLEND),
    "flakes": AnisotropicMedium(0.5, np.diag([1.0, 1.0, 0.5]), **SAME),
    "flakes unseen": AnisotropicMedium(0.5, np.diag([1.0, 0.0, 0.0]), **SAME),
    "fog exp": OpenGLFog("exp", 0.4, **FOG),
    "fog exp2": OpenGLFog("exp2", 0.4, **FOG),
    "fog linear": OpenGLFog("linear", start=0.3, end=2.5, **FOG),
    "voxels": VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), "nearest", **SAME),
    "trilinear": VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), **SAME),
    "unlike voxels": VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), albedo=CELLS / 2, emission=CELLS),
    "function": Procedural(smooth, 1.0, detail=0.5, **SAME),
    "function in a box": Procedural(smooth, 1.0, lower=(0, 0, 0), upper=(1, 1, 2), detail=0.5, albedo=0.6, phase=BLEND),
    "puffs": GaussianPuffs([(0, 0.1, 1), (0.5, -0.2, 2)], [0.3, 0.7], [2.0, 0.8], **SAME),
    "fire": TemperatureGrid(VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), "nearest", albedo=0.6), 4000 + 1000 * CELLS, 2e-6),
    "turned": TransformedMedium(
        VoxelGrid(CELLS, (0, 0, 0), (1, 1, 2), "nearest", **SAME), [[0, -1, 0, 0.7], [1, 0, 0, -0.2], [0, 0, 1.2, -0.1]]
    ),
    "several": CompositeMedium(
        (Medium(0.3, 0.6, HenyeyGreenstein(0.4), emission=0.7), Medium(0.1, 0.2)),
        (Box((-1, -1, 0.5), (1, 1, 1.5)), Box((-2, -2, 0), (2, 2, 2))),
        "sum",
    ),
    "unlike function": Procedural(smooth, 1.0, detail=0.5, **VARYING),
}
LIGHTS = {
    "ambient": None,
    "lamp": PointLight((0.4, 0.9, 1.1), 3.0),
    "spot": SpotLight((0.4, 0.9, 1.1), (0, -1, 0), 3.0, 0.8),
    "sun": DirectionalLight((0.0, 0.6, 0.8), 2.0),
    "sky": Environment(1.0),
    "panorama": EnvironmentMap([[1.0, 0.2, 0.0, 0.4], [0.1, 0.0, 0.3, 0.0]], 2.0),
    "globe": SphereLight((0.4, 0.9, 1.1), 0.2, 3.0),
    "plate": DiskLight((0.4, 0.9, 1.1), (0, -1, 0), 0.2, 3.0),
    "window": RectangleLight((0.4, 0.9, 1.1), (0.3, 0, 0), (0, 0, 0.3), 3.0),
}
SLOW = ("globe", "plate", "window", "panorama")
"""Light with extent takes the oracle seconds in media without a closed form: one of each kind of tracking is asked for."""
PAIRS = [f"{medium} / {light}" for medium, light in product(MEDIA, LIGHTS)]


def scene_of(pair, ray):
    medium, light = (kinds[name] for kinds, name in zip((MEDIA, LIGHTS), pair.split(" / "), strict=True))
    return Scene(medium, RAYS[ray], "single" if light else "ambient", light, ambient=0.8, background=2.0)


def test_every_kind_is_here():
    assert {type(m) for m in MEDIA.values()} == {*KINDS.values(), *FROM_PYTHON}
    assert {type(light) for light in LIGHTS.values() if light} == {*LIGHT_KINDS.values()}


@pytest.mark.parametrize("pair", PAIRS)
def test_a_pair_is_refused_by_name_or_drawn_as_the_oracle_says(pair):
    scene = scene_of(pair, "short")
    refused = plan(scene).refused
    assert refused == capabilities(scene).refused
    if refused:
        assert type(scene.medium).__name__ in refused or type(scene.light).__name__ in refused
        with pytest.raises(UnsupportedError, match=re.escape(refused[:40])):
            estimator_for(scene)
        return
    estimator = estimator_for(scene)
    if pair.split(" / ")[1] in SLOW and not pair.startswith("homogeneous"):
        assert np.isfinite(estimator.draw(np.random.default_rng(), 50).value).all()
        return
    verdict = check_estimator(estimator.draw, radiance(scene), samples=40_000)
    assert verdict.outcome == "not rejected", verdict


@pytest.mark.parametrize("pair", PAIRS)
def test_an_endless_ray_is_refused_by_name_or_answered(pair):
    scene = scene_of(pair, "endless")
    if plan(scene).refused:
        with pytest.raises(UnsupportedError):
            estimator_for(scene)
        return
    if pair.split(" / ")[1] not in SLOW:
        assert np.isfinite(radiance(scene).value)
    assert np.isfinite(estimator_for(scene).draw(np.random.default_rng(), 50).value).all()


def test_only_what_nobody_follows_is_refused():
    refused = {pair for pair in PAIRS if plan(scene_of(pair, "short")).refused}
    skies = {f"{medium} / sky" for medium in MEDIA if medium not in ("homogeneous", "empty")}
    assert refused == skies | {
        f"{kind} / {far}" for kind in ("function", "unlike function") for far in ("sun", "panorama")
    }
