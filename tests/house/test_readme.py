"""The tables of the README and of the pages behind it are true, and the README stays short; `test_docs` runs what they show."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from fogproof import verify
from fogproof.catalogue import all_cases
from fogproof.cli.commands import _COMMANDS
from fogproof.plan import plan
from fogproof.scene.files import read_scene

ROOT = Path(__file__).resolve().parents[2]


def page(name):
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def test_the_readme_fits_two_screens():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 100


def test_one_file_is_a_test_and_a_file_of_cases(tmp_path):
    (example,) = re.findall(r"```python\n(.*?def cases.*?)```", page("tests-and-runs.md"), re.S)
    path = tmp_path / "test_mine.py"
    path.write_text(example)
    call = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(path), "--rootdir", str(tmp_path)]
    out = subprocess.run(call, capture_output=True, text=True, cwd=tmp_path)
    assert "1 passed" in out.stdout
    (result,) = verify.run(verify.select([str(path)]), seed=1, alpha=1e-6, workers=1)
    assert (result.case.name, result.status) == ("test_mine/exponential", "passed")


def test_every_group_of_cases_has_its_row():
    rows = set(re.findall(r"^\| [^|]+ \| `([\w-]+)/…`", page("catalogue.md"), re.M))
    assert rows == {case.name.split("/")[0] for case in all_cases()}


def test_every_command_is_listed():
    assert set(re.findall(r"^fogproof (\w+) ", page("command-line.md"), re.M)) == set(_COMMANDS)


@pytest.mark.parametrize("path", sorted((ROOT / "scenes").glob("*.toml")), ids=lambda path: path.name)
def test_every_example_scene_can_be_planned(path):
    assert plan(read_scene(path)).solver
