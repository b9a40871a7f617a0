"""Invariant: a surface at the camera leaves its radiance alone: T = 1, nothing emitted, nothing scattered in, whoever is asked."""

import numpy as np
import pytest

from fogproof import Medium, PointLight, Ray, analytic
from fogproof.errors import UnsupportedError
from fogproof.scene import (
    AnisotropicMedium,
    ExponentialMedium,
    LinearMedium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    Scene,
    VoxelGrid,
)
from fogproof.scene.lights import DirectionalLight, Environment, SphereLight
from fogproof.scene_estimator import estimator_for

BOX = {"lower": (-1, -1, -1), "upper": (1, 1, 1)}
MEDIA = {
    "homogeneous": Medium(0.1, 0.2, emission=0.5),
    "empty": Medium(0, 0),
    "coloured": Medium((0.1, 0.2), 0.1),
    "linear": LinearMedium(1, (0, 0, 0.1), albedo=0.5, emission=2),
    "exponential": ExponentialMedium(1, (0, 0, -1), albedo=0.5),
    "layers": PiecewiseConstantMedium([-5, 0.0, 5], [1, 2], albedo=0.5),
    "nearest": VoxelGrid(np.ones((2, 2, 2)), **BOX, interpolation="nearest", albedo=0.5),
    "trilinear": VoxelGrid(np.ones((2, 2, 2)), **BOX, albedo=0.5),
    "anisotropic": AnisotropicMedium(2, np.diag([1, 1, 4]), albedo=0.5),
    "opengl": OpenGLFog("exp2", 0.5),
    "function": Procedural(lambda x: 0.5 + 0.1 * np.sin(x[..., 0]), majorant=0.6, albedo=0.5, **BOX),
}
LIGHTS = (
    PointLight((0, 1, 0), 1.0),
    PointLight((0, 0, 0), 1.0),
    DirectionalLight((0, 0, -1), 1.0),
    SphereLight((0, 3, 0), 1, 1.0),
)
BOTH = Ray((0, 0, 0), (0, 0, 1), [0.0, 0.25])
NONE = Ray((0, 0, 0), (0, 0, 1), 0.0)
WAYS = {
    "transmittance": (lambda m: analytic.transmittance(m, BOTH), 1),
    "optical_thickness": (lambda m: analytic.optical_thickness(m, BOTH), 0),
    "ambient_fog": (lambda m: analytic.ambient_fog(m, BOTH, 0.5, 3.0), 3),
    "emitted_radiance": (lambda m: analytic.emitted_radiance(m, BOTH), 0),
    "by_quadrature": (lambda m: analytic.radiance_by_quadrature(m, BOTH, 0.5, 3.0), 3),
    "by_ode": (lambda m: analytic.radiance_by_ode(m, BOTH, 0.5, 3.0), 3),
    "variance": (lambda m: analytic.transmittance_variance(m, BOTH, tracking="delta"), 0),
    "nothing to reach": (lambda m: analytic.free_path(m, BOTH, 0.0), 0),
    "too far to reach": (lambda m: analytic.free_path(m, BOTH, 0.1), np.inf),
}


@pytest.mark.parametrize("medium", MEDIA.values(), ids=MEDIA)
@pytest.mark.parametrize(("ask", "value"), WAYS.values(), ids=WAYS)
def test_oracle(medium, ask, value):
    found = ask(medium)
    assert (found.value[0] == value).all()
    assert (found.error[0] <= 1e-11).all()
    assert np.isfinite(found.error).all()


@pytest.mark.parametrize("medium", MEDIA.values(), ids=MEDIA)
def test_single_scattering(medium):
    for light in (*LIGHTS, Environment(1.0)):
        found = analytic.single_scattering(medium, NONE, light)
        assert not found.value.any()
        assert (found.error <= 1e-300).all()


@pytest.mark.parametrize("medium", MEDIA.values(), ids=MEDIA)
def test_estimators(medium):
    answered = 0
    for light in (None, *LIGHTS):
        asked = {"scattering": "single", "light": light} if light else {"scattering": "ambient", "ambient": 0.5}
        try:
            estimator = estimator_for(Scene(medium, NONE, background=3.0, **asked))
        except UnsupportedError:
            continue
        assert (estimator.draw(np.random.default_rng(1), 5).value == 3).all()
        answered += 1
    assert answered >= 3
