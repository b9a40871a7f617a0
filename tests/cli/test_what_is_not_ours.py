"""What a page writes replaces nothing that others wrote, shares its folder with no other run, and leaves nothing if it fails."""

import fcntl
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fuzz_commands import Run, here

from fogproof.errors import InvalidInputError
from fogproof.reports.charts.p_values import PValueHistogram
from fogproof.reports.charts.pictures import render
from fogproof.reports.files import FIGURES, prepare_folder
from fogproof.whole_files import write_file

ROOT = Path(__file__).resolve().parents[2]
SUN = (ROOT / "scenes" / "images" / "sun.toml").read_text().replace("width = 48, height = 36", "width = 4, height = 4")
COPY = "sh -c 'cp image.npy $1.npy' sh {out} {scene}"


@pytest.fixture
def at(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(7)
    for name in ("image", "other"):
        np.save(f"{name}.npy", rng.random((4, 4), np.float32))
    Path("sun.toml").write_text(SUN)
    return tmp_path


def theirs(*names):
    for name in names:
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_bytes(b"somebody's")


COMPARE = ["compare", "image.npy", "--with", "other.npy", "--report", "out"]
GALLERY = ["gallery", "phase-polar", "-o", "out"]
VERIFY = ["verify", "fog/analog/haze", "--report", "out"]


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (COMPARE, "figures/image.png"),
        (COMPARE, "maps.exr"),
        (GALLERY, "figures/phase-polar.png"),
        (GALLERY, "figures/phase-polar.svg"),
        (VERIFY, "figures/p-values.png"),
        (["render", "sun.toml", "--with", COPY, "-o", "out"], "sun/figures/image.png"),
        (["render", "sun.toml", "--with", COPY, "-o", "out"], "sun/scene.json"),
        (["render", "sun.toml", "--with", COPY, "-o", "out"], "sun/image.exr.npy"),
    ],
)
def test_pictures_of_others_are_not_replaced(at, words, name):
    theirs(f"out/{name}")
    end = here(Run(words))
    assert (end.code, f"out/{name} was not written by fogproof".encode() in end.err) == (2, True), end.err
    assert Path("out", name).read_bytes() == b"somebody's"
    assert [path.name for path in Path("out").rglob("*") if path.is_file()] == [Path(name).name]


def test_pictures_of_our_own_are_replaced_and_those_of_others_by_force(at):
    for words in (COMPARE, GALLERY, VERIFY):
        folder = Path(words[0])
        words = [*words[:-1], words[0]]
        assert here(Run(words)).code in (0, 3)
        assert here(Run(words)).code in (0, 3)
        picture = next(folder.glob(FIGURES[0]))
        picture.write_bytes(b"somebody's")
        assert here(Run(words)).code == 2
        assert here(Run([*words, "--force"])).code in (0, 3)
        assert picture.read_bytes()[:4] == b"\x89PNG"


def test_a_picture_with_its_mark_is_the_same_picture(at):
    from PIL import Image

    picture = render(PValueHistogram((0.1, 0.5, 0.7)), "p")
    picture.save(at)
    prepare_folder(at, ("*.png", "*.svg"))
    Path("plain.png").write_bytes(picture.png)
    with Image.open("p.png") as marked, Image.open("plain.png") as plain:
        assert marked.tobytes() == plain.tobytes()
    with pytest.raises(InvalidInputError, match=r"plain\.png was not written by fogproof"):
        prepare_folder(at, ("*.png", "*.svg"))


def test_renders_of_relations_replace_nothing(at):
    words = ["relations", "sun.toml", "--with", COPY, "-o", "out", "--no-oracle", "--only", "moved/*", "--renders", "1"]
    assert here(Run(words)).code in (0, 1, 3)
    renders = sorted(Path("out/sun/renders").iterdir())
    for path in renders:
        path.write_bytes(b"somebody's")
    for path in (*Path("out").rglob("*.html"), Path("out/results.json")):
        path.unlink()
    end = here(Run(words))
    assert (end.code, b"was not written by fogproof" in end.err) == (2, True), end.err
    assert {path.read_bytes() for path in renders} == {b"somebody's"}
    assert here(Run([*words, "--force"])).code in (0, 1, 3)


def test_the_folder_of_a_scene_belongs_to_the_run_that_renders_it(at):
    Path("out/sun").mkdir(parents=True)
    inside = os.open("out/sun", os.O_RDONLY)
    fcntl.flock(inside, fcntl.LOCK_EX)  # as `compare --report out/sun` does
    end = here(Run(["render", "sun.toml", "--with", COPY, "-o", "out"]))
    os.close(inside)
    assert (end.code, b"another run of fogproof writes into out/sun" in end.err) == (2, True), end.err
    try_it = "import os, fcntl; fcntl.flock(os.open('out/sun', os.O_RDONLY), fcntl.LOCK_EX | fcntl.LOCK_NB)"
    busy = f"sh -c 'python3 -c \"{try_it}\" || cp image.npy $1.npy' sh {{out}} {{scene}}"
    for _ in ("it is there", "it is not there yet"):
        assert here(Run(["render", "sun.toml", "--with", busy, "-o", "out", "--json"])).code in (0, 1, 3)
        assert Path("out/sun/image.exr.npy").exists()
        for path in sorted(Path("out").rglob("*"), reverse=True):
            path.unlink() if path.is_file() else path.rmdir()


def test_what_fails_before_it_writes_leaves_no_folder(at):
    Path("bad.npy").write_bytes(b"no image")
    Path("image-2.npy").write_bytes(Path("image.npy").read_bytes())
    for words in (
        ["compare", "image.npy", "--with", "bad.npy", "--report", "new/one"],
        ["compare", "image.npy", "--with", "image.npy", "--report", "new/one"],
        ["gallery", "no-such-picture", "-o", "new/one"],
        ["zoo", "no-such-bug", "-o", "new/one"],
        ["relations", "sun.toml", "--with", COPY, "-o", "new/one", "--only", "no-such-relation"],
        ["study", "sun.toml", "-o", "new/one"],
        ["golden", "phase_pdf", "-o", f"new/one/{'x' * 300}"],
        ["export", "sun.toml", "--to", "json", "-o", f"new/one/{'x' * 300}"],
    ):
        end = here(Run(words))
        assert end.code == 2, (words, end.err)
        assert not Path("new").exists(), words


@pytest.mark.parametrize("left", [b"", b"\0" * 4096], ids=["empty", "nul"])
@pytest.mark.parametrize("name", ["index.html", "results.json", "figures/one.png", "figures/one.svg"])
def test_what_a_power_cut_left_of_our_own_is_ours(tmp_path, name, left):
    ours = {
        "index.html": "<title>A run – fogproof verify</title>".encode(),
        "results.json": b'{"schema": "fogproof-run-1"}',
        "results.csv": b"a,b",
        "figures/one.png": b"tEXtSoftware\0fogproof",
        "figures/one.svg": b"<!-- fogproof -->",
    }
    for path, content in ours.items():
        write_file(tmp_path / path, left if path == name else content)
    prepare_folder(tmp_path)
    for path in ours:
        if path != name:
            (tmp_path / path).unlink()
    with pytest.raises(InvalidInputError, match="was not written by fogproof"):  # nothing here says whose it is
        prepare_folder(tmp_path)


def test_a_record_that_was_cut_says_whose_it_is(tmp_path):
    write_file(tmp_path / "results.json", '{\n "schema": "fogproof-run-1",\n "ca')
    prepare_folder(tmp_path)
    write_file(tmp_path / "results.json", '{\n "schema": "somebody-1",\n "ca')
    with pytest.raises(InvalidInputError, match="was not written by fogproof"):
        prepare_folder(tmp_path)


KILLED = """
import os, signal, sys
from pathlib import Path
from fogproof.reports import files
def killed(*_, **__):
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
@pytest.mark.parametrize(
    ("when", "what"),
    [
        ("files.os.replace = killed", "files.prepare_folder(Path(sys.argv[1]))"),
        ("Path.unlink = killed", "files.prepare_folder(Path(sys.argv[1]))"),
        ("files.os.replace = killed", "files.write_picture(Path(sys.argv[1]) / 'figures/p.svg', '<svg/>')"),
        ("files.os.replace = killed", "files.write_output(sys.argv[1] + '/s[1].json', 'half')"),
        ("files.os.replace = killed", "files.write_output(sys.argv[1] + '/' + 'n' * 240, 'half')"),
    ],
)
def test_what_a_killed_process_had_begun_is_cleared_by_the_next(tmp_path, when, what):
    ended = subprocess.run([sys.executable, "-c", f"{KILLED}\n{when}\n{what}", tmp_path], check=False)
    assert ended.returncode == -signal.SIGKILL
    (left,) = [path for path in tmp_path.rglob("*") if path.is_file()]
    running = left.with_name(f"{left.name.rsplit('.', 2)[0]}.{os.getpid()}.fogproof")
    others = {running, tmp_path / ".notes.txt.1", tmp_path / ".s[1].json.20240101", tmp_path / ".probe.20240101"}
    for path in others:
        path.write_bytes(b"somebody's")
    again = f"{KILLED}\n{what}\nfiles.prepare_folder(Path(sys.argv[1]))"
    subprocess.run([sys.executable, "-c", again, tmp_path], check=True)
    there = {path for path in tmp_path.rglob(".*") if path.is_file()}
    assert there == others
