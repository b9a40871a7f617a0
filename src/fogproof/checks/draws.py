"""Where realisations come from: an estimator that is called, batch by batch, or a finite set that is simply there."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof.checks.streams import BATCH, batch_generator
from fogproof.checks.subject import Precision, call
from fogproof.contracts import Draws
from fogproof.errors import SubjectError

DECADES = (1, 9, 90, 900, 9000)
"""Realisations of the first calls where there are many batches: an estimator must not depend on how many it is asked for."""

_ALIKE = 8  # calls of the same size, at most
_LARGE = 2000  # realisations of one of them, at least
_KEPT = 1 << 23  # numbers kept, so that nobody has to be asked twice


@dataclass(frozen=True)
class Source:
    """An estimator and the streams it is drawn from; `known` batches are kept, others can be drawn again alone.

    draw       `draw(rng, n)`, or realisations that are already there: an array (n,) or (n, channels), or `Draws`
    sizes      of the batches
    channels   how many, 0: as many as come
    name       of the streams
    precision  "float32": results in single precision are expected
    """

    draw: Callable[[np.random.Generator, int], Any] | Any
    seed: int
    sizes: tuple[int, ...]
    channels: int
    name: str = "draws"
    precision: Precision = "float64"
    kept: dict[int, tuple[Draws, list[int]]] = field(default_factory=dict)

    @property
    def finite(self) -> bool:
        """Whether the realisations are already there."""
        return not callable(self.draw)

    def batches(self) -> Iterator[tuple[Draws, list[int]]]:
        """Yield all batches, each with the sizes of the calls that it was drawn in."""
        start = 0
        for index, n in enumerate(self.sizes):
            start += n
            if index in self.kept:
                yield self.kept[index]
                continue
            batch = self._slice(start - n, n) if self.finite else self._drawn(index, n)
            if start * max(self.channels, 1) <= _KEPT or index == 0:
                self.kept[index] = batch
            yield batch

    def _slice(self, start: int, n: int) -> tuple[Draws, list[int]]:
        whole: Any = self.draw if isinstance(self.draw, Draws) else (self.draw,)
        parts = [None if part is None else as_array("realisations", part)[start : start + n] for part in whole]
        return self._clean("realisations", Draws._make([*parts, None, None, None][:4]), n), [n]

    def _drawn(self, index: int, n: int) -> tuple[Draws, list[int]]:
        assert callable(self.draw)
        rng = batch_generator(self.seed, self.name, 0, index)
        sizes = [n] if index else calls_of(n, len(self.sizes))
        parts = [self._clean("draw", call("draw(rng, n)", self.draw, rng, size), size) for size in sizes]
        return _joined(parts), sizes

    def _clean(self, who: str, result: Any, n: int) -> Draws:
        draws = result if isinstance(result, Draws) else Draws(result)
        x = as_array(f"{who}: value", draws.value)
        if x.dtype == np.float16:
            fix = "convert them to float64, and allow for their rounding by tolerance=0.0005"
            raise SubjectError(f"{who} returns half precision, which no check takes: {fix}", f"{who}: value")
        if self.precision == "float64" and x.dtype == np.float32:
            message = f'{who} must return float64 numbers, got {x.dtype}; say precision="float32", which allows for their rounding'
            raise SubjectError(message, f"{who}: value")
        channels = self.channels or (x.shape[1] if x.ndim == 2 else 1)
        wanted = {(n,), (n, 1)} if channels == 1 else {(n, channels)}
        if x.shape not in wanted:
            shape = f"({n},)" if self.channels == 1 else f"({n}, {self.channels})"
            fix = "; transpose it: one realisation a row" if x.shape == (self.channels, n) else ""
            fix = fix or ("; give the reference one value a channel" if x.shape[:1] == (n,) and x.ndim == 2 else "")
            if not fix and self.channels > 1 and x.ndim < 2:
                fix = f": the reference has {self.channels} channels; a value with its error is Reference(value, error)"
            raise SubjectError(f"{who} must return an array of shape {shape}, got {x.shape}{fix}", f"{who}: value")
        rest = {}
        for name, part in zip(Draws._fields[1:], draws[1:], strict=True):
            column = None if part is None else as_array(f"{who}: {name}", part)
            if column is not None and column.shape[:1] != (n,):
                raise SubjectError(f"{who} must return a {name} of shape ({n},), got {column.shape}", f"{who}: {name}")
            if name == "order" and column is not None and not np.all(np.mod(column, 1) == 0):
                raise SubjectError(f"{who} must return orders that are whole numbers", f"{who}: order")
            rest[name] = column
        return Draws(x.reshape(n, channels).astype(np.float64), **rest)


def count_of(draw: Any) -> int | None:
    """Return how many realisations a finite set holds, None for an estimator that is called."""
    if callable(draw):
        return None
    if callable(getattr(draw, "draw", None)):
        name = type(draw).__name__
        raise SubjectError(
            f"draw must be a function or realisations, got an object of {name}; pass its method: x.draw", "draw"
        )
    value = as_array("realisations", draw.value if isinstance(draw, Draws) else draw)
    if value.ndim not in (1, 2) or len(value) < 2:
        message = f"realisations must be an array (n,) or (n, channels) with n >= 2, got {value.shape}"
        fix = "; an image (height, width, 3) becomes one by reshape(-1, 3)" if value.ndim == 3 else ""
        raise SubjectError(message + fix, "draw: value")
    return len(value)


def as_array(what: str, value: Any) -> np.ndarray:
    """Return numbers as an array, or one sentence on what came instead."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        hidden = int(np.count_nonzero(np.ma.getmaskarray(value)))
        raise SubjectError(
            f"{what} is a masked array with {hidden} entries hidden; fill or drop them: what is hidden biases", what
        )
    try:
        foreign = not hasattr(value, "__array__") and hasattr(value, "__dlpack__")
        array = np.from_dlpack(value) if foreign else np.asarray(value)
    except Exception as error:  # whatever a foreign array raises, its user must hear what to do
        fix = "return a NumPy array (of a tensor: x.detach().cpu().numpy())"
        raise SubjectError(
            f"{what} cannot be read as an array ({type(error).__name__}: {error}); {fix}", what
        ) from None
    if array.dtype.kind not in "iufb":
        raise SubjectError(f"{what}: draw must return numbers, got {_instead(value, array)}", what)
    return array


def _instead(value: Any, array: np.ndarray) -> str:
    """Return what came instead of numbers, and how to mend it, if that is plain."""
    if value is None:
        return "None; does draw end without a return?"
    if inspect.iscoroutine(value):
        value.close()  # nobody will await it
        return "a coroutine; draw must be a plain function, not an async one"
    if isinstance(value, Iterator):
        return f"a {type(value).__name__}; collect what it yields: np.fromiter(values, float)"
    if isinstance(value, Mapping):
        return f"a {type(value).__name__}; return its values as an array, or Draws(value, cost, order, stderr)"
    fix = {
        "c": "; return real and imaginary parts as two channels",
        "O": "; convert them: np.asarray(values, dtype=float)",
    }
    return f"dtype {array.dtype}{fix.get(array.dtype.kind, '')}"


def calls_of(n: int, batches: int) -> list[int]:
    """Return the sizes of the calls of the first batch.

    Where there are many, the first ones ask for 1, 9, 90, ... realisations. Whether realisations of one call know each other shows
    between calls: where there is enough for it, there are up to eight about as large. Somebody who wants few realisations pays
    for each call: then there are two of them, or one.
    """
    if batches == 1 or n < BATCH:
        return [n] if n < 1000 else [n // 4, n - n // 4] if n < 3 * _LARGE else _evenly(n, min(n // _LARGE, _ALIKE))
    return [*DECADES, *_evenly(n - sum(DECADES), _ALIKE)]


def _evenly(n: int, parts: int) -> list[int]:
    return [n // parts + (i < n % parts) for i in range(parts)]


def _joined(parts: list[Draws]) -> Draws:
    if len(parts) == 1:
        return parts[0]

    def column(name: str) -> np.ndarray | None:
        found = [getattr(part, name) for part in parts]
        return None if found[0] is None else np.concatenate(found)

    value = np.concatenate([part.value for part in parts])
    return Draws(value, column("cost"), column("order"), column("stderr"))
