"""A run of a renderer goes on wherever it was stopped, and what it keeps is what it wrote."""

import hashlib
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
from fuzz_commands import Run, here

from fogproof.images import kept, relation_run, renders
from fogproof.reports import files

ROOT = Path(__file__).resolve().parents[2]
SUN = (ROOT / "scenes" / "images" / "sun.toml").read_text().replace("width = 48, height = 36", "width = 4, height = 4")
COPY = "sh -c 'echo >> count; cp image.npy $1.npy' sh {out} {scene}"
RENDER = ["render", "sun.toml", "--with", COPY, "-o", "out", "--json"]
RELATIONS = [
    "relations",
    "sun.toml",
    "--with",
    COPY,
    "-o",
    "out",
    "--no-oracle",
    "--only",
    "moved/30",
    "--renders",
    "1",
]
COMPARE = ["compare", "image.npy", "sun.toml", "--report", "out"]
DONE = (0, 1, 3)


@pytest.fixture(autouse=True)
def at(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.save("image.npy", np.random.default_rng(7).random((4, 4), np.float32))
    Path("sun.toml").write_text(SUN)


def rendered():
    """Return how often the renderer has run."""
    return len(Path("count").read_text().splitlines())


def untimed(content):
    return re.sub(rb'"seconds": [^,}]*', b"", content)


def row():
    end = here(Run(RENDER))
    assert end.code in DONE, end.err
    return json.loads(end.out)


@pytest.mark.parametrize("words", [RENDER, RELATIONS, COMPARE], ids=lambda words: words[0])
def test_after_every_file_the_folder_is_known_as_ours(monkeypatch, words):
    put, seen = os.replace, []

    def replace(*paths):
        put(*paths)
        with monkeypatch.context() as patch:
            patch.setattr(files.os, "replace", put)
            for place in {path.parent for path in Path("out").rglob("*") if path.is_file()} - {Path("out/sun/figures")}:
                there = [path.relative_to(place) for path in place.rglob("*") if path.is_file()]
                names = [str(name) for name in there if len(name.parts) == 1 or name.parts[0] == "figures"]
                files.prepare_folder(place, tuple(name for name in names if not name.startswith(".")), force=False)
        seen.append(Path(paths[1]).name)

    monkeypatch.setattr(files.os, "replace", replace)
    end = here(Run(words))
    assert end.code in DONE, end.err
    assert len(seen) > 6


@pytest.mark.parametrize("what", [KeyboardInterrupt(), OSError(28, "No space left on device")], ids=["stopped", "full"])
@pytest.mark.parametrize("words", [RENDER, RELATIONS], ids=lambda words: words[0])
def test_a_run_that_was_stopped_in_a_render_goes_on(monkeypatch, words, what):
    def stopped(*_arguments):
        raise what

    with monkeypatch.context() as patch:
        for module in (renders, relation_run):
            patch.setattr(module, "render_one", stopped)
        assert here(Run(words)).code in (2, 130)
    assert any(path.name.endswith("scene.json") for path in Path("out").rglob("*"))
    end = here(Run(words))
    assert end.code in DONE, end.err


@pytest.mark.parametrize("hurt", [Path.unlink, lambda path: path.write_bytes(b"broken")], ids=["missing", "changed"])
def test_what_is_kept_of_a_render_is_what_was_written(hurt):
    first = row()
    made = {
        path: path.read_bytes() for path in Path("out/sun").rglob("*") if path.is_file() and path.name != "row.json"
    }
    assert {path.name for path in made} >= {"index.html", "image.png", "image.exr.npy", "scene.json", "results.json"}
    for path, content in made.items():
        before = rendered()
        hurt(path)
        assert here(Run([*RENDER, "--force"])).code in DONE
        assert rendered() - before == (path.name == "image.exr.npy"), path
        assert untimed(path.read_bytes()) == untimed(content)
    again = row()
    assert again == {**first, "kept": True, "seconds": again["seconds"]}


def test_a_row_that_somebody_changed_is_not_believed():
    first, record = row(), Path("out/sun/row.json")
    other = "not rejected" if first["outcome"] == "rejected" else "rejected"
    record.write_text(record.read_text().replace(f'"{first["outcome"]}"', f'"{other}"'))
    assert row()["outcome"] == first["outcome"]
    assert rendered() == 2


def test_an_image_of_a_relation_that_was_changed_is_rendered_again():
    assert here(Run(RELATIONS)).code in DONE
    before = rendered()
    assert here(Run(RELATIONS)).code in DONE
    assert rendered() == before
    image = next(Path("out/sun/renders").glob("*.npy"))
    content = image.read_bytes()
    np.save(image, np.ones((4, 4), np.float32))
    assert here(Run(RELATIONS)).code in DONE
    assert rendered() == before + 1
    assert image.read_bytes() == content


@pytest.mark.parametrize("words", [RENDER, RELATIONS], ids=lambda words: words[0])
def test_an_image_beyond_the_bound_is_refused_before_it_is_read(monkeypatch, words):
    with Path("image.npy").open("wb") as file:  # sparse, and linked by the renderer
        np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": (20_000, 20_000)})
        file.truncate(file.tell() + 20_000 * 20_000 * 8)
    read = []
    monkeypatch.setattr(kept.hashlib, "file_digest", lambda file, _: read.append(file.name) or hashlib.blake2b())
    end = here(Run([word.replace("cp image.npy", "ln image.npy") for word in words]))
    assert end.code in (2, 3)
    assert b"claims 20000 x 20000 pixels" in end.out + end.err
    assert not [name for name in read if "exr" in str(name)]


def test_a_folder_that_is_removed_during_its_render_is_a_sentence():
    gone = """sh -c 'rm -r out/sun; echo "FileNotFoundError: [Errno 2] no such file" >&2; exit 1' {scene} {out}"""
    end = here(Run(["render", "sun.toml", "--with", gone, "-o", "out", "--json"]))
    row = json.loads(end.out)
    assert (end.code, row["outcome"]) == (3, "error")
    assert row["reason"] == "the folder out/sun was removed while its scene was rendered"
