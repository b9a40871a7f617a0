"""What is to be checked, and how it is called: shapes and types are verified here, so the checks see clean float64 arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np

from fogproof.contracts import Draw, Reference
from fogproof.domains import Discrete, Domain
from fogproof.errors import FogproofError, InvalidValueError, SubjectError, shorten
from fogproof.validate import number

Precision = Literal["float64", "float32"]
UNIT_ROUNDOFF: dict[Precision, float] = {"float64": 2.0**-53, "float32": 2.0**-24}


@dataclass(frozen=True)
class Subject:
    """A sampler and all it declares; the fields are the arguments of `check_sampler`."""

    sample: Callable[..., Any]
    pdf: Callable[[np.ndarray], Any]
    domain: Domain
    dimensions: int | None
    atoms: Mapping[Any, float] = field(default_factory=dict)
    cdf: Callable[[np.ndarray], Any] | None = None
    eval: Callable[[np.ndarray], Any] | None = None
    axis: tuple[float, float, float] | None = None
    mean_cosine: float | None = None
    albedo: float | tuple[float, ...] | None = None
    reference: Callable[[np.ndarray], Reference] | None = None
    precision: Precision = "float64"

    @property
    def roundoff(self) -> float:
        """Unit roundoff of the arithmetic the sampler uses."""
        return UNIT_ROUNDOFF[self.precision]

    def validate(self) -> None:
        """Raise `InvalidValueError` if a declaration breaks a rule."""
        if not isinstance(self.domain, Domain):
            raise InvalidValueError("domain", "must be one of fogproof.domains, or have its parts", self.domain)
        if self.dimensions is not None and not (isinstance(self.dimensions, int) and self.dimensions >= 1):
            raise InvalidValueError("dimensions", "must be a whole number >= 1, or None", self.dimensions)
        if self.precision not in get_args(Precision):
            raise InvalidValueError("precision", "must be 'float64' or 'float32'", self.precision)
        if self.atoms and isinstance(self.domain, Discrete):
            raise InvalidValueError("atoms", "need a density: on Discrete the pdf is a probability", self.domain)
        for point, probability in self.atoms.items():
            number(f"atoms[{point!r}]", probability, "must be a probability in [0, 1]", 0, 1)
            if np.shape(point) != self.domain.shape:
                raise InvalidValueError("atoms", f"must be points of {self.domain}", point)
        if self.mean_cosine is not None and self.axis is None:
            raise InvalidValueError("axis", "must be given with mean_cosine", self.axis)

    def draw(self, rng: np.random.Generator, n: int) -> Draw:
        """Draw n samples, from uniforms or, where the sampler uses a varying number, from the generator itself.

        Uniforms have the subject's own precision: a float64 just below 1 would round to 1 in single precision.
        """
        if self.dimensions is None:
            return as_draw(call("sample(rng, n)", self.sample, rng, n), n, self.domain)
        kind = np.float32 if self.precision == "float32" else np.float64
        return self.draw_at(rng.random((n, self.dimensions), dtype=kind))

    def draw_at(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, dimensions) to a `Draw` of float64 arrays."""
        return as_draw(call("sample(u)", self.sample, u), len(u), self.domain)

    def density(self, x: np.ndarray) -> np.ndarray:
        """Return pdf(x), (m,) float64."""
        return numbers("pdf(x)", call("pdf(x)", self.pdf, x), (len(x),))

    def at_atom(self, x: np.ndarray) -> dict[Any, np.ndarray]:
        """Return for each declared atom which of the points are at it, in the sampler's precision.

        A number must be the atom's; a point of several numbers, such as a mirrored direction, may differ from it by rounding.
        """
        if x.ndim > 1:
            slack = 16 * self.roundoff
            near = {point: np.abs(x - point) <= slack * (1 + np.abs(point)) for point in self.atoms}
            return {point: each.all(axis=1) for point, each in near.items()}
        if self.precision == "float32":
            return {point: x.astype(np.float32) == np.float32(point) for point in self.atoms}
        return {point: x == point for point in self.atoms}


def call(what: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """Call the user's function; whatever it raises becomes a `SubjectError` that says where."""
    try:
        return function(*arguments)
    except FogproofError:
        raise
    except Exception as error:
        raise SubjectError(f"{what} raised {type(error).__name__}: {error}", what) from error


def numbers(what: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return `value` as a float64 array of the shape promised, or say what came instead."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise SubjectError(f"{what} must return an array of shape {shape}: {error}", what) from None
    if array.dtype.kind not in "iufb":
        raise SubjectError(f"{what} must return numbers, got dtype {array.dtype}: {shorten(value)}", what)
    if array.shape != shape:
        raise SubjectError(f"{what} must return an array of shape {shape}, got {array.shape}", what)
    return array.astype(np.float64, copy=False)


def as_draw(result: Any, n: int, domain: Domain) -> Draw:
    """Return what a sampler returned as a `Draw` of n points; every array has the shape its contract promises."""
    draw = result if isinstance(result, Draw) else Draw(result)
    x = numbers("sample: x", draw.x, (n, *domain.shape))
    pdf = None if draw.pdf is None else numbers("sample: pdf", draw.pdf, (n,))
    event = None if draw.event is None else numbers("sample: event", draw.event, (n,))
    valid = None if draw.valid is None else numbers("sample: valid", draw.valid, (n,)).astype(bool)
    weight = None if draw.weight is None else np.asarray(draw.weight, dtype=np.float64)
    if weight is not None and (weight.ndim not in (1, 2) or len(weight) != n):
        raise SubjectError(f"sample: weight must have shape ({n},) or ({n}, channels), got {weight.shape}", "weight")
    return Draw(x, pdf, weight, event, valid)


def in_domain(domain: Domain, x: np.ndarray, roundoff: float) -> np.ndarray:
    """Return which points lie in the domain, up to a few roundings; NaN and infinity do not."""
    return domain.contains(x, 16 * roundoff)


def nudged(x: np.ndarray, roundoff: float) -> list[np.ndarray]:
    """Return copies of the points, each moved along one coordinate by a few roundings, both ways.

    How much a density changes there is how much of a difference rounding alone can explain.
    """
    step = 4 * roundoff
    if x.ndim == 1:
        return [x * (1 + step), x * (1 - step)]
    moved = []
    for axis in range(x.shape[1]):
        for sign in (step, -step):
            copy = x.copy()
            copy[:, axis] += sign
            moved.append(copy)
    return moved


def rounding_spread(f: Callable[[np.ndarray], np.ndarray], x: np.ndarray, roundoff: float) -> np.ndarray:
    """Return (m,) how far f(x) may be off because x and f are rounded numbers."""
    y = f(x)
    moves = np.sum([np.abs(f(z) - y) for z in nudged(x, roundoff)], axis=0)
    return 64 * roundoff * np.abs(y) + 2 * np.nan_to_num(moves, nan=np.inf)


def named(point: Any) -> str:
    """Return an atom's point in words."""
    return f"({', '.join(f'{number:g}' for number in point)})" if isinstance(point, tuple) else f"{point:g}"
