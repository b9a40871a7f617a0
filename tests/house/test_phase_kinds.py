"""Every kind of phase function stands in every room, or is listed here with its reason; and only the rooms ask for the kind."""

import ast
from pathlib import Path

import pytest
from phase_functions import EXAMPLES

from fogproof.analytic.phase import kinds as oracle
from fogproof.estimators.phase import kinds as drawing
from fogproof.scene.kinds import given, module_of
from fogproof.scene.phase import KINDS

ROOT = Path(__file__).parents[2]

NOT_PROVEN = {
    "mie": "a series whose coefficients come from a program without error bounds",
    "polydisperse-mie": "the same, many times",
    "tabulated": "no formula: ball arithmetic would have to cut integrals at every cosine",
}
"""Kinds without `ball` and `peak`."""

FOR_ITS_KIND = {
    "analytic/lights/environment.py": "isotropic scattering needs no integral over the angle to the ray",
    "analytic/airlight/pegoraro2009.py": "a published method for isotropic scattering only",
    "analytic/airlight/pegoraro2010.py": "a published method whose series are per kind",
    "analytic/airlight/sun2005.py": "a published method for isotropic scattering only",
    "src/fogproof/study/question.py": "the half space is solved for isotropic scattering only",
}
"""Files outside the rooms that ask for one kind, and why."""

ROOMS = ("analytic/phase", "estimators/phase", "src/fogproof/scene/phase", "src/fogproof/catalogue")


def test_there_is_an_example_of_every_kind():
    assert {kind: type(phase) for kind, phase in EXAMPLES.items()} == KINDS


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_its_module_in_every_room(kind):
    phase = EXAMPLES[kind]
    assert module_of(phase, oracle.ROOM)
    assert module_of(phase, drawing.ROOM)
    for room, needed in ((oracle.ROOM, ("pdf",)), (drawing.ROOM, ("polar", "density"))):
        mean = given(phase, room, "parts")
        assert mean is not None or all(given(phase, room, name) for name in needed)
    for part in [part for _, part in oracle.weighted_parts(phase)]:
        for name in ("ball", "peak"):
            assert (given(part, oracle.ROOM, name) is None) == (kind in NOT_PROVEN)


def _asked(path: Path) -> set[str]:
    """Return the kinds that a file asks for, by isinstance, match or type()."""
    names = {cls.__name__ for cls in KINDS.values()} | {"VaryingPhase", "PhaseFunction"}
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        asked = []
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("isinstance", "issubclass"):
            asked = node.args[1:]
        elif isinstance(node, ast.MatchClass):
            asked = [node.cls]
        elif isinstance(node, ast.Compare):
            asked = [*node.comparators, node.left] if "type(" in ast.unparse(node) else []
        found |= {n.id for one in asked for n in ast.walk(one) if isinstance(n, ast.Name) and n.id in names}
    return found


def test_nobody_outside_the_rooms_asks_for_the_kind():
    asking = {}
    for folder in ("analytic", "estimators", "reports", "src/fogproof"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            place = path.relative_to(ROOT).as_posix()
            inside = place.startswith(ROOMS) or any(parent.is_symlink() for parent in path.parents)
            if not inside and (asked := _asked(path)):
                asking[place] = asked
    assert set(asking) == set(FOR_ITS_KIND), asking
