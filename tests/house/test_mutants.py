"""The planted errors are in step with the source: each has its place, once, and is an error that Python can run."""

import ast
from collections import Counter

import pytest
from mutants.mutant import LISTS, ROOT, Mutant, mutants
from mutants.reach import folders, module_of

ALL = mutants()
WAITING = 0.03
PARTS = sorted({mutant.part for mutant in ALL})


def test_each_has_its_place():
    """Whoever changes such a line writes the error anew in the list; a few may wait for whoever plants them next, who is told."""
    lost = []
    for mutant in ALL:
        path = ROOT / mutant.file
        count = path.read_text().count(mutant.old) if path.exists() else 0
        if count != 1:
            lost.append(f"{mutant.part}.toml: {mutant.file}: {mutant.what}: {mutant.old!r} occurs {count} times")
    told = "\n".join(lost)
    assert len(lost) <= WAITING * len(ALL), f"tools/mutants/lists: write these anew, or take them out:\n{told}"


@pytest.mark.parametrize("part", PARTS)
def test_each_is_an_error_that_runs(part):
    for mutant in ALL:
        if mutant.part == part:
            path = ROOT / mutant.file
            text = path.read_text() if path.exists() else ""
            assert mutant.old != mutant.new
            if text.count(mutant.old) == 1:
                ast.parse(mutant.applied(text))


def test_they_are_many_and_different():
    assert len(ALL) >= 250
    assert len({mutant.key for mutant in ALL}) == len(ALL)
    assert max(Counter((m.file, m.what) for m in ALL).values()) == 1
    assert {path.stem for path in LISTS.glob("*.toml")} == set(PARTS)
    for mutant in ALL:
        for test in mutant.tests:
            assert (ROOT / test.partition("::")[0]).exists(), f"{mutant.file}: {mutant.what}: no test {test}"


def test_modules_and_their_tests_are_found():
    assert module_of("analytic/media/linear.py") == "fogproof.analytic.media.linear"
    assert module_of("src/fogproof/checks/__init__.py") == "fogproof.checks"
    assert folders("src/fogproof/checks/statistics/bets.py") == ("tests/checks",)


def test_an_error_without_a_place_is_told():
    lost = Mutant("checks", "src/fogproof/text.py", "nothing", "not in any file", "")
    with pytest.raises(ValueError, match="occurs 0 times"):
        lost.applied("a text")
