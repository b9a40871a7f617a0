"""Where a kind of thing is looked for on each side."""

import sys
from dataclasses import make_dataclass
from types import ModuleType

import pytest

from fogproof.scene.kinds import given, module_of


@pytest.fixture
def room(monkeypatch, tmp_path):
    """A package `room` with one kind, another that cannot be imported, and none for the third."""
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "__init__.py").touch()
    (tmp_path / "room" / "round_thing.py").write_text("def size(thing): return thing.size\n")
    (tmp_path / "room" / "broken_thing.py").write_text("import there_is_no_such_module\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield
    for name in [name for name in sys.modules if name.partition(".")[0] == "room"]:
        monkeypatch.delitem(sys.modules, name)


def _thing(kind):
    cls = make_dataclass("Thing", ["size"])
    cls.__module__ = f"fogproof.scene.things.{kind}"
    return cls(3)


@pytest.mark.usefixtures("room")
def test_a_kind_is_served_by_the_module_of_its_name():
    thing = _thing("round_thing")
    assert isinstance(module_of(thing, "room"), ModuleType)
    assert given(thing, "room", "size")(thing) == 3
    assert given(thing, "room", "colour") is None


@pytest.mark.usefixtures("room")
def test_a_room_without_the_kind_has_none():
    assert module_of(_thing("square_thing"), "room") is None
    assert given(_thing("square_thing"), "room", "size") is None


@pytest.mark.usefixtures("room")
def test_a_module_that_fails_is_not_taken_for_absent():
    with pytest.raises(ModuleNotFoundError, match="there_is_no_such_module"):
        module_of(_thing("broken_thing"), "room")
