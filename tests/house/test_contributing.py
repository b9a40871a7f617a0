"""The recipes of CONTRIBUTING name every file there is to touch, and none that is not there."""

import ast
import re
from pathlib import Path

import pytest

import fogproof
from fogproof import domains
from fogproof.scene import lights, media, phase, shapes
from fogproof.study.methods.table import METHODS

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text()
RECIPES = dict(re.findall(r"^## Adding an? ([a-z ]+)\n(.*?)(?=^## )", TEXT, re.S | re.M))
FOLDERS = ("src", "analytic", "estimators", "reports", "tests", "tools", "docs", "schemas", "studies")
NAMED = re.compile(rf"`((?:{'|'.join(FOLDERS)})/[\w/.<>*-]*)`")


def test_there_is_a_recipe_for_everything():
    things = [
        "sampler",
        "case",
        "quantity",
        "check",
        "domain",
        "light",
        "shape",
        "medium",
        "phase_function",
        "study_method",
        "formula",
        "bug",
    ]
    assert set(RECIPES) == {thing.replace("_", " ") for thing in things}


@pytest.mark.parametrize("recipe", RECIPES)
def test_every_file_it_names_is_there(recipe):
    named = NAMED.findall(RECIPES[recipe])
    assert named
    for path in named:
        assert list(ROOT.glob(re.sub(r"<\w+>", "*", path).rstrip("/"))), path


@pytest.mark.parametrize(
    ("recipe", "room", "kind"),
    [
        ("phase function", phase, "fournier_forand"),
        ("medium", media, "gaussian_puffs"),
        ("light", lights, "rectangle"),
        ("shape", shapes, "ball"),
    ],
)
def test_a_kind_is_in_no_other_file_of_the_sources(recipe, room, kind):
    """Whoever follows the recipe has touched every file that names the kind, as the files of one that is there show."""
    named = {path.replace("<kind>", kind) for path in NAMED.findall(RECIPES[recipe])}
    (thing,) = (cls.__name__ for cls in room.KINDS.values() if cls.__module__.endswith(f".{kind}"))
    theme = {"phase function": "phase", "medium": "media", "light": "lights", "shape": "shapes"}[recipe]
    for side in ("src/fogproof/scene", "analytic", "estimators"):
        own = f"{side}/{theme}/{kind}.py"
        assert own in named
        assert (ROOT / own).exists()
        for path in (ROOT / side / theme).glob("*.py"):
            relative = path.relative_to(ROOT).as_posix()
            names = {node.id for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Name)}
            assert thing not in names or relative in named, relative


@pytest.mark.parametrize(
    ("recipe", "thing", "home"),
    [("domain", "SphericalTriangle", "domains/spherical_triangle"), ("check", "check_mis", "checks/mis")],
)
def test_a_domain_and_a_check_cost_one_file_and_one_table(recipe, thing, home):
    """Nobody else names them, and the package has them by the table alone."""
    source = ROOT / "src/fogproof"
    files = {f"{home}.py", f"{home.partition('/')[0]}/__init__.py"}
    naming = {path for path in source.rglob("*.py") if re.search(rf"\b{thing}\b", path.read_text())}
    assert {path.relative_to(source).as_posix() for path in naming} <= files
    assert f"`src/fogproof/{home.partition('/')[0]}/__init__.py`" in RECIPES[recipe]
    assert thing in fogproof.__all__
    assert getattr(fogproof, thing).__module__ == f"fogproof.{home.replace('/', '.')}"


def test_every_domain_has_its_name_in_files():
    functions = {domains.SpherePart}  # no file holds one
    offered = {getattr(domains, name) for name in domains.__all__} - {domains.Domain, domains.Law}
    assert set(domains.KINDS.values()) == offered - functions


def test_the_way_to_a_study_method_is_the_one_taken():
    table = "src/fogproof/study/methods/table.py"
    assert table in NAMED.findall(RECIPES["study method"])
    for method in METHODS.values():
        assert (ROOT / "src" / Path(*method.__module__.split("."))).with_suffix(".py").parent.name == "methods"


def test_every_word_of_the_glossary_is_used():
    rows = re.findall(r"^\| ([a-z][a-z ,]*) \| ", TEXT[TEXT.index("## Glossary") :], re.M)
    prose = (ROOT / "ARCHITECTURE.md").read_text() + (ROOT / "README.md").read_text()
    for folder in ("src", "analytic", "estimators"):
        prose += "".join(path.read_text() for path in (ROOT / folder).rglob("*.py"))
    for word in {word for row in rows for word in row.split(", ")} - {"word"}:
        assert re.search(rf"\b{word}s?\b", prose, re.I), word
