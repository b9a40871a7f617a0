"""Scenes validate themselves: every fault is one sentence that names argument, value, rule and, where there is one, the fix."""

import math

import numpy as np
import pytest

from fogproof import HenyeyGreenstein, InvalidValueError, Isotropic, Medium, PointLight, Ray, Scene
from fogproof.errors import InvalidInputError
from fogproof.scene.files import read_scene
from fogproof.validate import as_float_array

ORIGIN, FORWARD = (0, 0, 0), (0, 0, 1)

BAD_VALUES = [
    (lambda: Medium(-0.2, 1.0), r"sigma_a must be finite and >= 0 \[1/m\], got -0.2"),
    (lambda: Medium(0.1, math.nan), r"sigma_s must be finite and >= 0 \[1/m\], got nan"),
    (lambda: Medium(0.1, math.inf), r"sigma_s must be finite"),
    (lambda: Medium("thick", 1.0), r"sigma_a must be a number or an array of numbers, got 'thick'"),
    (lambda: Medium((0.1, 0.2), (0.1, 0.2, 0.3)), r"as many channels"),
    (lambda: Medium(0.1, 0.2, phase=0.5), r"phase must be a phase function, got 0.5"),
    (lambda: Medium(0.1, 0.2, emission=-1), r"emission must be finite and >= 0 \[W/\(m\^2 sr\)\], got -1.0"),
    (lambda: HenyeyGreenstein(1.0), r"g must lie in the open interval \(-1, 1\), got 1.0; at the ends"),
    (lambda: HenyeyGreenstein(-1.0), r"open interval"),
    (lambda: HenyeyGreenstein(math.nan), r"open interval"),
    (lambda: Ray(ORIGIN, FORWARD, np.nan), r"length must be >= 0 \[m\], got nan"),
    (lambda: Ray(ORIGIN, FORWARD, -2.0), r"length must be >= 0 \[m\], got -2.0"),
    (lambda: Ray(ORIGIN, (0, 0, 2), 1.0), r"direction must have unit length, got 2.0; divide"),
    (lambda: Ray(ORIGIN, (0, 0), 1.0), r"direction must have three coordinates"),
    (lambda: Ray((0, math.nan, 0), FORWARD, 1.0), r"origin must be finite, got nan"),
    (lambda: Ray(np.zeros((2, 3)), np.tile(FORWARD, (3, 1)), 1.0), r"broadcast"),
    (lambda: PointLight((0, 0), 1.0), r"position must have three coordinates"),
    (lambda: PointLight((0, 0, 0), -1.0), r"intensity must be finite and >= 0 \[W/sr\], got -1.0"),
    (lambda: Scene(Medium(0, 1), Ray(ORIGIN, FORWARD), "single"), r"light must be given when scattering is 'single'"),
    (lambda: Scene(Medium(0, 1), Ray(ORIGIN, FORWARD), "double"), r"scattering must be one of none, ambient, single"),
]


@pytest.mark.parametrize(("build", "message"), BAD_VALUES)
def test_bad_values_are_explained(build, message):
    with pytest.raises(InvalidValueError, match=message):
        build()


SCENE = """
scattering = "single"
[medium]
sigma_a = 0.1
sigma_s = [0.2, 0.3, 0.4]
phase = { kind = "henyey-greenstein", g = 0.3 }
[ray]
origin = [0, 0, 0]
direction = [0, 0, 1]
length = inf
[light]
position = [0, 1, 2]
intensity = 3
"""

BAD_FILES = [
    ("sigma_a = 0.1", "sigma_a = -0.1", "sigma_a must be finite and >= 0 .* in scene.medium"),
    ("sigma_a = 0.1", "sigma_a = true", "scene.medium.sigma_a must be a number, got True"),
    ("sigma_a = 0.1", 'sigma_a = "0.1"', "scene.medium.sigma_a must be a number, got '0.1'"),
    ("sigma_a = 0.1", "sigma_x = 0.1", r"scene.medium.sigma_\w is (missing|not a known key)"),
    ("g = 0.3", "g = 1", r"g must lie in the open interval \(-1, 1\), got 1.0 in scene.medium.phase"),
    ("g = 0.3", "k = 1", "scene.medium.phase.[gk] is"),
    ("henyey-greenstein", "mie-scattering", "scene.medium.phase has kind 'mie-scattering'; known are 'isotropic'"),
    ('kind = "henyey-greenstein", ', "", "scene.medium.phase needs a key 'kind'"),
    ("length = inf", "length = -1", "length must be >= 0 .* in scene.ray"),
    ("direction = [0, 0, 1]", "direction = [0, 1, 1]", "direction must have unit length, got 1.414.* in scene.ray"),
    ("direction = [0, 0, 1]", 'direction = "up"', "must be a number or an array of numbers, got 'up'"),
    ('scattering = "single"', 'scattering = "all"', "scene.scattering must be .*got 'all'"),
    ('scattering = "single"', "colour = 3", "scene.colour is not a known key"),
    ("intensity = 3", "intensity = [1, 2]", "as many channels"),
    ("[light]", "[light", "not valid TOML"),
]


def test_a_scene_file_is_read(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    scene = read_scene(path)
    assert scene.medium.phase == HenyeyGreenstein(0.3)
    assert scene.medium.sigma_s == (0.2, 0.3, 0.4)
    assert np.isinf(scene.ray.length)
    np.testing.assert_allclose(scene.medium.sigma_t, [0.3, 0.4, 0.5])


@pytest.mark.parametrize(("good", "bad", "message"), BAD_FILES)
def test_bad_files_are_explained(tmp_path, good, bad, message):
    path = tmp_path / "scene.toml"
    assert good in SCENE
    path.write_text(SCENE.replace(good, bad))
    with pytest.raises((InvalidInputError, InvalidValueError), match=message) as caught:
        read_scene(path)
    assert str(path) in str(caught.value)


def test_a_file_that_cannot_be_read_is_explained(tmp_path):
    with pytest.raises(InvalidInputError, match=r"cannot read the scene file .*No such file"):
        read_scene(tmp_path / "nowhere.toml")
    (tmp_path / "noise.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InvalidInputError, match="not UTF-8"):
        read_scene(tmp_path / "noise.toml")


def test_derived_coefficients_of_an_empty_medium():
    empty = Medium(0.0, 0.0)
    assert empty.albedo == 0
    assert empty.mean_free_path == np.inf
    assert Medium(0.0, 0.0).phase == Isotropic()


def test_a_direction_normalised_in_single_precision_is_taken():
    direction = np.array([1, 2, 3], dtype=np.float32)
    direction /= np.linalg.norm(direction)
    ray = Ray(ORIGIN, direction, 1.0)
    assert abs(np.linalg.norm(ray.direction) - 1) < 1e-15


def test_no_number_of_a_scene_is_a_negative_zero():
    """The sign of a zero would choose a branch of arctan2 or of a quotient."""
    assert not np.signbit(as_float_array("x", [-0.0, 0.0])).any()
    assert not np.signbit(Ray((-0.0, 0, 0), (-0.0, 0, 1)).origin).any()
