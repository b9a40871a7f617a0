"""Invariant: a scene leaves with every key written out, scripts are Python that needs its renderer alone, and a run of
scenes keeps what it has, says why a scene was not rendered, and never takes a renderer's failure for a verdict."""

import ast
import json
import math
import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest
from click.testing import CliRunner

from fogproof import Environment, Film, HenyeyGreenstein, ImageScene, Medium, OneRay, Perspective, PointLight
from fogproof.analytic import image
from fogproof.children import run as run_program
from fogproof.cli.commands import cli
from fogproof.errors import FogproofError
from fogproof.images.formats import format_of
from fogproof.renderers.table import RENDERERS, renderer_of, script_of
from fogproof.scene import Slab
from fogproof.scene.files import read_image_scene
from fogproof.scene.to_json import to_json

SCENES = sorted((Path(__file__).parents[2] / "scenes" / "images").glob("*.toml"))

OWN = """
import json, math, sys
import numpy as np
scene = json.load(open(sys.argv[1]))
if scene["scattering"] != "none":
    raise SystemExit("this renderer knows no scattering")
film = scene["camera"]["film"]
tau = scene["medium"]["sigma_a"] * scene["camera"]["wall"]
seen = scene["background"] * math.exp(-tau) * float(sys.argv[3])
np.save(sys.argv[2], np.full((film["height"], film["width"]), seen, np.float32))
"""

WALL = """
scattering = "none"
background = 2.0
medium = { sigma_a = 0.5, sigma_s = 0 }
camera = { kind = "one-ray", origin = [0, 0, 0], target = [0, 0, 1], film = { width = 12, height = 12 }, wall = 3 }
"""


def run(*words):
    return CliRunner().invoke(cli, [str(word) for word in words], standalone_mode=False)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_comes_back_from_its_json(path, tmp_path):
    scene = read_image_scene(path)
    assert scene.purpose
    copy = tmp_path / "copy.json"
    copy.write_text(json.dumps(to_json(scene)))
    again = read_image_scene(copy)
    assert to_json(again) == to_json(scene)


@pytest.mark.parametrize("name", RENDERERS)
def test_scripts_need_their_renderer_alone(name):
    scene = read_image_scene(SCENES[0])
    tree = ast.parse(script_of(name, scene))
    imported = {
        alias.name.split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names
    }
    imported |= {node.module.split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert imported <= {
        "__future__",
        "argparse",
        "json",
        "math",
        "typing",
        "numpy",
        "mitsuba",
        "drjit",
        "bpy",
        "mathutils",
    }
    (table,) = [
        node.value.value
        for node in tree.body
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "SCENE"
    ]
    assert json.loads(table) == to_json(scene)


def test_renders_of_ones_own_are_judged_kept_and_told(tmp_path):
    own, folder = tmp_path / "own.py", tmp_path / "out"
    own.write_text(OWN)
    for name, text in {"wall": WALL, "lamp": SCENES_LAMP}.items():
        (tmp_path / f"{name}.toml").write_text(text)
    command = f"{sys.executable} {own} {{scene}} {{out}}.npy 1"
    ran = run("render", tmp_path / "wall.toml", tmp_path / "lamp.toml", "--with", command, "-o", folder, "--json")
    rows = [json.loads(line) for line in ran.stdout.splitlines() if line.startswith("{")]
    assert [row["outcome"] for row in rows] == ["not rejected", "not rendered"]
    assert "this renderer knows no scattering" in rows[1]["reason"]
    assert ran.return_value == 3
    first = (folder / "wall" / "row.json").stat().st_mtime_ns
    again = run("render", tmp_path / "wall.toml", "--with", command, "-o", folder)
    assert again.return_value == 0
    assert "kept: neither the scene nor the command has changed" in again.stdout
    assert (folder / "wall" / "row.json").stat().st_mtime_ns == first
    row = folder / "wall" / "row.json"
    row.write_text(row.read_text().replace("not rejected", "splendid"))
    assert run("render", tmp_path / "wall.toml", "--with", command, "-o", folder).return_value == 0
    wrong = command.removesuffix(" 1") + " 1.01"
    assert run("render", tmp_path / "wall.toml", "--with", wrong, "-o", folder).return_value == 1
    assert "wall" in (folder / "index.html").read_text()


def test_no_renders_replace_what_others_wrote_or_leave_their_folder(tmp_path):
    own, folder = tmp_path / "own.py", tmp_path / "out"
    own.write_text(OWN)
    (tmp_path / "wall.toml").write_text(WALL)
    (tmp_path / "...toml").write_text(WALL)
    command = f"{sys.executable} {own} {{scene}} {{out}}.npy 1"
    (folder / "wall").mkdir(parents=True)
    for name in ("results.json", "maps.exr", "image.exr", "row.json"):
        (folder / "wall" / name).write_text("mine")
        told = run("render", tmp_path / "wall.toml", "--with", command, "-o", folder)
        assert f"{name} was not written by fogproof" in str(told.exception)
        assert (folder / "wall" / name).read_text() == "mine"
        (folder / "wall" / name).unlink()
    away = run("render", tmp_path / "...toml", "--with", command, "-o", folder)
    assert "rename it" in str(away.exception)
    assert run("render", tmp_path / "wall.toml", "--with", command, "-o", folder).return_value == 0


@pytest.mark.parametrize("name", ["index.html", "results.json", "INDEX.HTML", ".."])
@pytest.mark.parametrize("command", ["render", "relations"])
def test_a_scene_is_not_called_as_what_stands_beside_it(tmp_path, command, name):
    scene = tmp_path / f"{name}.toml"
    scene.write_text(WALL)
    rendering = f"touch {tmp_path}/rendered {{scene}} {{out}}"
    told = run(command, scene, "--with", rendering, "-o", tmp_path / "out")
    assert f"written into the folder {name!r}" in str(told.exception)
    assert {path.name for path in tmp_path.iterdir()} == {scene.name}


SCENES_LAMP = WALL.replace('"none"', '"single"') + "light = { position = [0, 1, 1], intensity = 1 }\n"


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (f"{sys.executable} -c pass {{scene}} {{out}}", "wrote no image"),
        (f"{sys.executable} -c 1/0 {{scene}} {{out}}", "ZeroDivisionError"),
    ],
)
def test_a_renderer_that_fails_is_an_error_and_no_verdict(tmp_path, command, words):
    scene = tmp_path / "wall.toml"
    scene.write_text(WALL)
    ran = run("render", scene, "--with", command, "-o", tmp_path / "out")
    assert ran.return_value == 3
    assert words in ran.output


def test_what_is_no_renderer_is_said():
    with pytest.raises(FogproofError, match="No closing quotation"):
        renderer_of("sh -c 'unclosed {scene} {out}")
    with pytest.raises(FogproofError, match="is none of mitsuba, cycles"):
        renderer_of("arnold")


def mitsuba_renders(scene, tmp_path, samples):
    path, out = tmp_path / "scene.json", tmp_path / "out.exr"
    path.write_text(json.dumps(to_json(scene)))
    script = tmp_path / "script.py"
    script.write_text(script_of("mitsuba", scene))
    subprocess.run([sys.executable, script, out, "--samples", str(samples)], check=True, capture_output=True)
    return format_of(out).read(out)["R"]


def test_mitsuba_sees_what_the_oracle_sees(tmp_path):
    pytest.importorskip("mitsuba")
    # What scatters nothing is seen without noise where it is not absorbed: the lower half of the film looks past the slab.
    camera = Perspective((0, 0, 0), (0, 0, 1), 0.8, Film(8, 6))
    scene = ImageScene(Medium(1e6, 0.0), camera, background=3.0, shape=Slab((0, 0.2, 2), (0, 0, -1), 1.0))
    assert (mitsuba_renders(scene, tmp_path, 1) == 0).all()
    clear = ImageScene(
        Medium(0.0, 2.0, HenyeyGreenstein(0.8)), camera, "multiple", Environment(1.5), scene.shape, background=1.5
    )
    assert mitsuba_renders(clear, tmp_path, 64).mean() == pytest.approx(1.5, rel=0.1)


def test_a_single_ray_of_mitsuba_is_judged_right(tmp_path):
    pytest.importorskip("mitsuba")
    from fogproof.images.compare import compare_image

    camera = OneRay((0, 0, -4), (0, 0.2, 0), Film(24, 24))
    scene = ImageScene(
        Medium(0.1, 0.4, HenyeyGreenstein(0.6)),
        camera,
        "single",
        PointLight((0, 1.5, -3), 5.0),
        Slab((0, 0, -1), (0, 0, -1), 2.0),
    )
    mitsuba_renders(scene, tmp_path, 64)
    done = compare_image([tmp_path / "out.exr"], scene, explain=False)
    assert done.verdict.outcome == "not rejected", str(done.verdict)
    assert math.isclose(done.ratios[0][1], 1, abs_tol=0.2)
    assert image(scene).value.shape == (24, 24)


def test_what_a_renderer_writes_takes_no_memory():
    """Nor does a process that it leaves behind keep us waiting for the end of its output."""
    flood = "import os, sys; [(os.write(1, b'y' * 65536), os.write(2, b'z' * 65536)) for _ in range(400)]; "
    leave = "os.fork() or __import__('time').sleep(100); sys.exit('last words')"
    tracemalloc.start()
    try:
        ended = run_program([sys.executable, "-S", "-c", flood + leave], 20)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert (ended.returncode, ended.stdout, ended.stderr[-11:]) == (1, "", "last words\n")
    assert len(ended.stderr) <= 65536
    assert peak < 3e6
