"""ARCHITECTURE.md is true: its picture is what the import contracts enforce, and it names every folder."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "ARCHITECTURE.md").read_text()
PACKAGES = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]


def test_the_picture_is_that_of_the_import_contracts():
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    layers = [row.replace("fogproof.", "").split(" | ") for row in contracts[0]["layers"]]
    picture = re.search(r"```\n(.*?)```", TEXT, re.S)[1].splitlines()
    assert [re.split(r" {3,}", line)[0].split() for line in picture] == layers


def test_every_folder_is_named():
    rows = {
        match[1]: set(re.findall(r"`(\w+)`", match[2])) for match in re.finditer(r"^\| `(\w+)/` \|(.*)\|$", TEXT, re.M)
    }
    rooms = rows["scene"]
    for package in PACKAGES:
        parts = package.split(".")[1:]
        if len(parts) == 1:
            assert re.search(rf"\b{parts[0]}\b", TEXT), package
        elif len(parts) > 1:
            named = rows[parts[-2]] | (rooms if parts[0] in ("analytic", "estimators") else set())
            assert parts[-1] in named, package
    for top in ("tests", "tools"):
        for folder in {path.parent.relative_to(ROOT / top) for path in (ROOT / top).rglob("*.py")}:
            assert all(part in rows[top] or part == "mutants" for part in folder.parts), f"{top}/{folder}"
