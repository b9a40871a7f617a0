"""What the oracle answers to programs: every public function of `fogproof.analytic` that declares itself a quantity.

Nothing is listed here. Unit, convention, source and an example stand beside the function (`analytic/declaration.py`), the
types of its arguments in its signature, what they mean in its docstring; kinds of media or lights in the scene's tables.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property, partial
from types import FunctionType
from typing import Any, get_type_hints

from fogproof import analytic
from fogproof.analytic.declaration import Declaration, declaration_of
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import ImageScene, Scene
from fogproof.scene.arrays import Numbers

OF = ("quantity", "arguments", "albedo")
"""Arguments of what asks about another quantity that stand in that one's request."""

OF_MEANS = "the request of the quantity that is asked about: its name and its arguments"


@dataclass(frozen=True)
class Quantity:
    """A question the oracle answers.

    name        that of the function of `fogproof.analytic`
    summary     what it is, in one sentence
    function    takes the arguments by name
    arguments   name -> its type, or (type, default)
    meanings    name -> what the argument means; an argument that says it all by its type may be missing
    given       arguments as read -> those of the function of `fogproof.analytic`
    of          whether it asks about another quantity, whose request is the argument `of`
    unit, convention, source, example  as declared, see `fogproof.analytic.declaration.Declaration`
    """

    name: str
    summary: str
    function: Callable[..., Reference]
    arguments: dict[str, Any]
    meanings: dict[str, str]
    unit: str
    convention: str
    source: str
    example: dict[str, Any]
    given: Callable[..., dict[str, Any]] = dict
    of: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return what is known of the quantity, JSON-ready; an argument that may be left out is marked so."""
        return {
            "quantity": self.name,
            "summary": self.summary,
            "unit": self.unit,
            "convention": self.convention,
            "arguments": {
                name: {"meaning": self.meanings.get(name, ""), "required": not isinstance(declared, tuple)}
                for name, declared in self.arguments.items()
            },
            "source": self.source,
            "example": {"quantity": self.name, **self.example},
        }

    @cached_property
    def arrays(self) -> dict[str, Numbers]:
        """Arguments that are arrays of numbers, those of rays included: "ray.length" and the like."""
        return dict(_arrays(self.arguments))


@cache
def quantities() -> dict[str, Quantity]:
    """Return every quantity by name."""
    public = {name: getattr(analytic, name) for name in analytic.__all__}
    declared = {name: declaration_of(function) for name, function in public.items()}
    return {name: _quantity(name, public[name], told) for name, told in declared.items() if told}


def _quantity(name: str, function: FunctionType, told: Declaration) -> Quantity:
    arguments, call = _arguments(function), told.answer or function
    given: Callable[..., dict[str, Any]] = dict
    meanings = {**_meanings_of(Scene), **_meanings_of(function)}
    if list(arguments) == ["scene"]:  # programs give a scene by its keys
        scene: type[Scene] | type[ImageScene] = arguments["scene"]
        arguments, call = _fields(scene), lambda **keys: function(scene(**keys))
        given = lambda **keys: {"scene": scene(**keys)}  # noqa: E731
        meanings = {**_meanings_of(scene), **meanings}
    if told.of:
        arguments = {"of": dict[str, Any]} | {name: kind for name, kind in arguments.items() if name not in OF}
        meanings["of"], call = OF_MEANS, partial(_of_another, function)
    documentation = inspect.getdoc(function) or ""
    return Quantity(
        name=name,
        summary=" ".join(documentation.split("\n\n")[0].split()),
        function=call,
        arguments=arguments,
        meanings={argument: meanings[argument] for argument in arguments if argument in meanings},
        unit=told.unit,
        convention=told.convention,
        source=told.source,
        example=told.example,
        given=given,
        of=told.of,
    )


def _of_another(function: Callable[..., Reference], of: tuple[Quantity, dict[str, Any]], **keys: Any) -> Reference:
    """Return what a function says of another quantity, whose request has been read."""
    asked, arguments = of
    if "albedo" in inspect.signature(function).parameters and "albedo" not in arguments:
        raise UnsupportedError(f"{asked.name} has no albedo, so that scatterings are not counted", "of.quantity")
    return function(asked.name, **keys, **asked.given(**arguments))


def _arguments(function: FunctionType) -> dict[str, Any]:
    types = get_type_hints(function, include_extras=True)
    parameters = inspect.signature(function).parameters.values()
    return {p.name: types[p.name] if p.default is p.empty else (types[p.name], p.default) for p in parameters}


def _fields(cls: type) -> dict[str, Any]:
    """Return the fields of a dataclass as arguments."""
    types = get_type_hints(cls, include_extras=True)
    found: dict[str, Any] = {}
    for field in dataclasses.fields(cls):
        required = field.default is field.default_factory is dataclasses.MISSING
        found[field.name] = types[field.name] if required else (types[field.name], field.default)
    return found


def _arrays(arguments: dict[str, Any]) -> Iterator[tuple[str, Numbers]]:
    for name, declared in arguments.items():
        kind = declared[0] if isinstance(declared, tuple) else declared
        for mark in getattr(kind, "__metadata__", ()):
            if isinstance(mark, Numbers):
                yield name, mark
        if dataclasses.is_dataclass(kind) and isinstance(kind, type):
            yield from ((f"{name}.{inner}", mark) for inner, mark in _arrays(_fields(kind)))


def _meanings_of(documented: Any, seen: frozenset[str] = frozenset()) -> dict[str, str]:
    """Return what the docstring says of each argument; one that refers to another function ("as in `…`") is followed there."""
    text = inspect.getdoc(documented) or ""
    found: dict[str, str] = {}
    for referred in re.findall(r"`(\w+)`", text):
        other = getattr(analytic, referred, None)
        if isinstance(other, FunctionType) and referred not in seen:
            found |= {key: told for key, told in _meanings_of(other, seen | {referred}).items() if key not in found}
    own: dict[str, list[str]] = {}
    names: list[str] = []
    for line in text.splitlines():
        head = re.match(r"((?:\w+, )*\w+) {2,}(\S.*)", line)
        if head:
            names = head[1].split(", ")
            own |= {name: [head[2]] for name in names}
        elif names and line.startswith("    "):
            for name in names:
                own[name].append(line.strip())
        else:
            names = []
    return {**found, **{name: " ".join(lines) for name, lines in own.items()}}
