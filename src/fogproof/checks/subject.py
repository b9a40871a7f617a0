"""What is to be checked, and how it is called: shapes and types are verified here, so the checks see clean float64 arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from fogproof.contracts import Draw, Reference
from fogproof.domains import Domain
from fogproof.domains.law import whole_columns
from fogproof.errors import FogproofError, SubjectError, is_stop, shorten

Precision = Literal["float64", "float32"]
_BLOCK = 1 << 14  # points of a call, of many
_COARSE = ("float32", "float16", "bfloat16")
_FIXES = {
    "used as indices must be of integer": "; here whole numbers come as floats: index with x.astype(int)",
    "Integers to negative integer powers": "; points of a table are integers: write a float, as in 2.0**-k",
}
"""What to do about what NumPy says of the type of points."""
UNIT_ROUNDOFF: dict[Precision, float] = {"float64": 2.0**-53, "float32": 2.0**-24}


@dataclass(frozen=True)
class Subject:
    """A sampler and all it declares; the fields are the arguments of `check_sampler`, but for the last.

    pilot  how many samples there are for the first look, None if as many as anybody wants
    """

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
    events: Mapping[int, float] = field(default_factory=dict)
    uniform_bits: int | None = None
    quasi_random: bool = False
    breaks: Mapping[str, Any] = field(default_factory=dict)
    support: Domain | None = None
    inverse: Callable[[np.ndarray], Any] | None = None
    pilot: int | None = None

    @property
    def bits(self) -> int:
        """How many bits the sampler's uniforms have."""
        return self.uniform_bits or (24 if self.precision == "float32" else 53)

    @property
    def roundoff(self) -> float:
        """Unit roundoff of the arithmetic the sampler uses."""
        return UNIT_ROUNDOFF[self.precision]

    def draw(self, rng: np.random.Generator, n: int) -> Draw:
        """Draw n samples, from uniforms or, where the sampler uses a varying number, from the generator itself."""
        if self.dimensions is None:
            return as_draw(call("sample(rng, n)", self.sample, rng, n), n, self.domain, self.precision)
        return self.draw_at(self.uniforms(rng, n))

    def uniforms(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Return (n, dimensions) uniforms in the subject's own precision: a float64 just below 1 would round to 1 in single."""
        assert self.dimensions is not None
        return rng.random((n, self.dimensions), dtype=self.precision)

    def draw_at(self, u: np.ndarray) -> Draw:
        """Map uniforms (n, dimensions) to a `Draw` of float64 arrays."""
        return as_draw(call("sample(u)", self.sample, u), len(u), self.domain, self.precision)

    def density(self, x: np.ndarray) -> np.ndarray:
        """Return pdf(x), (m,) float64; of many points block by block, whose temporary arrays stay in the cache."""
        if len(x) > 2 * _BLOCK:
            return np.concatenate([self.density(x[start : start + _BLOCK]) for start in range(0, len(x), _BLOCK)])
        return numbers("pdf(x)", call("pdf(x)", self.pdf, x), (len(x),))

    def nudged(self, x: np.ndarray, roundoff: float | None = None) -> list[np.ndarray]:
        """Return copies of the points moved as far as rounding moves them, by `roundoff` or by the sampler's own."""
        return nudged(x, self.roundoff if roundoff is None else roundoff, whole_columns(self.domain))

    def rounding_spread(self, f: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
        """Return (m,) how far f(x) may be off because x and f are rounded numbers."""
        y = f(x)
        moves = np.sum([np.abs(f(z) - y) for z in self.nudged(x)], axis=0)
        return 64 * self.roundoff * np.abs(y) + 2 * np.nan_to_num(moves, nan=np.inf)

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
    except (
        Exception,
        SystemExit,
        GeneratorExit,
        KeyboardInterrupt,
    ) as error:  # what ends a program must not end a check
        if is_stop(error):
            raise
        fix = next((fix for words, fix in _FIXES.items() if words in str(error)), "")
        raise SubjectError(f"{what} raised {type(error).__name__}: {error}{fix}", what) from error


def numbers(what: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return `value` as a float64 array of the shape promised, or say what came instead and how to mend it."""
    return _numbers(what, _array(what, value), value, shape)


def _numbers(what: str, array: np.ndarray, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    if array.dtype.kind not in "iufb":
        raise SubjectError(f"{what} must return numbers, got dtype {array.dtype}: {shorten(value)}", what)
    if array.shape != shape:
        fix = _reshaping(array.shape, shape)
        raise SubjectError(f"{what} must return an array of shape {shape}, got {array.shape}{fix}", what)
    return array.astype(np.float64, copy=False)


def _array(what: str, value: Any) -> np.ndarray:
    """Return anything array-like as a NumPy array; what hides entries or will not be copied is refused with the fix."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        hidden = int(np.count_nonzero(np.ma.getmaskarray(value)))
        fix = "mark samples that are given up with Draw(x, valid=~mask)"
        raise SubjectError(f"{what} is a masked array with {hidden} entries hidden; {fix}", what)
    try:
        foreign = not hasattr(value, "__array__") and hasattr(value, "__dlpack__")
        return np.from_dlpack(value) if foreign else np.asarray(value)
    except Exception as error:  # whatever a foreign array raises, its user must hear what to do
        fix = "return a NumPy array (of a tensor: x.detach().cpu().numpy())"
        raise SubjectError(
            f"{what} cannot be read as an array ({type(error).__name__}: {error}); {fix}", what
        ) from None


def _reshaping(got: tuple[int, ...], wanted: tuple[int, ...]) -> str:
    """Return in words how the one shape becomes the other, if that is plain."""
    if got == wanted[::-1] and len(wanted) == 2:
        return "; transpose it: one point a row"
    if got == (*wanted, 1):
        return "; drop the last axis: x[:, 0]"
    if got in ((), (1,)) and len(wanted) == 1:
        return "; a constant needs one value a point: np.full(len(x), value)"
    return ""


def as_draw(result: Any, n: int, domain: Domain, precision: Precision = "float64") -> Draw:
    """Return what a sampler returned as a `Draw` of n points; every array has the shape its contract promises.

    They are copies: a sampler may fill one buffer anew in every call.
    """
    if isinstance(result, (tuple, list)) and not isinstance(result, Draw) and len(result) and len(result) != n:
        if all(getattr(part, "shape", None) == (n,) for part in result) and domain.shape == (len(result),):
            raise SubjectError("sample returned one array a coordinate; join them: np.stack(parts, axis=-1)", "sample")
        if all(hasattr(part, "shape") or hasattr(part, "__dlpack__") for part in result):
            given = f"sample returned a {type(result).__name__} of {len(result)}"
            raise SubjectError(f"{given}; name its parts: fogproof.Draw(x, pdf=..., weight=...)", "sample")
    draw = result if isinstance(result, Draw) else Draw(result)
    own = _array("sample: x", draw.x)
    x = _numbers("sample: x", own, draw.x, (n, *domain.shape))
    kind = getattr(draw.x, "dtype", own.dtype)  # PyTorch's bfloat16 arrives as another type
    kind = own.dtype if own.dtype.name in _COARSE else kind
    if precision == "float64" and str(kind).rpartition(".")[2] in _COARSE:
        fix = 'say precision="float32", or compute in double precision'
        raise SubjectError(f"sample: x is {kind} where double precision is claimed; {fix}", "sample")
    pdf = None if draw.pdf is None else numbers("sample: pdf", draw.pdf, (n,))
    event = None if draw.event is None else numbers("sample: event", draw.event, (n,))
    valid = None if draw.valid is None else flags("sample: valid", draw.valid, n)
    weight = None if draw.weight is None else _array("sample: weight", draw.weight)
    if weight is not None and (weight.ndim not in (1, 2) or len(weight) != n or weight.dtype.kind not in "iufb"):
        raise SubjectError(f"sample: weight must have shape ({n},) or ({n}, channels), got {weight.shape}", "weight")
    weight = None if weight is None else weight.astype(np.float64, copy=False)
    pdf, weight, event = (None if part is None else part.copy() for part in (pdf, weight, event))
    return Draw(x.copy(), pdf, weight, event, valid)


def flags(what: str, value: Any, n: int) -> np.ndarray:
    """Return n marks, each 0 or 1, as truth values."""
    found = numbers(what, value, (n,))
    odd = (found != 0) & (found != 1)
    if odd.any():
        raise SubjectError(f"{what} must be 0 or 1, got {found[odd][0]:g}: a share of a sample is a weight", what)
    return found.astype(bool)


def in_domain(domain: Domain, x: np.ndarray, roundoff: float) -> np.ndarray:
    """Return which points lie in the domain, up to a few roundings; NaN and infinity do not."""
    return np.asarray(call("the domain's contains(x)", domain.contains, x, 16 * roundoff))


def nudged(x: np.ndarray, roundoff: float, whole: Sequence[bool] = ()) -> list[np.ndarray]:
    """Return copies of the points, each moved along one coordinate by a few roundings, both ways.

    How much a density changes there is how much of a difference rounding alone can explain. A coordinate of a vector is rounded as
    its own size has it, or as that of the others, up to 1, of which a frame may have made it. Coordinates that are `whole` numbers
    stay: the next one is no neighbour.
    """
    step = 4 * roundoff
    if any(whole) and all(whole):
        return [x.copy()]
    if x.ndim == 1:
        return [x * (1 + step), x * (1 - step)]
    moved, largest = [], np.minimum(np.abs(x).max(axis=1, initial=0.0), 1.0)
    for axis in range(x.shape[1]):
        if whole and whole[axis]:
            continue
        size = np.maximum(np.abs(x[:, axis]), largest)
        for sign in (step, -step):
            copy = x.copy()
            copy[:, axis] += sign * size
            moved.append(copy)
    return moved


def named(point: Any) -> str:
    """Return an atom's point in words."""
    return f"({', '.join(f'{number:g}' for number in point)})" if isinstance(point, tuple) else f"{point:g}"
