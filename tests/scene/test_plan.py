"""`plan` keeps a term exactly where it can be non-zero, for every kind of medium, and names a solver that exists."""

import numpy as np
import pytest

from fogproof import analytic
from fogproof.plan import plan
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
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

RAY = Ray((0, 0, 0), (0, 0, 1), 2.0)
LIGHT = PointLight((0, 1, 1), 2.0)
HALF = {"albedo": 0.5}
MEDIA = {
    "homogeneous": Medium(0.1, 0.2),
    "linear": LinearMedium(0.1, (0, 0, 1), **HALF),
    "exponential": ExponentialMedium(0.1, (0, 0, 1), **HALF),
    "layers": PiecewiseConstantMedium([0, 1, 2], [0.5, 0.7], **HALF),
    "anisotropic": AnisotropicMedium(0.3, np.eye(3), **HALF),
    "voxels": VoxelGrid(np.ones((2, 2, 2)), (0, 0, 0), (1, 1, 1), **HALF),
    "fog": OpenGLFog("exp", 0.3),
    "procedural": Procedural(lambda x: np.ones(x.shape[:-1]), 1.0, **HALF),
}


def kept(scene):
    return {term.name for term in plan(scene).terms if term.kept}


@pytest.mark.parametrize("name", MEDIA)
def test_every_kind_of_medium_has_a_plan(name):
    answer = plan(Scene(MEDIA[name], RAY, background=1.0))
    assert answer.solver == "transmittance"
    assert answer.estimator
    assert str(answer)
    if name != "fog":
        assert plan(Scene(MEDIA[name], RAY, "single", LIGHT)).solver == "single_scattering"


@pytest.mark.parametrize(
    ("scene", "terms"),
    [
        (Scene(Medium(0, 0), RAY), set()),
        (Scene(Medium(0, 0), RAY, background=1.0), {"background"}),
        (Scene(Medium(1, 0), RAY, background=1.0), {"attenuation", "background"}),
        (Scene(Medium(1, 0, emission=1.0), RAY), {"attenuation", "emission"}),
        (Scene(Medium(0, 1, emission=1.0), RAY), {"attenuation"}),
        (Scene(Medium(0, 1), RAY, "ambient", ambient=1.0), {"attenuation", "in-scattering"}),
        (Scene(Medium(0, 1), RAY, "ambient"), {"attenuation"}),
        (Scene(Medium(1, 0), RAY, "ambient", ambient=1.0), {"attenuation"}),
        (Scene(Medium(0, 1), RAY, "single", LIGHT), {"attenuation", "in-scattering"}),
        (Scene(Medium(0, 1), RAY, "single", PointLight((0, 1, 1), 0.0)), {"attenuation"}),
        (Scene(Medium((0, 1), (0, 1)), RAY, background=(1.0, 1.0)), {"attenuation", "background", "colour"}),
        (Scene(ExponentialMedium(0.0, (0, 0, 1)), RAY, background=1.0), {"background"}),
    ],
)
def test_terms_are_kept_where_they_can_be_non_zero(scene, terms):
    assert kept(scene) == terms


def test_a_dropped_term_changes_nothing():
    pairs = [
        (Medium(0.3, 0.4), Medium(0.3, 0.4, emission=0.0)),
        (Medium(0.3, 0.4), Medium((0.3,) * 3, (0.4,) * 3)),
        (Medium(0.0, 0.4), Medium(0.0, 0.4, emission=5.0)),
    ]
    for lean, rich in pairs:
        for function, arguments in [(analytic.transmittance, ()), (analytic.ambient_fog, (0.7, 0.2))]:
            np.testing.assert_array_equal(
                np.broadcast_to(function(lean, RAY, *arguments).value, function(rich, RAY, *arguments).value.shape),
                function(rich, RAY, *arguments).value,
            )
