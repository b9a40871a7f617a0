"""A rejection that was reached is told by row and exit code, whatever file cannot be written and whichever render be read."""

import json
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np
import pytest
from fuzz_commands import Run, here

from fogproof import whole_files
from fogproof.cli import compare_command
from fogproof.images import renders
from fogproof.images.compare import compare_image

ROOT = Path(__file__).resolve().parents[2]
SLAB = (ROOT / "scenes" / "images" / "absorbing-slab.toml").read_text().replace("48, height = 36", "16, height = 12")
SCRIPT = """
n=$(($(cat count 2>/dev/null || echo 0) + 1)); echo $n > count; out=$2
[ -f wrong/$n ] && . ./wrong/$n || cp right.npy $out.npy
"""
"""Each call of the renderer leaves the same image, or does what stands in a file of its number."""
OUTSIDE = "cp brighter.npy $out.npy"
UNREADABLE = {
    "truncated": "head -c 300 right.npy > $out.npy",
    "empty": ": > $out.npy",
    "junk": "echo junk > $out",
    "shape": "cp small.npy $out.npy",
    "objects": "cp objects.npy $out.npy",
    "folder": "mkdir -p $out/x",
    "pipe": "mkfifo $out.npy",
    "device": "ln -s /dev/zero $out.npy",
    "nothing": ":",
    "end": "exit 7",
}
ENDS = ["--with", "sh r.sh {scene} {out}", "-o", "out", "--json"]
RENDER = ["render", "one.toml", "two.toml", *ENDS]
RELATIONS = ["relations", "one.toml", "two.toml", *ENDS, "--no-oracle", "--only", "moved/*", "--renders", "1"]
COMPARE = ["compare", "brighter.npy", "one.toml", "--report", "out", "--json"]


@pytest.fixture(autouse=True)
def at(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for module in (compare_command, renders):  # an image is judged once
        monkeypatch.setattr(module, "compare_image", judged)
    right = np.random.default_rng(3).normal(1, 0.01, (12, 16)).astype(np.float32)
    for name, image in (
        ("right", right),
        ("brighter", 2 * right),
        ("small", right[:5]),
        ("objects", right.astype(object)),
    ):
        np.save(f"{name}.npy", image)
    for name in ("one", "two"):
        Path(f"{name}.toml").write_text(SLAB)
    Path("r.sh").write_text(SCRIPT)
    Path("wrong").mkdir()


_JUDGED = {}


def judged(paths, scene, **options):
    key = paths[0], np.load(paths[0]).tobytes()
    if key not in _JUDGED:
        _JUDGED[key] = compare_image(paths, scene, **options)
    return _JUDGED[key]


def wrong(**calls):
    for call, does in calls.items():
        Path("wrong", call.removeprefix("call")).write_text(does)


def ends(words):
    end = here(Run(words))
    return end.code, [json.loads(line) for line in end.out.splitlines()], end.err.decode()


class Disk:
    """Counts files that are put in their place; from one of them on, or only there, none is."""

    def __init__(self, monkeypatch):
        self.put, self.written = os.replace, []
        self.full = lambda _number: False
        monkeypatch.setattr(whole_files.os, "replace", self)

    def __call__(self, source, path):
        name = str(path)
        if "probe" not in name:
            self.written.append(name)
            if self.full(len(self.written)):
                raise OSError(28, "No space left on device")
        self.put(source, path)


def files_of(words, monkeypatch):
    disk = Disk(monkeypatch)
    ends(words)
    return disk, len(disk.written)


@pytest.mark.parametrize("and_after", [True, False], ids=["from", "only"])
def test_a_rejected_image_is_rejected_whatever_is_not_written(monkeypatch, and_after):
    disk, files = files_of(COMPARE, monkeypatch)
    assert files > 4
    for number in range(1, files + 1):
        disk.full, disk.written = lambda n, k=number: n == k or (n > k and and_after), []
        code, (told,), err = ends(COMPARE)
        assert (code, told["verdict"]["outcome"]) == (1, "rejected")
        assert f"cannot write {disk.written[number - 1]}: No space left on device" in err
        assert "report:" not in err


def test_what_is_not_written_is_no_rejection(monkeypatch):
    np.save("other.npy", np.load("right.npy")[::-1])
    words = ["compare", "right.npy", "--with", "other.npy", "--report", "out", "--json"]
    disk, _ = files_of(words, monkeypatch)
    disk.full = lambda _number: True
    code, (told,), _ = ends(words)
    assert (code, told["verdict"]["outcome"]) == (2, "not rejected")


@pytest.mark.parametrize("and_after", [True, False], ids=["from", "only"])
def test_a_rejected_render_is_rejected_whatever_is_not_written(monkeypatch, and_after):
    """Only a scene that cannot be put down for its renderer is not judged."""
    disk, _ = files_of(RENDER, monkeypatch)
    first = disk.written[: disk.written.index("out/two/row.json")]
    assert first[:2] == ["out/one/row.json", "out/one/scene.json"]
    assert first[-3:] == ["out/one/row.json", "out/results.json", "out/index.html"]
    for number, lost in enumerate(first, 1):
        shutil.rmtree("out")
        disk.full, disk.written = lambda n, k=number: n == k or (n > k and and_after), []
        code, rows, err = ends(RENDER)
        expected = ["rejected" if number > 2 else "error", "error" if and_after else "rejected"]
        assert [row["outcome"] for row in rows] == expected
        assert code == (1 if "rejected" in expected else 2)
        assert f"cannot write {lost}: No space left on device" in err
        assert any("unwritten" in row for row in rows) or lost in ("out/results.json", "out/index.html")


def test_a_row_whose_files_are_not_all_there_is_made_again(monkeypatch):
    disk = Disk(monkeypatch)
    disk.full = lambda _number: disk.written[-1].endswith("out/one/maps.exr")
    one, two = ends(RENDER)[1]
    assert (one["page"], two["page"]) == ("", "two/index.html")
    disk.full = lambda _number: False
    one, two = ends(RENDER)[1]
    assert (one["page"], two["page"]) == ("one/index.html", "two/index.html")
    assert ("kept" in one, "kept" in two) == (False, True)


def test_an_image_that_was_kept_is_judged_on_a_full_disk(monkeypatch):
    before = ends(RENDER)[1]
    Path("out/one/index.html").unlink()
    disk = Disk(monkeypatch)
    disk.full = lambda _number: True
    code, (one, two), err = ends(RENDER)
    assert (code, one["outcome"], one["kept"], one["page"]) == (1, "rejected", True, "")
    assert two == {**before[1], "kept": True}  # nothing of it is missing
    assert "cannot write out/one/results.json" in err
    assert "cannot write out/results.json" in err
    disk.full = lambda _number: False
    assert ends(RENDER)[1][0]["page"] == "one/index.html"


def test_no_folder_for_temporary_files_costs_no_rejection(monkeypatch):
    def none(*_, **__):
        raise FileNotFoundError(2, "No usable temporary directory found")

    monkeypatch.setattr(tempfile, "TemporaryDirectory", none)
    code, (told,), err = ends(COMPARE)
    assert (code, told["verdict"]["outcome"]) == (1, "rejected")
    assert "cannot write out/maps.exr: No usable temporary directory found" in err


@pytest.mark.parametrize("and_after", [True, False], ids=["from", "only"])
def test_a_rejected_relation_is_rejected_whatever_is_not_written(monkeypatch, and_after):
    """What was rendered is judged; a setting that cannot be put down for its renderer is an error of its relations."""
    wrong(call2=OUTSIDE, call6=OUTSIDE)
    disk, _ = files_of(RELATIONS, monkeypatch)
    first = disk.written[: disk.written.index("out/index.html") + 1]
    assert len(first) == 8  # three of each render, the record and the page
    for number, lost in enumerate(first, 1):
        shutil.rmtree("out")
        Path("count").unlink(missing_ok=True)
        disk.full, disk.written = lambda n, k=number: n == k or (n > k and and_after), []
        code, rows, err = ends(RELATIONS)
        found = [row["outcome"] for row in rows]
        assert len(found) == 6
        assert (found[0] == "rejected") == (number > 5 or (number == 3 and not and_after)), number
        assert ("rejected" in found) == (number > 5 or not and_after), number
        assert code == (1 if "rejected" in found else 2)
        assert f"cannot write {lost}: No space left on device" in err
        assert ("unwritten" in rows[0]) == (number < 7)


@pytest.mark.parametrize("kind", UNREADABLE)
def test_a_render_that_cannot_be_read_is_an_error_of_its_relation_alone(kind):
    wrong(call2=OUTSIDE, call3=UNREADABLE[kind], call6=OUTSIDE)
    code, rows, _ = ends(RELATIONS)
    outcomes = {(row["scene"], row["relation"]): row["outcome"] for row in rows}
    assert outcomes == {
        ("one", "moved/1"): "rejected",
        ("one", "moved/30"): "error",
        ("one", "moved/500"): "not rejected",
        ("two", "moved/1"): "rejected",
        ("two", "moved/30"): "not rejected",
        ("two", "moved/500"): "not rejected",
    }
    assert code == 1
    assert rows[1]["reason"]
    assert json.loads(Path("out/results.json").read_text())["state"] == "finished"
    Path("wrong/3").unlink()  # the renderer is mended, and the run goes on
    again = ["rejected", "error" if kind == "folder" else "not rejected", "not rejected"]  # it is not ours to remove
    assert [row["outcome"] for row in ends(RELATIONS)[1]][:3] == again


def test_the_usual_image_that_cannot_be_read_is_asked_for_once():
    wrong(call1=UNREADABLE["junk"])
    code, rows, _ = ends(RELATIONS)
    assert [row["outcome"] for row in rows] == ["error"] * 3 + ["not rejected"] * 3
    assert (code, Path("count").read_text()) == (3, "5\n")


def test_independent_renders_of_different_sizes_are_an_error():
    wrong(call2="cp colours.npy $out.npy")
    np.save("colours.npy", np.random.default_rng(4).random((12, 16, 3)))
    code, rows, _ = ends([word.replace("{out}", "{out} {seed}") for word in [*RELATIONS[:-1], "2"]])
    assert [row["outcome"] for row in rows] == ["error"] * 3 + ["not rejected"] * 3
    assert (code, "differ in size" in rows[0]["reason"]) == (3, True)


def test_a_name_that_no_relation_has_is_told_before_anything_is_rendered():
    """Afterwards it would stand in the place of what was rejected."""
    wrong(call2=OUTSIDE)
    code, rows, err = ends([*RELATIONS, "--only", "luck"])
    assert (code, rows, "no relation of these scenes is named luck" in err) == (2, [], True)
    assert not Path("count").exists()
    assert not Path("out").exists()
