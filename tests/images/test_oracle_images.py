"""Invariant: `fogproof oracle scene.toml -o` writes the oracle's image; a faulty scene is one sentence with its key."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from fogproof.analytic import image
from fogproof.cli.commands import cli, main
from fogproof.errors import FogproofError
from fogproof.images.formats import format_of
from fogproof.scene.files import read_image_scene

LAMP = Path(__file__).parents[2] / "scenes" / "images" / "lamp-inside-forward.toml"
SMALL = LAMP.read_text().replace("width = 48, height = 36", "width = 6, height = 4")


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


@pytest.mark.parametrize("suffix", ["exr", "npy", "pfm"])
def test_the_image_is_written(small, tmp_path, suffix):
    out = tmp_path / f"a.{suffix}"
    ran = CliRunner().invoke(cli, ["oracle", str(small), "-o", str(out)], standalone_mode=False)
    assert ran.exception is None
    wanted = image(read_image_scene(small))
    channels = format_of(out).read(out)
    assert channels["Y"] == pytest.approx(wanted.value, rel=1e-7)
    if suffix == "exr":
        assert (channels["error.Y"] <= 1.001 * wanted.error.astype(np.float32)).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("[camera]", "[view]"), "camera is missing"),
        (
            ('"perspective"', '"fisheye"'),
            "camera has kind 'fisheye'; known are 'perspective', 'orthographic', 'one-ray'",
        ),
        (("width = 6", "width = 0"), "width must be a whole number of pixels"),
        (("fov = 0.7", "fov = 40"), r"fov must lie in \(0, pi\)"),
        (('"single"', '"double"'), "scattering"),
        (("intensity = 5", "intensity = -5"), "intensity must be"),
    ],
)
def test_faults_of_a_scene_are_named(small, change, words):
    small.write_text(SMALL.replace(*change))
    with pytest.raises(FogproofError, match=words):
        read_image_scene(small)


def test_a_bad_scene_ends_with_2(small, tmp_path, capsys):
    small.write_text("[camera]")
    with pytest.raises(SystemExit) as end:
        main(["oracle", str(small), "-o", str(tmp_path / "a.exr")])
    assert end.value.code == 2
    assert "small.toml" in capsys.readouterr().err


def test_json_is_a_scene_too(small, tmp_path):
    import json
    import tomllib

    path = tmp_path / "a.json"
    path.write_text(json.dumps(tomllib.loads(SMALL)))
    assert image(read_image_scene(path)).value.tolist() == image(read_image_scene(small)).value.tolist()


SCENES = sorted(LAMP.parent.glob("*.toml"))
QUICK = ("absorbing-slab", "ambient-fog", "box", "camera-inside", "emissive-fog", "sun", "white-furnace")


def test_every_scene_says_what_it_is_for_and_has_its_reference():
    assert len(SCENES) >= 20
    for path in SCENES:
        scene = read_image_scene(path)
        assert len(scene.purpose) > 20
        found = format_of("a.exr").read(path.parent / "references" / f"{path.stem}.exr")
        assert all(pixels.shape == scene.camera.film.shape and np.isfinite(pixels).all() for pixels in found.values())
        assert len(found) == 2 * (scene.channels or 1)


@pytest.mark.parametrize("name", QUICK)
def test_references_are_what_the_oracle_says(name):
    path = LAMP.parent / f"{name}.toml"
    wanted = image(read_image_scene(path))
    found = format_of("a.exr").read(path.parent / "references" / f"{name}.exr")
    assert (np.abs(found["Y"] - wanted.value) <= found["error.Y"] + wanted.error + 1e-6 * wanted.value).all()
