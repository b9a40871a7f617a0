"""A renderer that cannot be run is bad usage, told before anything is written; a case's name is harmless wherever it stands."""

import csv
from pathlib import Path

import pytest
from fuzz_commands import MOVES_A_TERMINAL, Run, here

ROOT = Path(__file__).resolve().parents[2]
SUN = str(ROOT / "scenes" / "images" / "sun.toml")


@pytest.mark.parametrize("command", ["render", "relations"])
@pytest.mark.parametrize(
    "program",
    [["nosuchcmd {scene} {out}"], ["./file {scene} {out}"], ["mitsuba", "--python", "/nowhere/python"]],
    ids=["unknown", "no program", "no python"],
)
def test_a_command_that_cannot_be_run_is_bad_usage(tmp_path, monkeypatch, command, program):
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("no program")
    end = here(Run([command, SUN, "--with", *program, "-o", "out"]))
    assert (end.code, b"cannot run" in end.err) == (2, True), end.err
    assert any(name in end.err.decode() for name in ("nosuchcmd", "./file", "/nowhere/python"))
    assert not Path("out").exists()


def test_a_command_that_fails_to_start_is_an_error_of_its_scene(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("#!/nowhere/interpreter\n")
    Path("file").chmod(0o755)
    end = here(Run(["render", SUN, "--with", "./file {scene} {out}", "-o", "out"]))
    assert (end.code, b"cannot run ./file" in end.out) == (3, True), end.out


NAMED = """
import numpy as np
from fogproof.catalogue import EstimatorCase
class Mean:
    def draw(self, rng, n):
        return rng.random(n)
def cases():
    return [EstimatorCase(name=name, make=Mean, reference=ref, samples=1000)
            for name, ref in (("../../x\\x1b[31m\\u202e<b>", 0.5), ("/etc/x\\n=1", 0.9), ("=1+1", 0.5))]
"""


def test_a_name_of_a_case_is_harmless_everywhere(tmp_path, monkeypatch):
    inside = tmp_path / "a" / "b"
    inside.mkdir(parents=True)
    monkeypatch.chdir(inside)
    Path("mine.py").write_text(NAMED)
    end = here(Run(["verify", "mine.py", "--report", "out"]))
    assert end.code == 1, end.err
    assert not MOVES_A_TERMINAL.search((end.out + end.err).decode())
    assert not MOVES_A_TERMINAL.search(here(Run(["list", "mine.py"])).out.decode())
    assert sorted(path.name for path in tmp_path.rglob("*") if path.parent in (tmp_path, inside.parent, inside)) == [
        "a", "b", "mine.py", "out",
    ]  # fmt: skip
    for path in Path("out").rglob("*"):
        assert not MOVES_A_TERMINAL.search(path.name)
        if path.suffix in (".html", ".csv", ".xml", ".svg", ".json"):
            assert not MOVES_A_TERMINAL.search(path.read_text()), path
    page = Path("out/index.html").read_text()
    assert "<b>" not in page.replace("&lt;b&gt;", "")
    with open("out/results.csv", newline="") as rows:
        assert not [cell for row in csv.reader(rows) for cell in row if cell[:1] in tuple("=+@\t\r")]
