"""A stdout that takes no more stands in the place of 0 alone: no rejection is lost with its row, and nobody reads a pass."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fuzz_commands import Run, here
from report_records import typical
from study_fixtures import RAY, toml

from fogproof.checks.json_values import jsonable
from fogproof.cli.commands import _COMMANDS

pytestmark = pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
ROOT = Path(__file__).resolve().parents[2]
SUN = (ROOT / "scenes" / "images" / "sun.toml").read_text().replace("width = 48, height = 36", "width = 4, height = 4")
CASES = """
import numpy as np
from fogproof.catalogue import EstimatorCase
class Draw:
    def draw(self, rng, n):
        return rng.random(n)
def cases():
    means = {"right": 0.5, "wrong": 0.6}
    return [EstimatorCase(name=name, make=Draw, reference=mean, samples=10_000) for name, mean in means.items()]
"""
SPEC = 'domain = { kind = "interval", a = -1, b = 1 }\nphase = { kind = "isotropic" }\n'
SCENE = {"name": "fog", "quantity": "transmittance", "medium": {"sigma_a": 0.2, "sigma_s": 0.3}, "ray": RAY}
COPY = "sh -c 'cp image.npy $1.npy' sh {out} {scene}"
QUESTION = '{"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": 0.5}'
COMMANDS = {
    "verify wrong.py::right": 0,
    "verify wrong.py --seed 1 --json": 1,
    "list fog": 0,
    "check wrong.csv --spec spec.toml --seed 1": 1,
    "check wrong.csv --spec spec.toml --seed 1 --json": 1,
    "oracle question.json": 0,
    "oracle bad.json": 2,
    "compare image.npy sun.toml": 1,
    "export sun.toml --to json": 0,
    "render sun.toml --with COPY -o out": 1,
    "relations sun.toml --with COPY -o out --no-oracle --only moved/30 --renders 1": 0,
    "golden phase_pdf": 0,
    "plan lamp.toml": 0,
    "study study.toml -o out": 0,
    "report new --against old": 3,
    "stability free_path/linear --short": 0,
    "zoo errata/e2-murky-is-not-normalised --samples 1000 --seed 1": 0,
    "bench samplers --seconds 0.1": 0,
    "gallery fog -o out": 0,
}
"""What a command line comes to where all that it prints is read."""


def full():
    return open("/dev/full", "wb")


def unread():
    reading, writing = os.pipe()
    os.close(reading)
    return open(writing, "wb")


@pytest.fixture(autouse=True)
def at(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("wrong.py").write_text(CASES)
    Path("wrong.csv").write_text("".join(f"{((i + 0.5) / 2000) ** 2}\n" for i in range(2000)))
    Path("spec.toml").write_text(SPEC)
    np.save("image.npy", np.random.default_rng(7).random((4, 4), np.float32))
    Path("sun.toml").write_text(SUN)
    Path("lamp.toml").write_text((ROOT / "scenes" / "foggy-lamp.toml").read_text())
    Path("question.json").write_text(QUESTION)
    Path("bad.json").write_text("{}")
    scenes = [{**SCENE, "estimators": ["analog"]}]
    Path("study.toml").write_text(toml({"samples": [64], "replicates": 4, "sobol": False, "scenes": scenes}))
    record = jsonable(typical(2))
    for name, cases in (("old", record["cases"]), ("new", record["cases"][:-1])):
        Path(name).mkdir()
        Path(name, "results.json").write_text(json.dumps({**record, "cases": cases}))


@pytest.mark.parametrize("line", COMMANDS)
def test_every_command(line):
    words = [COPY if word == "COPY" else word for word in line.split()]
    told = here(Run(words))
    assert (told.code, bool(told.out)) == (COMMANDS[line], True), told.err
    for stdout, instead in ((full(), 2), (unread(), 141)):
        with stdout:
            end = here(Run(words), stdout)
        assert end.code == (told.code if told.code in (1, 3) else instead), (end.code, end.err)
        assert (b"No space left on device" in end.err) == (instead == 2)


def test_all_of_them_are_held_to_it():
    assert {line.split()[0] for line in COMMANDS} == set(_COMMANDS)


@pytest.mark.parametrize("line", ["check wrong.csv --spec spec.toml --seed 1 --json", "oracle question.json"])
def test_a_full_disk(line):
    with full() as out:
        done = subprocess.run([sys.executable, "-m", "fogproof", *line.split()], stdout=out, stderr=subprocess.PIPE)
    assert (done.returncode, b"No space left on device" in done.stderr) == (COMMANDS[line] or 2, True), done.stderr
