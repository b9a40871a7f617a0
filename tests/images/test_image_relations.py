"""Relations of images: the oracle keeps them all, each fault breaks the one that isolates it, and a command is held to them."""

import json
import shlex
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from fogproof.analytic import image
from fogproof.cli.commands import cli
from fogproof.errors import FogproofError, UnsupportedError
from fogproof.images.battery import Battery, image_relations, planned
from fogproof.relations import IMAGE_RELATIONS, ImageSetting, comparisons
from fogproof.relations.moved import brightened, changed, mirrored, scaled, translated, turned
from fogproof.reports import prepare_folder
from fogproof.scene import (
    Film,
    HenyeyGreenstein,
    ImageScene,
    LinearMedium,
    Medium,
    OneRay,
    OpenGLFog,
    Orthographic,
    Perspective,
    VoxelGrid,
)
from fogproof.scene.lights import DirectionalLight, Environment, RectangleLight, SpotLight
from fogproof.scene.occluders import Disk
from fogproof.scene.shapes import Box, HalfSpace, Slab
from fogproof.scene.to_json import to_json

FILM = Film(24, 18)
EYE = Perspective((0.1, 0.0, -3.0), (0.0, 0.1, 0.0), 0.6, FILM)
LAYER = Slab((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 1.0)
WIDE = Box((-3.0, -3.0, -0.5), (3.0, 3.0, 0.5))
RAY = OneRay((0.1, -0.2, -3.0), (0.0, 0.1, 0.0), FILM)
BOX = Box((-1.0, -0.7, -0.5), (0.9, 0.8, 0.5))
CELLS = np.random.default_rng(5).uniform(0.2, 3.0, (2, 3, 2))

SCENES = {
    "slab": ImageScene(Medium(0.3, 0.0), EYE, shape=LAYER, background=2.0),
    "thick": ImageScene(
        Medium(3.0, 0.0), Perspective((0.0, 0.0, -3.0), (1.5, 0.7, 0.0), 1.4, FILM), shape=LAYER, background=2.0
    ),
    "box": ImageScene(Medium(0.5, 0.0), EYE, shape=WIDE, background=2.0),
    "grid": ImageScene(VoxelGrid(CELLS, BOX.lower, BOX.upper, "nearest"), RAY, background=1.0),
    "trilinear": ImageScene(VoxelGrid(CELLS, BOX.lower, BOX.upper), RAY, background=1.0),
    "colour": ImageScene(Medium((0.1, 0.4, 0.9), 0.0), EYE, shape=LAYER, background=1.0),
    "sun": ImageScene(
        Medium(0.2, 0.8, HenyeyGreenstein(0.5)), RAY, "single", DirectionalLight((0.6, 0.0, 0.8), 3.0), LAYER
    ),
    "sky": ImageScene(Medium(0.2, 0.8), RAY, "single", DirectionalLight((0.0, 0.6, 0.8), 1.0), LAYER, background=0.2),
    "deep": ImageScene(
        Medium(0.2, 0.5),
        OneRay((0.0, 0.0, -2.0), (0.3, 0.0, 0.0), FILM),
        "multiple",
        Environment(1.0),
        HalfSpace((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)),
        background=1.0,
    ),
    "fog": ImageScene(Medium(0.2, 0.3), replace(EYE, wall=4.0), "ambient", ambient=0.7, background=0.3),
}  # fmt: skip


def shown(scene):
    """Return the oracle's image in the shape that renderers give."""
    value = np.asarray(image(scene).value)
    return value if value.ndim == 3 else value[..., None]


def of(terms):
    total = 0.0
    for term in terms:
        value = np.ones((1, 1, 1)) if term.setting is None else shown(term.setting.scene)
        value = value if term.channel is None else value[..., term.channel : term.channel + 1]
        total = total + term.factor * (value if term.view is None else term.view(value))
    return total


@pytest.mark.parametrize("name", SCENES)
def test_the_oracle_keeps_every_relation(name):
    """Both sides are the same to 1e-6, whatever has been done to the scene: no relation is wrong by itself."""
    scene = replace(SCENES[name], camera=replace(SCENES[name].camera, film=Film(8, 8)))
    kept = 0
    for comparison in comparisons(ImageSetting(scene)):
        try:
            first, second = of(comparison.first), of(comparison.second)
        except FogproofError:
            continue  # the oracle has no such scene
        np.testing.assert_allclose(*np.broadcast_arrays(first, second), rtol=1e-6, err_msg=comparison.name)
        kept += 1
    assert kept >= 12


def test_between_them_the_scenes_allow_every_relation():
    names = {one.name.partition("/")[0] for scene in SCENES.values() for one in comparisons(ImageSetting(scene))}
    assert len(names) >= len(IMAGE_RELATIONS)


class Renderer:
    """The oracle's image with noise of one in fifty, a gamma law; `fault` alters the setting or the pixels."""

    def __init__(self, fault=None, noise=2e-2):
        self.rng, self.fault, self.noise, self.known = (
            np.random.default_rng(),
            fault or (lambda setting, draw: draw(setting)),
            noise,
            {},
        )

    def __call__(self, setting, which):
        return np.float32(self.fault(setting, self.draw))

    def draw(self, setting):
        key = json.dumps(to_json(setting.scene))
        if key not in self.known:
            try:
                self.known[key] = shown(setting.scene)
            except FogproofError as error:
                raise UnsupportedError(str(error), "scene") from None
        count = setting.more / self.noise**2
        return self.known[key] * self.rng.gamma(count, 1 / count, self.known[key].shape)


def battery(scene, fault=None, only=None, **options):
    how = Battery(Renderer(fault), ("a", "b"), threads=True, oracle=False, **options)
    wanted = [one for one in planned(scene, how) if only is None or one.name.startswith(only)]
    return {one.name: one for one in image_relations(scene, how, wanted)}


@pytest.mark.parametrize("name", ["grid", "colour", "sky"])
def test_a_right_renderer_keeps_every_relation(name):
    results = battery(SCENES[name])
    assert not [one for one in results.values() if one.outcome == "rejected"]
    assert sum(one.outcome == "not rejected" for one in results.values()) >= 12


def medium_of(scene, **changes):
    return replace(scene, medium=replace(scene.medium, **changes))


def ignores_the_transform(setting, draw):
    """The density of a grid is looked up where the grid would be if it stood at the origin."""
    medium = setting.medium
    if isinstance(medium, VoxelGrid) and np.any(np.abs(medium.lower + medium.upper) > 20):
        return draw(setting.but(medium=replace(medium, sigma_t=np.roll(medium.sigma_t, 1, axis=0))))
    return draw(setting)


def majorant_of_one_channel(setting, draw):
    if setting.medium.channels:
        sigma = tuple(min(x, setting.medium.sigma_a[0]) for x in setting.medium.sigma_a)
        return draw(setting.but(medium=replace(setting.medium, sigma_a=sigma)))
    return draw(setting)


def offset_by_coordinates(setting, draw):
    shape = setting.shape
    if isinstance(shape, Slab):
        far = 4e-4 * max(abs(x) for x in setting.scene.camera.origin)
        shape = replace(shape, thickness=max(shape.thickness - far, 0.5 * shape.thickness))
    return draw(setting.but(shape=shape))


def offset_in_metres(setting, draw):
    shape = setting.shape
    if isinstance(shape, Slab):
        shape = replace(shape, thickness=max(shape.thickness - 4e-4, 0.5 * shape.thickness))
    return draw(setting.but(shape=shape))


def dim_grid(setting, draw):
    grid = isinstance(setting.medium, VoxelGrid)
    return draw(setting.but(medium=replace(setting.medium, sigma_t=1.2 * setting.medium.sigma_t)) if grid else setting)


def exceeded_majorant(setting, draw):
    """The majorant is a tenth of the largest value, which a far voxel lifts."""
    medium = setting.medium
    if isinstance(medium, VoxelGrid):
        top = 0.1 * float(np.max(medium.sigma_t))
        return draw(setting.but(medium=replace(medium, sigma_t=np.minimum(medium.sigma_t, top))))
    return draw(setting)


def lost_border(setting, draw):
    medium = setting.medium
    cells = np.array(medium.sigma_t)
    cells[0] = 0
    return draw(setting.but(medium=replace(medium, sigma_t=cells)))


def second_order(setting, draw):
    """Light that scatters twice is there: more of it, the square of the albedo."""
    value = draw(setting)
    return value if setting.scene.scattering != "single" else value * (1 + 0.3 * float(np.max(setting.medium.albedo)))


def of_g(setting, draw):
    return draw(setting) * (1.1 if setting.medium.phase == HenyeyGreenstein(0.0) else 1.0)


def wrong_integrator(setting, draw):
    return draw(setting) * (1.05 if setting.integrator == "b" else 1.0)


def of_the_seed(setting, draw):
    return draw(setting) * (1 + 0.05 * setting.copy)


def lost_rows(setting, draw):
    value = draw(setting)
    return value if setting.threads < 5 else value * (np.arange(len(value)) >= 2)[:, None, None]


def no_help(setting, draw):
    return draw(replace(setting, more=1))


def crop_off_by_one(setting, draw):
    camera = setting.scene.camera
    if camera.film.crop:
        x, y, width, height = camera.film.crop
        camera = replace(camera, film=replace(camera.film, crop=(x + 4, y, width, height)))
    return draw(setting.but(camera=camera))


def a_pixel_to_the_right(setting, draw):
    return np.roll(draw(setting), 1, axis=1)


def no_sign(setting, draw):
    light = setting.light
    if isinstance(light, DirectionalLight):
        light = replace(light, direction=(abs(light.direction[0]), *light.direction[1:]))
    return draw(setting.but(light=light))


def cosine(setting, draw):
    normal = getattr(setting.shape, "normal", getattr(setting.medium, "axis", None))
    if not isinstance(setting.light, DirectionalLight) or normal is None:
        return draw(setting)
    ahead = np.subtract(setting.scene.camera.target, setting.scene.camera.origin)
    return draw(setting) * abs(ahead @ np.asarray(normal)) / np.linalg.norm(ahead)


FAULTS = {
    "transform": (ignores_the_transform, "grid", {"moved/30", "moved/500"}),
    "channel": (majorant_of_one_channel, "colour", {"channel-alone/1", "channel-alone/2"}),
    "coordinates": (offset_by_coordinates, "slab", {"moved/500"}),
    "metres": (offset_in_metres, "sun", {"scaled/0.001"}),
    "grid": (dim_grid, "box", {"constant-grid/nearest", "constant-grid/trilinear"}),
    "majorant": (exceeded_majorant, "grid", {"far-voxel"}),
    "border": (lost_border, "grid", {"finer-grid", "empty-rim", "far-voxel", "mirrored", "turned"}),
    "layers": (lambda s, draw: draw(s) * (0.9 if not isinstance(s.medium, Medium) else 1), "slab", {"cut-slab"}),
    "clamp": (lambda s, draw: np.minimum(draw(s), 100.0), "slab", {"linear-in-light"}),
    "orders": (second_order, "sun", {"orders"}),
    "isotropic": (of_g, "sky", {"isotropic"}),
    "integrator": (wrong_integrator, "slab", {"integrators/b"}),
    "seed": (of_the_seed, "slab", {"seeds"}),
    "threads": (lost_rows, "slab", {"threads"}),
    "noise": (no_help, "slab", {"more-samples"}),
    "crop": (crop_off_by_one, "thick", {"cropped"}),
    "pixels": (a_pixel_to_the_right, "thick", {"finer-film", "cropped", "mirrored"}),
    "sign": (no_sign, "sun", {"mirrored", "reciprocity"}),
    "cosine": (cosine, "sun", {"reciprocity"}),
    "energy": (lambda s, draw: 0.97 * draw(s), "slab", {"furnace"}),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_breaks_the_relation_that_isolates_it(name):
    fault, scene, expected = FAULTS[name]
    results = battery(SCENES[scene], fault)
    broken = {one.name for one in results.values() if one.outcome == "rejected"}
    assert broken
    assert broken <= expected


def test_the_oracle_says_which_side_is_wrong():
    how = Battery(Renderer(offset_in_metres), seeds=False)
    wanted = [one for one in planned(SCENES["sun"], how) if one.name in ("scaled/0.001", "scaled/100")]
    small, large = sorted(image_relations(SCENES["sun"], how, wanted), key=lambda one: one.outcome != "rejected")
    assert (small.name, small.second, small.reason) == (
        "scaled/0.001",
        "rejected",
        "the second side is not the oracle's",
    )
    assert large.outcome != "rejected"


def test_a_fault_that_both_sides_share_is_seen_by_the_oracle_alone():
    def half(setting, draw):
        return 0.5 * draw(setting)

    (alone,) = battery(SCENES["sun"], half, "turned").values()
    assert alone.outcome == "not rejected"
    how = Battery(Renderer(half))
    (held,) = image_relations(SCENES["sun"], how, [one for one in planned(SCENES["sun"], how) if one.name == "turned"])
    assert (held.outcome, held.reason) == ("rejected", "both sides are not the oracle's")


def test_two_black_images_are_no_pass():
    (row,) = battery(SCENES["slab"], lambda setting, draw: 0 * draw(setting), "turned").values()
    assert row.outcome == "inconclusive"


@pytest.mark.parametrize(
    ("medium", "axis"),
    [(LinearMedium(0.3, (0.1, 0.2, 0.0)), 0), (OpenGLFog("exp", 0.3), None)],
    ids=["linear", "opengl"],
)
def test_a_medium_that_hangs_on_the_origin_is_moved_or_refused(medium, axis):
    scene = ImageScene(medium, Orthographic((0.0, 0.0, -1.0), (0.0, 0.0, 0.0), 0.1, FILM, wall=2.0), background=1.0)
    names = {one.name for one in comparisons(ImageSetting(scene))}
    assert ("moved/30" in names) == ("mirrored" in names) == (axis is not None)


def test_every_field_of_a_scene_is_moved_or_known_to_stay():
    """A field that nobody has thought of would stay where it was, and a right renderer would be accused."""
    lamp = RectangleLight((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 2.0)
    setting = ImageSetting(replace(SCENES["slab"], light=lamp, occluders=(Disk((0, 0, 1), (0, 0, 1), 0.5),)))
    there = mirrored(setting)
    assert there.light.edge_u == lamp.edge_v
    assert there.scene.occluders[0].center == (0.0, 0.0, 1.0)
    assert translated(setting, (1.0, 2.0, 3.0)).scene.occluders[0].center == (1.0, 2.0, 4.0)
    assert scaled(setting, 10.0).scene.camera.film == setting.scene.camera.film
    assert turned(setting).scene.camera.origin == (-3.0, 0.1, 0.0)
    spot = SpotLight((0.0, 0.0, -1.0), (0.0, 0.0, 1.0), 2.0, 0.5)
    assert brightened(setting.but(light=spot), 3.0).light.intensity == 6.0
    assert scaled(setting.but(light=spot), 10.0).light.intensity == 200.0
    with pytest.raises(UnsupportedError, match="cannot be moved"):
        changed(OpenGLFog("exp", 0.3), lambda what, value: value)


PROGRAM = Path(__file__).parents[1] / "data" / "absorbing_renderer.py"
IMAGES = Path(__file__).parents[2] / "scenes" / "images"


def relations(out, *arguments, scene="absorbing-slab", fault="none"):
    words = [sys.executable, str(PROGRAM), "{scene}", "{out}.npy", "--samples", "{samples}", "--seed", "{seed}"]
    command = shlex.join([*words, "--fault", fault])
    given = [str(IMAGES / f"{scene}.toml"), "--with", command, "-o", str(out), "--samples", "16", "--renders", "1"]
    return CliRunner().invoke(cli, ["relations", *given, *arguments], standalone_mode=False)


def test_a_command_that_is_right_keeps_what_it_can_render(tmp_path):
    ran = relations(tmp_path, "--only", "moved/500", "--only", "mirrored")
    assert (ran.return_value, ran.output.count("  not rejected  ")) == (0, 2)
    record = json.loads((tmp_path / "results.json").read_text())
    assert [row["relation"] for row in record["rows"]] == ["moved/500", "mirrored"]
    assert "mirrored" in (tmp_path / "index.html").read_text()
    prepare_folder(tmp_path, ("index.html", "results.json"))  # it is seen to be ours


def test_a_command_with_a_fault_fails_by_the_right_relation_and_is_taken_up_again(tmp_path):
    wanted = ("--only", "moved/500", "--only", "fov-axis")
    ran = relations(tmp_path, *wanted, "--json", fault="offset")
    rows = {row["relation"]: row for row in map(json.loads, ran.stdout.splitlines())}
    assert ran.return_value == 1
    assert {name for name, row in rows.items() if row["outcome"] == "rejected"} == {"moved/500"}
    assert "offsets of rays" in rows["moved/500"]["isolates"]
    assert rows["moved/500"]["reason"] == "the second side is not the oracle's"
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.npy")}
    assert relations(tmp_path, *wanted, fault="offset").return_value == 1
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.npy")} == kept


def test_what_a_program_cannot_render_is_said(tmp_path):
    ran = relations(tmp_path, "--only", "turned", scene="sun")
    assert ran.return_value == 3
    assert "scattering is not translated" in ran.output


def test_a_program_that_fails_ends_its_scene_with_its_last_words(tmp_path):
    ran = relations(tmp_path, "--only", "turned", fault="crash")
    assert ran.return_value == 3
    assert "ZeroDivisionError" in ran.output


def test_a_name_that_no_relation_has_is_told(tmp_path):
    assert "no relation of these scenes is named luck" in str(relations(tmp_path, "--only", "luck").exception)
    twice = relations(tmp_path, "--only", "turned", "--only", "luck", scene="sun")
    assert "named luck" in str(twice.exception)
