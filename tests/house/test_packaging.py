"""Every folder of the package is shipped, is where its import name says, and loads nothing heavy until it is used."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
HEAVY = ["numba", "scipy", "scipy.stats", "matplotlib", "pydantic", "colour", "click", "rich", "jinja2", "mitsuba"]


def test_every_package_folder_is_listed():
    homes = {
        "fogproof": "src/fogproof",
        "fogproof_command": "src/fogproof_command",
        "fogproof_pytest": "src/fogproof_pytest",
        **{f"fogproof.{name}": name for name in ("analytic", "estimators", "reports")},
    }
    folders = {
        ".".join((package, *Path(folder).relative_to(ROOT / home).parts))
        for package, home in homes.items()
        for folder, _, files in os.walk(ROOT / home)
        if "__init__.py" in files
    }
    assert set(PROJECT["tool"]["setuptools"]["packages"]) == folders


@pytest.mark.parametrize("name", ["analytic", "estimators", "reports"])
def test_top_level_folders_are_mapped_and_linked(name):
    assert PROJECT["tool"]["setuptools"]["package-dir"][f"fogproof.{name}"] == name
    if (ROOT / ".git").exists():  # what is unpacked from an archive has no links, and needs none
        assert (ROOT / "src/fogproof" / name).resolve() == ROOT / name


def test_importing_fogproof_loads_numpy_alone():
    code = f"import sys, fogproof; print([m for m in {HEAVY!r} if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_what_scenes_are_made_of_loads_when_it_is_asked_for():
    code = (
        "import sys, fogproof; print('fogproof.scene' in sys.modules); from fogproof import *;"
        " print(Medium is fogproof.scene.Medium, Ball is fogproof.domains.Ball, 'Mie' in dir(fogproof))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.split() == ["False", "True", "True", "True"]


def test_every_lazy_name_resolves():
    import fogproof

    for name in fogproof.__all__:
        assert getattr(fogproof, name) is not None
    with pytest.raises(AttributeError, match="has no attribute 'nonsense'"):
        _ = fogproof.nonsense


def test_version_is_stated_once():
    import fogproof

    assert fogproof.__version__ == PROJECT["project"]["version"]
