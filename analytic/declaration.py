"""What a function of the oracle declares beside itself: all that programs, tables and tests know of it.

Names, types and defaults of its arguments stand in its signature, what they mean in its docstring, the rest in `@quantity`:

    @quantity(unit="1/sr", convention=FORWARD, source="Rayleigh 1871", example={"phase": {"kind": "rayleigh"}, "mu": 0.5})
    def phase_pdf(phase: PhaseFunctionField, mu: FloatArray) -> Reference: ...

A public function with a declaration answers over JSON, and stands in the schema, the list of quantities and the docs.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import numpy as np

from fogproof.contracts import Reference
from fogproof.errors import FogproofError, InvalidValueError
from fogproof.scene.rays import Ray

Function = TypeVar("Function", bound=Callable[..., Any])

FORWARD = "mu is the forward cosine: propagation direction in . propagation direction out"
RADIANCE = "W/(m^2 sr)"
MEAN_FREE_PATHS = "lengths in mean free paths: sigma_t times metres"

RAY = {"origin": [0, 0, -2], "direction": [0, 0, 1], "length": [1, 4, "inf"]}
FOG = {"sigma_a": 0.1, "sigma_s": 0.4}
LAMP = {"position": [1, 1, 0], "intensity": 3}
"""Parts of the examples."""


@dataclass(frozen=True)
class Declaration:
    """What a function of the oracle says of its answers.

    unit        of the value; 1 for a number without one
    convention  the sign, direction and normalisation that tell this quantity from its relatives
    source      author, year, equation
    example     arguments of a small question, as JSON puts them
    answer      the function that answers programs, with the same arguments, if the declared one returns no `Reference`
    of          whether it asks about another quantity, which comes first; programs give that as a request, `of`
    """

    unit: str
    convention: str
    source: str
    example: dict[str, Any]
    answer: Callable[..., Reference] | None = None
    of: bool = False


def quantity(
    *,
    unit: str,
    convention: str,
    source: str,
    example: dict[str, Any],
    answer: Callable[..., Reference] | None = None,
    of: bool = False,
) -> Callable[[Function], Function]:
    """Declare a function of the oracle to be a quantity; see `Declaration`. Shapes that do not broadcast are refused by name."""
    declared = Declaration(unit, convention, source, example, answer, of)

    def declare(function: Function) -> Function:
        @functools.wraps(function)
        def quantity_function(*arguments: Any, **keywords: Any) -> Any:
            try:
                return function(*arguments, **keywords)
            except FogproofError:
                raise
            except ValueError as error:
                if "broadcast" not in str(error):
                    raise
                shapes = _shapes(inspect.signature(function).bind(*arguments, **keywords).arguments)
                raise InvalidValueError(
                    next(iter(shapes), "arguments"),
                    "must broadcast with the other arguments",
                    ", ".join(f"{name} {list(shape)}" for name, shape in shapes.items()),
                    "axes must be equal or 1",
                ) from None

        quantity_function.declaration = declared  # type: ignore[attr-defined]
        return cast(Function, quantity_function)

    return declare


def _shapes(arguments: dict[str, Any]) -> dict[str, tuple[int, ...]]:
    """Return the shapes of those arguments that have one: arrays of numbers, and rays."""
    shapes: dict[str, tuple[int, ...]] = {}
    for name, value in arguments.items():
        if isinstance(value, Ray):
            shapes[name] = value.shape
        elif isinstance(value, int | float | list | tuple | np.ndarray | np.number) and not isinstance(value, bool):
            shapes[name] = np.shape(value)
    return shapes


def declaration_of(function: Any) -> Declaration | None:
    """Return what a function declares of itself, None for one that is no quantity."""
    return getattr(function, "declaration", None)
