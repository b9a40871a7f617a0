"""Scenes for pbrt-v4 follow the grammar of its documentation, and say what the scene says; pbrt itself does not run here."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fogproof.errors import UnsupportedError
from fogproof.renderers.pbrt import pbrt_text
from fogproof.scene import Film, ImageScene, Medium, Perspective
from fogproof.scene.files import read_image_scene
from fogproof.scene.shapes import Ball

SCENES = Path(__file__).parents[2] / "scenes" / "images"
TOKEN = re.compile(r'"[^"]*"|\[|\]|[A-Za-z]+|-?\d+\.?\d*(?:[eE][-+]?\d+)?')
NUMBERS = {"Scale": 3, "LookAt": 9, "Translate": 3, "WorldBegin": 0, "AttributeBegin": 0, "AttributeEnd": 0}
NAMED = {
    "Camera",
    "Film",
    "PixelFilter",
    "Sampler",
    "Integrator",
    "LightSource",
    "Material",
    "Shape",
    "MakeNamedMedium",
}
TYPES = {"float": float, "integer": int, "string": str, "rgb": float, "spectrum": float, "point3": float}


def parsed(text):
    """Return (directive, what follows, parameters) of each statement, or fail where the grammar is left."""
    assert not TOKEN.sub("", text).strip(), TOKEN.sub("", text).strip()
    words, found = TOKEN.findall(text), []
    while words:
        name = words.pop(0)
        if name == "MediumInterface":
            found.append((name, [words.pop(0).strip('"'), words.pop(0).strip('"')], {}))
            continue
        if name in NUMBERS:
            found.append((name, [float(words.pop(0)) for _ in range(NUMBERS[name])], {}))
            continue
        assert name in NAMED, name
        kind, parameters = words.pop(0).strip('"'), {}
        while words and words[0].startswith('"'):
            sort, key = words.pop(0).strip('"').split()
            assert words.pop(0) == "["
            values = []
            while words[0] != "]":
                values.append(TYPES[sort](words.pop(0).strip('"')))
            words.pop(0)
            parameters[key] = values
        found.append((name, kind, parameters))
    return found


def of(name):
    return parsed(pbrt_text(read_image_scene(SCENES / f"{name}.toml")))


def test_a_slab_under_the_sun():
    statements = of("sun")
    table = {name: (kind, parameters) for name, kind, parameters in statements}
    assert [name for name, *_ in statements].index("WorldBegin") > [name for name, *_ in statements].index("Camera")
    assert table["Scale"][0] == [-1, 1, 1]
    assert table["Integrator"] == ("volpath", {"maxdepth": [1]})
    fov = 2 * math.atan(math.tan(0.35) * 36 / 48)
    assert table["Camera"][1]["fov"] == pytest.approx([math.degrees(fov)])
    assert table["MakeNamedMedium"][1]["sigma_s"] == [200, 0.5, 1000, 0.5]
    assert table["MakeNamedMedium"][1]["g"] == [0.6]
    kind, light = table["LightSource"]
    assert (kind, light["to"], light["L"]) == ("distant", pytest.approx([0.48, -0.6, 0.64]), [3.0] * 3)
    assert table["MediumInterface"][0] == ["fog", ""]
    corners = np.reshape(table["Shape"][1]["P"], (8, 3))
    assert sorted(set(corners[:, 2].round(12))) == [0.0, 2.0]
    faces = np.reshape(table["Shape"][1]["indices"], (12, 3))
    a, b, c = (corners[faces[:, i]] for i in range(3))
    volume = float(np.sum(np.cross(a, b) * c)) / 6  # the divergence theorem: closed, and all faces turned alike
    assert abs(volume) == pytest.approx(2e3 * 2e3 * 2)


def test_a_camera_inside_is_told_of_the_medium_before_it():
    camera = Perspective((0, 0, 0.5), (0, 0, 2), 0.6, Film(8, 8))
    scene = ImageScene(Medium(0.2, 0.0), camera, shape=Ball((0, 0, 0), 1.0), background=1.0)
    names = [name for name, *_ in parsed(pbrt_text(scene))]
    assert names.index("MediumInterface") < names.index("Camera")
    away = replace(scene, camera=replace(camera, origin=(0, 0, -2.0)))
    names = [name for name, *_ in parsed(pbrt_text(away))]
    assert names.index("MediumInterface") > names.index("Camera")


def test_a_ball_and_its_lamp():
    table = {name: (kind, parameters) for name, kind, parameters in of("ball")}
    assert table["Shape"] == ("sphere", {"radius": [1.0]})
    assert table["LightSource"] == ("point", {"from": [0.3, 0.4, -0.2], "I": [4.0] * 3})


@pytest.mark.parametrize("name", ["ambient-fog", "emissive-fog", "voxels-nearest", "occluder", "spot-linear", "box"])
def test_what_is_not_translated_is_refused_by_name(name):
    with pytest.raises(UnsupportedError, match="is not translated for pbrt"):
        of(name)
