"""A study file says what is wrong with it in one sentence; what is not its content does not identify it."""

import copy
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from study_fixtures import BALL, LIT, RAY, SMALL, kinds, study_from, toml

from fogproof.errors import FogproofError
from fogproof.scene.files import read_scene
from fogproof.study import read_study
from fogproof.study.cells import cells_of, prepare
from fogproof.study.files import differences, study_of
from fogproof.study.methods.table import METHODS, name_of
from fogproof.study.plan import batches_of


def changed(path, value):
    table = copy.deepcopy(SMALL)
    here = table
    *way, last = path
    for key in way:
        here = here[key]
    if value is None:
        del here[last]
    else:
        here[last] = value
    return table


FAULTS = [
    (["samples"], [100, 10], "samples must be rising"),
    (["samples"], [], "samples must be rising"),
    (["samples"], [100, 1000.5], "samples.1"),
    (["replicates"], 2, "replicates must be a whole number >= 4"),
    (["seed"], 10**23, "seed must be a whole number >= 0 and below 2^63"),
    (["alpha"], 2, "alpha must lie in"),
    (["alpha"], 1e-320, "alpha must lie in (0, 1), and not below 1e-100"),
    (["scenes"], [], "scenes is missing"),
    (["scenes", 0, "estimators"], [{"kind": "airlight", "placings": "uniform"}],
     "scenes.0.estimators.0.placings is not a known key; did you mean placing?"),
    (["scenes", 0, "estimators"], [{"kind": "airlight", "majorants": 3}], "estimators.0.majorants is not a known key"),
    (["scenes", 1, "estimators"], ["regular", {"kind": "ratio", "majorants": 3}],
     "scenes.1.estimators.1.majorants is not a known key; did you mean majorant?"),
    (["scenes", 0, "ligth"], LIT["light"], "scenes.0.ligth is not a known key; did you mean light?"),
    (["scenes", 0, "ray", "lenght"], 2, "scenes.0.ray.lenght is not a known key; did you mean length?"),
    (["scenes", 1, "light"], LIT["light"], "light must not be given: the transmittance does not look at it"),
    (["scenes", 0, "ambient"], 1.0, "ambient must not be given: the airlight does not look at it"),
    (["scenes", 0, "shape"], BALL["shape"], "shape must not be given: the airlight does not look at it"),
    (["nonsense"], 1, "nonsense is not a known key"),
    (["replicate"], 4, "replicate is not a known key; did you mean replicates?"),
    (["samples"], "100", "samples must be a list, got '100'"),
    (["samples"], [100, 1 << 50], "samples must be at most 1099511627776"),
    (["replicates"], 10**12, "replicates must be at most"),
    (["scenes", 0, "medium"], {"sigmaa": 1, "sigma_s": 1}, "sigmaa is not a known key, and scenes.0.medium.sigma_a is missing"),
    (["scenes", 0, "medium"], {}, "scenes.0.medium.sigma_a is missing, scenes.0.medium.sigma_s too"),
    (["scenes", 0, "quantity"], "radiosity", "scenes.0.quantity"),
    (["scenes", 0, "medium", "sigma_s"], -1, "sigma_s must be finite and >= 0"),
    (["scenes", 0, "light"], None, "scene 'lit', airlight: light must be given"),
    (["scenes", 0, "estimators"], [], "estimators must name at least one"),
    (["scenes", 0, "estimators"], kinds("aerlight"), "kind 'aerlight'; known are"),
    (["scenes", 0, "estimators"], [{"kind": "airlight", "placing": "somewhere"}], "placing"),
    (["scenes", 0, "estimators"], kinds("airlight", "airlight"), "'airlight' is there twice"),
    (["scenes", 0, "estimators"], kinds("ratio"), "ratio estimates the transmittance, scene 'lit' is about the airlight"),
    (["scenes", 1, "name"], "lit", "must have different names"),
    (["scenes", 1, "medium"], {"sigma_a": 1, "sigma_s": 1}, "regular tracking needs a VoxelGrid"),
    (["scenes", 1, "medium"], {"kind": "grid-file", "path": "none.npy"}, "cannot read the grid"),
    (["scenes", 1, "medium"], {"sigma_a": [1, 2], "sigma_s": 1}, "a study follows one channel"),
    (["scenes", 0, "light", "position"], [0, 0, 0], "nothing converges"),
    (["scenes", 0], {**LIT, "quantity": "radiance", "estimators": kinds("path-tracing")}, "shape must be a ball"),
    (["scenes", 0], {**BALL, "ray": RAY, "estimators": kinds("path-tracing")}, "ray must start outside the ball"),
    (["scenes", 0], {**BALL, "medium": {"sigma_a": 1, "sigma_s": 1, "emission": 1}, "estimators": kinds("path-tracing")},
     "must be homogeneous, scatter isotropically and emit nothing"),
]  # fmt: skip


@pytest.mark.parametrize(("path", "value", "words"), FAULTS, ids=[f"{f[0][-1]}-{i}" for i, f in enumerate(FAULTS)])
def test_faults_are_told(tmp_path, path, value, words):
    file = tmp_path / "study.toml"
    file.write_text(toml(changed(path, value)))
    with pytest.raises(FogproofError) as caught:
        prepare(cells_of(read_study(file)))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["samples = [", "\xff", "a = 1979-05-27"])
def test_files_that_are_no_studies_are_told(tmp_path, text):
    file = tmp_path / "study.toml"
    file.write_bytes(text.encode("latin-1"))
    with pytest.raises(FogproofError, match="study"):
        read_study(file)
    with pytest.raises(FogproofError, match="cannot read the study file"):
        read_study(tmp_path / "none.toml")


def test_a_date_is_no_title(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text("title = 2020-01-01\n" + toml(SMALL))
    with pytest.raises(
        FogproofError, match=r"study\.toml: title = 2020-01-01 is a date or a time, .*: put it in quotes"
    ):
        read_study(file)


def test_the_documentation_lists_every_estimator_and_its_options():
    page = (Path(__file__).resolve().parents[2] / "docs" / "studies.md").read_text(encoding="utf-8")
    for kind, cls in METHODS.items():
        row = next((line for line in page.splitlines() if line.startswith(f"| {cls.quantity} |")), "")
        for name in (kind, *(field.name for field in fields(cls))):
            assert f"`{name}`" in row, (kind, name)


def test_every_fault_names_the_file(tmp_path):
    for table in (
        changed(["scenes", 0, "estimators"], kinds("ratio")),
        changed(["scenes", 0, "estimators"], kinds("airlight", "airlight")),
        changed(["scenes", 0, "estimators"], [{"kind": "nowhere:Mine"}]),
        changed(["scenes", 0, "estimators"], [{"kind": "json:Nothing"}]),
        changed(["scenes", 0, "light"], None),
        changed(["samples"], None),
    ):
        (tmp_path / "faulty.toml").write_text(toml(table))
        with pytest.raises(FogproofError, match=r"faulty\.toml: "):
            prepare(cells_of(read_study(tmp_path / "faulty.toml")))


def test_a_study_and_a_scene_are_told_apart(tmp_path):
    path = tmp_path / "file.toml"
    path.write_text(toml(SMALL))
    with pytest.raises(FogproofError, match=r"file\.toml is a study, not a scene: `fogproof study"):
        read_scene(path)
    path.write_text("[medium]\nsigma_a = 1\n[ray]\nlength = 1\n")
    with pytest.raises(FogproofError, match="is a scene, not a study"):
        read_study(path)


def test_the_mark_that_some_editors_write_is_no_fault(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(toml(SMALL), encoding="utf-8-sig")
    assert read_study(path).fingerprint == study_from(SMALL).fingerprint


def test_only_the_content_identifies_a_study(tmp_path):
    one, two = tmp_path / "one.toml", tmp_path / "two.toml"
    one.write_text(toml(SMALL))
    two.write_text("# with a comment\n" + toml(dict(sorted(SMALL.items()))).replace(" = ", "  =  "))
    assert read_study(one).fingerprint == read_study(two).fingerprint
    two.write_text(toml(changed(["seed"], 2)))
    assert read_study(one).fingerprint != read_study(two).fingerprint


def test_differences_name_the_keys():
    other = changed(["scenes", 1, "medium", "high"], 3.0)
    other["replicates"] = 16
    del other["batch"]
    said = differences(study_from(SMALL).text, study_from(other).text)
    assert said == ["batch = 1024 is gone", "replicates: 8 has become 16", "scenes[1].medium.high: 1.5 has become 3.0"]


def test_other_voxels_make_another_study(tmp_path):
    table = changed(["scenes", 1, "medium"], {"kind": "grid-file", "path": "grid.npy", "lower": [-1, -1, 0],
                                              "upper": [1, 1, 2]})  # fmt: skip
    file = tmp_path / "study.toml"
    file.write_text(toml(table))
    np.save(tmp_path / "grid.npy", np.full((1, 1, 4), 0.5))
    before = read_study(file)
    assert before.scenes[1].built_medium.sigma_t.shape == (1, 1, 4)
    np.save(tmp_path / "grid.npy", np.full((1, 1, 4), 0.25))
    assert read_study(file).fingerprint != before.fingerprint
    with pytest.raises(FogproofError, match="has changed since"):
        _ = study_of(before.text, before.folder).scenes[1].built_medium


def test_batches_cover_every_replicate_once():
    cells = cells_of(study_from({**SMALL, "samples": [10, 100, 5000], "batch": 1000}))
    for cell in cells:
        for level, count in enumerate(cell.counts):
            covered = np.zeros((cell.replicates, count if cell.method.axis == "samples" else 1), int)
            for batch in batches_of(cells):
                if (batch.cell, batch.level) == (cell.index, level):
                    rows = slice(batch.first, batch.first + batch.replicates)
                    covered[rows, batch.start : batch.start + batch.samples] += 1
                    assert batch.replicates * batch.samples <= max(1000, cell.replicates)
            assert np.all(covered == 1), (cell.name, count)


def test_the_shipped_study_asks_the_four_questions():
    study = read_study(Path(__file__).resolve().parents[2] / "studies" / "lecture.toml")
    questions = " ".join(scene.question for scene in study.scenes)
    assert all(word in questions for word in ("near the ray", "dense medium", "loose majorant", "high-frequency grid"))
    used = {name_of(method).split(" (")[0] for scene in study.scenes for method in scene.estimators}
    assert used == set(METHODS)
