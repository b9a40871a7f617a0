"""The radiance of a scene is the sum of its terms, and each level of scattering adds to the one below."""

import numpy as np
import pytest

from fogproof import analytic
from fogproof.scene import Medium, PointLight, Ray, Scene
from fogproof.scene.lights import Environment
from fogproof.scene.occluders import Sphere

RAY = Ray(np.zeros((4, 3)), (0, 0, 1), [0.5, 1.0, 2.0, np.inf])
LAMP = PointLight((0.3, 0.4, 1.0), 2.0)


@pytest.mark.parametrize(
    ("medium", "light", "background", "shape"),
    [
        (Medium(0.2, 0.5, emission=0.7), LAMP, 0.4, (4,)),
        (Medium((0.2, 0.1, 0.0), 0.5 * np.ones(3)), LAMP, 0.4, (4, 3)),
        (Medium(0.2, 0.5), PointLight((0.3, 0.4, 1.0), (1.0, 2.0)), 0.4, (4, 2)),
        (Medium(0.2, 0.5), LAMP, (0.1, 0.2), (4, 2)),
    ],
)
def test_single_scattering_is_added_to_what_is_there_without(medium, light, background, shape):
    dark = analytic.radiance(Scene(medium, RAY, background=background))
    lit = analytic.radiance(Scene(medium, RAY, "single", light, background=background))
    airlight = analytic.single_scattering(medium, RAY, light)
    assert lit.value.shape == shape

    def channels(value):
        return value if value.shape == shape else value[..., None]

    np.testing.assert_allclose(lit.value, channels(dark.value) + channels(airlight.value), rtol=1e-15)
    assert np.all(lit.error >= channels(airlight.error))


def test_ambient_is_the_lerp():
    scene = Scene(Medium(0.2, 0.5), RAY, "ambient", ambient=0.3, background=0.4)
    np.testing.assert_array_equal(
        analytic.radiance(scene).value, analytic.ambient_fog(scene.medium, RAY, 0.3, 0.4).value
    )


def test_an_occluder_takes_light_away_and_an_unused_light_changes_nothing():
    medium = Medium(0.2, 0.5)
    lit = analytic.radiance(Scene(medium, RAY, "single", LAMP))
    shadowed = analytic.radiance(Scene(medium, RAY, "single", LAMP, occluders=(Sphere((0.15, 0.2, 1.0), 0.05),)))
    assert np.all(shadowed.value[1:] < lit.value[1:])
    assert abs(shadowed.value[0] - lit.value[0]) <= shadowed.error[0] + lit.error[0], (
        "the shadow begins beyond half a metre"
    )
    unused = analytic.radiance(Scene(medium, RAY, "none", Environment(5.0), background=0.1))
    np.testing.assert_array_equal(unused.value, analytic.radiance(Scene(medium, RAY, background=0.1)).value)
