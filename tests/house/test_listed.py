"""What stands in a room is in its table: a kind, a quantity or a check that is written and not listed would never be known."""

import ast
from importlib import import_module
from pathlib import Path

import pytest

import fogproof
import fogproof.analytic

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("phase", "media", "lights", "shapes", "grounds")
UNLISTED = {
    "microflakes": "its law depends on both directions: an anisotropic medium has it",
    "varying": "a function of the place; files know it by a key of its own",
    "procedural": "a function of the user's stands in no file",
}


def functions(folder):
    """Yield (module, function) of all public functions below a folder."""
    for path in sorted(folder.rglob("*.py")):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                yield path, node


@pytest.mark.parametrize("room", ROOMS)
def test_a_module_that_the_oracle_knows_is_a_kind(room):
    """A module of one name on both sides is that of a kind, which files find in `KINDS` alone."""
    scene, oracle = (
        {p.stem for p in (ROOT / f).glob("*.py")} for f in (f"src/fogproof/scene/{room}", f"analytic/{room}")
    )
    listed = {kind.__module__.rpartition(".")[2] for kind in import_module(f"fogproof.scene.{room}").KINDS.values()}
    lost = (scene & oracle) - listed - {"__init__", *UNLISTED}
    assert not lost, f"{sorted(lost)} lack a line in KINDS of src/fogproof/scene/{room}/__init__.py"


def test_every_quantity_is_exported():
    marked = {
        node.name
        for _, node in functions(ROOT / "analytic")
        if any("quantity" in ast.unparse(decorator).split("(")[0].split(".") for decorator in node.decorator_list)
    }
    lost = marked - set(fogproof.analytic.__all__)
    assert len(marked) > 50
    assert not lost, f"{sorted(lost)} lack a line in analytic/__init__.py"


def test_every_check_is_public():
    checks = {node.name for _, node in functions(ROOT / "src/fogproof/checks") if node.name.startswith("check_")}
    lost = checks - set(fogproof.__all__)
    assert len(checks) > 5
    assert not lost, f"{sorted(lost)} lack a line in __all__ of fogproof"
