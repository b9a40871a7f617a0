"""Names: one name for one thing, no value with a space in it, every public name is where it is said to be."""

import ast
import functools
import importlib
import pkgutil
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

import fogproof
from fogproof import scene
from fogproof.scene import cameras, grounds, lights, media, occluders, phase, shapes

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [path for folder in ("analytic", "estimators", "reports") for path in sorted((ROOT / folder).rglob("*.py"))]
_ELSEWHERE = {"analytic", "estimators", "reports"}  # links to the folders above
SOURCES += [p for p in sorted((ROOT / "src").rglob("*.py")) if not set(p.relative_to(ROOT).parts) & _ELSEWHERE]

TWICE = {
    "Ball": "a set of points to draw from, and a body that holds a medium; both are what everybody calls a ball",
    "Box": "the same, of a box",
}
WITH_SPACES = {"not rejected"}  # outcomes are read by people, in tables and sentences
PRIVATE_WORDS = {"crew", "handful", "_told", "gathering", "matter", "lawless"}  # what they meant has a name of its own
LONGEST = 150


@functools.cache  # not at the head: whoever collects tests would parse all of the sources
def trees():
    return {path.relative_to(ROOT).as_posix(): ast.parse(path.read_text()) for path in SOURCES}


def classes():
    found = defaultdict(list)
    for path, tree in trees().items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                found[node.name].append(path)
    return found


def test_no_class_name_stands_for_two_things():
    assert len(SOURCES) > 300
    assert {name for name, paths in classes().items() if len(paths) > 1} == set(TWICE)


def test_no_alias_has_the_name_of_something_public():
    """A type's short name in one module is not what users know by that name."""
    for path, tree in trees().items():
        if path.endswith("__init__.py"):
            continue
        for node in tree.body:
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
            for name in {target.id for target in targets if isinstance(target, ast.Name)} & set(fogproof.__all__):
                module = path.removeprefix("src/").removesuffix(".py").replace("/", ".").removeprefix("fogproof.")
                public = importlib.import_module(f"fogproof.{module}")
                assert getattr(public, name) is getattr(fogproof, name), f"{path}: {name} is another thing in fogproof"


def test_no_value_has_a_space_in_it():
    for path, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id == "Literal":
                values = {leaf.value for leaf in ast.walk(node.slice) if isinstance(leaf, ast.Constant)}
                bad = {value for value in values if isinstance(value, str) and " " in value}
                assert bad <= WITH_SPACES, (path, bad)


def test_no_private_word_is_a_name():
    for path, tree in trees().items():
        names = {getattr(node, part, None) for node in ast.walk(tree) for part in ("id", "attr", "arg", "name")}
        assert not names & PRIVATE_WORDS, path


def test_no_module_is_hidden_by_a_function_of_its_name():
    for found in pkgutil.walk_packages(fogproof.__path__, "fogproof."):
        if found.name in ("fogproof.__main__",) or found.name.startswith("fogproof.adapters."):
            continue
        module = importlib.import_module(found.name)
        parent, _, name = found.name.rpartition(".")
        assert getattr(sys.modules[parent], name) is module, found.name


def test_cases_are_data():
    for path, tree in trees().items():
        if path.startswith("src/fogproof/catalogue/"):
            for node in ast.walk(tree):
                if isinstance(node, ast.FunctionDef):
                    assert node.end_lineno - node.lineno <= LONGEST, f"{path}: {node.name}; make a second theme of it"


@pytest.mark.parametrize(
    "room", [cameras, grounds, lights, media, occluders, phase, shapes], ids=lambda room: room.__name__
)
def test_every_kind_is_public(room):
    for kind in room.KINDS.values():
        assert kind.__name__ in scene.__all__
        assert kind.__name__ in fogproof.__all__
        assert getattr(scene, kind.__name__) is kind
        assert (getattr(fogproof, kind.__name__) is kind) == (kind.__name__ not in TWICE)


def test_every_check_and_domain_is_public():
    from fogproof import checks, domains

    wanted = {name for name in checks.__all__ if name.startswith(("check_", "compare_"))} | set(domains.__all__)
    assert wanted <= set(fogproof.__all__)


def test_the_readme_imports_public_names_only():
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        for example in re.findall(r"```python\n(.*?)```", path.read_text(), re.S):
            for node in ast.walk(ast.parse(example)):
                if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "fogproof":
                    public = importlib.import_module(node.module)
                    modules = {"analytic", "adapters"} if node.module == "fogproof" else set()
                    assert {alias.name for alias in node.names} <= set(public.__all__) | modules, (
                        path.name,
                        node.module,
                    )


def test_the_package_runs_as_a_module():
    ran = subprocess.run([sys.executable, "-m", "fogproof", "--version"], capture_output=True, text=True, check=True)
    assert ran.stdout == f"fogproof {fogproof.__version__}\n" or fogproof.__version__ in ran.stdout
