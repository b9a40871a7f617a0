"""What was rejected ends in 1, and is said, whatever cannot be written or read after it."""

import json
from pathlib import Path

import pytest
from fuzz_commands import Run, here
from study_fixtures import RAY, toml

import fogproof
from fogproof import reports, whole_files
from fogproof.errors import InvalidInputError

CASES = """
import numpy as np
from fogproof import HalfLine
from fogproof.catalogue import SamplerCase

class FreePath:
    domain, dimensions = HalfLine(0), 1
    def __init__(self, rate=1.0):
        self.rate = rate
    def sample(self, u):
        return -np.log1p(-u[:, 0])
    def pdf(self, x):
        return self.rate * np.exp(-self.rate * x)

def cases():
    yield SamplerCase(name="right", make=FreePath, samples=20_000)
    yield SamplerCase(name="wrong", make=lambda: FreePath(2.0), samples=20_000)

class Biased:
    def __init__(self, scene):
        pass
    def draw(self, rng, n):
        return 0.9 + 0.01 * rng.standard_normal(n)
"""
SCENE = {
    "name": "haze",
    "quantity": "transmittance",
    "medium": {"sigma_a": 0.05, "sigma_s": 0.05},
    "ray": RAY,
    "estimators": [{"kind": "half_wrong:Biased"}],
}


@pytest.fixture
def mine(tmp_path, monkeypatch):
    (tmp_path / "half_wrong.py").write_text(CASES)
    study = {"samples": [100, 1000], "replicates": 8, "batch": 1000, "sobol": False, "scenes": [SCENE]}
    (tmp_path / "study.toml").write_text(toml(study))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def full(*arguments, **options):
    raise InvalidInputError("cannot write r/x: No space left on device", "r/x")


@pytest.mark.parametrize(("which", "code"), [("wrong", 1), ("right", 2)])
def test_verify(mine, monkeypatch, which, code):
    monkeypatch.setattr(reports, "write_report", full)
    end = here(Run(["verify", f"half_wrong.py::{which}", "--report", "r"]))
    assert (end.code, b"No space left on device" in end.err) == (code, True)
    assert f"half_wrong/{which}  {'rejected' if which == 'wrong' else 'not rejected'}".encode() in end.out


@pytest.mark.parametrize("step", ["results", "page"])
def test_study(mine, monkeypatch, step):
    place, name = (whole_files, "write_file") if step == "results" else (reports, "write_report")
    monkeypatch.setattr(place, name, full)
    end = here(Run(["study", "study.toml", "-o", "run"]))
    assert (end.code, b"No space left on device" in end.err, b"rejected" in end.out + end.err) == (1, True, True)


@pytest.mark.parametrize("content", ["", "junk", "[]", '{"schema": 1}', "[" * 5000])
def test_a_record_of_hard_regions_that_cannot_be_read_is_left_out(mine, content):
    Path("r").mkdir()
    Path("r/stability.json").write_text(content)
    end = here(Run(["verify", "half_wrong.py", "--report", "r"]))
    assert end.code == 1
    page = Path("r/index.html").read_text()
    assert "Not shown: " in page
    assert "stability.json" in page[page.index("Not shown: ") :][:200]
    assert json.loads(Path("r/results.json").read_text())["exit_code"] == 1
    assert here(Run(["report", "r"])).code == 0
    assert Path("r/stability.json").read_text() == content
    run = fogproof.Run()
    run.write("r")
