"""Which tests import a file of the source, and by how many steps?"""

from __future__ import annotations

import ast
import importlib
from collections import defaultdict, deque
from functools import cache
from pathlib import Path

from mutants.mutant import ROOT

_PLACES = {"analytic": "fogproof.analytic", "estimators": "fogproof.estimators", "reports": "fogproof.reports"}
_TESTS = {  # where the tests of a folder of the source are
    "analytic": ("tests/oracle",),
    "estimators": ("tests/estimators",),
    "reports": ("tests/reports",),
    "checks": ("tests/checks",),
    "study": ("tests/study",),
    "cli": ("tests/cli",),
    "scene": ("tests/scene", "tests/estimators"),
    "oracle": ("tests/oracle",),
    "golden": ("tests/oracle",),
    "domains": ("tests/checks",),
    "catalogue": ("tests/catalogue",),
}
_TOP = ("tests/scene", "tests/catalogue", "tests/reports", "tests/estimators")


def folders(file: str) -> tuple[str, ...]:
    """Return the folders of tests that a survivor in this file must meet."""
    parts = Path(file).parts
    name = parts[2] if parts[0] == "src" else parts[0]
    return _TESTS.get(name, _TOP)


def tests_of(file: str, most: int) -> list[str]:
    """Return test files that import the module, those of its name and the most direct first, `most` at most."""
    start, users = module_of(file), _users()
    stem = start.rpartition(".")[2]
    steps, queue = {start: 0}, deque([start])
    while queue:
        module = queue.popleft()
        for user in users[module]:
            if user not in steps:
                steps[user] = steps[module] + 1
                queue.append(user)
    own = folders(file)
    tests = [name for name in steps if name.startswith("tests/")]
    return sorted(tests, key=lambda name: (stem not in name, steps[name], not name.startswith(own), name))[:most]


def module_of(file: str) -> str:
    """Return the dotted name of a file of the source."""
    parts = list(Path(file).with_suffix("").parts)
    parts = [_PLACES[parts[0]], *parts[1:]] if parts[0] in _PLACES else parts[1:]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def _users() -> dict[str, set[str]]:
    """Return for every module who imports it: modules by their dotted names, tests by their files."""
    users = defaultdict(set)
    for folder in ("analytic", "estimators", "reports", "src"):
        for path in (ROOT / folder).rglob("*.py"):
            file = path.relative_to(ROOT).as_posix()
            if not file.startswith(tuple(f"src/fogproof/{place}" for place in _PLACES)):
                for used in _imported(path):
                    users[used].add(module_of(file))
    for path in (ROOT / "tests").rglob("*.py"):
        file = path.relative_to(ROOT).as_posix()
        name = file if path.name.startswith("test_") else path.stem  # helpers of tests are found by their names
        for used in _imported(path):
            users[used].add(name)
    return users


def _imported(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                found.add(_home(node.module, alias.name))
    return found


@cache
def _home(module: str, name: str) -> str:
    """Return where something comes from that `from module import name` gives: a package hands on what its modules hold."""
    if not module.startswith("fogproof"):
        return module
    try:
        thing = getattr(importlib.import_module(module), name, None)
        if thing is None:
            return importlib.import_module(f"{module}.{name}").__name__
    except ImportError:
        return module
    if type(thing).__name__ == "module":
        return thing.__name__
    home = getattr(thing, "__module__", None)
    return home if isinstance(home, str) and home.startswith("fogproof") else module
