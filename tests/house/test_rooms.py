"""Invariant: what a medium, light, shape, surface or occluder is, is asked nowhere: each side finds its module by name.

The exceptions are listed with their reasons. Every kind stands on both sides.
"""

import ast
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("media", "lights", "shapes", "occluders", "grounds")
KINDS = {
    name: {kind.__name__: kind for kind in import_module(f"fogproof.scene.{name}").KINDS.values()} for name in ROOMS
}
NAMES = {name for kinds in KINDS.values() for name in kinds} | {"Plane", "Procedural"}
ALLOWED = {
    "analytic/derivatives/parameters.py": "sigma_t and albedo of the one kind that is given by sigma_a and sigma_s",
    "analytic/derivatives/path_length.py": "absorbs the same everywhere",
    "analytic/variance/single_scattering.py": "a formula of point lights alone",
    "src/fogproof/study/methods/airlight.py": "the same",
    "src/fogproof/study/question.py": "a solution of the ball under a sky alone",
    "src/fogproof/scene/surfaces/surface.py": "validates its own field",
    "src/fogproof/scene/media/temperature_grid.py": "the same",
    "src/fogproof/relations/anywhere.py": "relations of a homogeneous box and of a slab",
    "src/fogproof/relations/paths.py": "relations of a grid, of the sun above a slab",
    "src/fogproof/relations/scenes.py": "relations of grids, of half spaces, of the sun above a slab",
    "src/fogproof/relations/setting.py": "the one kind that has no bounds of its own",
}


def questions(source):
    """Names of kinds that `isinstance`, `match`, `type(x) is` or a table by class ask for."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "isinstance":
            asked = node.args[1]
        elif isinstance(node, ast.MatchClass):
            asked = node.cls
        elif isinstance(node, ast.Dict):
            asked = ast.Tuple([key for key in node.keys if isinstance(key, ast.Name)])
        elif isinstance(node, ast.Compare) and any(isinstance(op, ast.Is | ast.IsNot) for op in node.ops):
            asked = ast.Tuple([node.left, *node.comparators])
        else:
            continue
        yield from (part.id for part in ast.walk(asked) if isinstance(part, ast.Name) and part.id in NAMES)


def sources():
    """Every source but the catalogue's, whose cases are about certain kinds, and links to folders that are listed."""
    skipped = tuple(f"src/fogproof/{name}" for name in ("catalogue", "analytic", "estimators", "reports"))
    for folder in ("analytic", "estimators", "reports", "src/fogproof"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if not name.startswith(skipped):
                yield name, path.read_text()


def test_nobody_asks_which_kind_it_is():
    asked = {name: sorted(set(questions(source))) for name, source in sources()}
    found = {name: kinds for name, kinds in asked.items() if kinds and name not in ALLOWED}
    assert not found, f"ask the module of the kind instead, see fogproof.scene.kinds: {found}"


def test_the_guard_sees_every_way_of_asking():
    source = "isinstance(x, PointLight | Ball)\nmatch x:\n    case Slab(): pass\ntype(x) is Disk\n{Medium: 1}[type(x)]"
    assert set(questions(source)) == {"PointLight", "Ball", "Slab", "Disk", "Medium"}


@pytest.mark.parametrize(("room", "name"), [(room, name) for room, kinds in KINDS.items() for name in kinds])
@pytest.mark.parametrize("side", ["analytic", "estimators"])
def test_every_kind_stands_on_both_sides(side, room, name):
    module = KINDS[room][name].__module__.rpartition(".")[2]
    import_module(f"fogproof.{side}.{room}.{module}")
