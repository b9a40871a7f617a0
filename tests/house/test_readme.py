"""What the README shows works as shown, and its tables are true."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from fogproof import verify
from fogproof.catalogue import all_cases
from fogproof.checks import RejectedError
from fogproof.cli.commands import _COMMANDS
from fogproof.plan import plan
from fogproof.scene.files import read_scene

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", README, re.S)


def test_the_first_example_finds_the_sign():
    with pytest.raises(RejectedError, match=r"mean cosine of the pdf is -0\.8"):
        exec(compile(EXAMPLES[0], "README.md", "exec"), {})


def test_the_second_example_is_a_test_and_a_file_of_cases(tmp_path):
    path = tmp_path / "test_mine.py"
    path.write_text(EXAMPLES[1])
    call = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(path), "--rootdir", str(tmp_path)]
    out = subprocess.run(call, capture_output=True, text=True, cwd=tmp_path)
    assert "1 passed" in out.stdout
    (result,) = verify.run(verify.select([str(path)]), seed=1, alpha=1e-6, workers=1)
    assert (result.case.name, result.status) == ("test_mine/exponential", "passed")


def test_the_third_example_answers(capsys):
    exec(compile(EXAMPLES[2], "README.md", "exec"), {})
    assert "+-" in capsys.readouterr().out


def test_every_group_of_cases_has_its_row():
    rows = set(re.findall(r"^\| [^|]+ \| `([\w-]+)/…`", README, re.M))
    assert rows == {case.name.split("/")[0] for case in all_cases()}


def test_every_command_is_listed():
    assert set(re.findall(r"^fogproof (\w+) ", README, re.M)) == set(_COMMANDS)


@pytest.mark.parametrize("path", sorted((ROOT / "scenes").glob("*.toml")), ids=lambda path: path.name)
def test_every_example_scene_can_be_planned(path):
    assert plan(read_scene(path)).solver


def test_the_fourth_example_agrees(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    exec(compile(EXAMPLES[3], "README.md", "exec"), {})
    assert "not rejected" in capsys.readouterr().out


def test_the_fifth_example_tracks(capsys):
    exec(compile(EXAMPLES[4], "README.md", "exec"), {})
    assert "look-ups; the oracle says" in capsys.readouterr().out
