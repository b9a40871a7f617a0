"""A program as a sampler: what `check_sampler` calls becomes questions over the pipe."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from fogproof.checks.subject import Precision, flags
from fogproof.contracts import Draw
from fogproof.domains import Domain
from fogproof.pipe.blocks import swapped
from fogproof.pipe.faults import ProgramError
from fogproof.pipe.program import Program

LARGEST_SEED = 2**53
"""Whole numbers below it are exact in the float64 of every language."""

_SLACK = 1e-5  # a point that is off by less is read as it was meant
_SHOWN = 1000  # rows tell which column is which
_SAME = 1e-3  # of a density: printed numbers may have few digits

Density = Callable[[np.ndarray], np.ndarray]


def draw_of(rows: np.ndarray, columns: tuple[str, ...], domain: Domain) -> Draw:
    """Return rows (n, k) with named columns as a `Draw`."""

    def column(name: str) -> np.ndarray | None:
        places = [i for i, each in enumerate(columns) if each == name]
        return None if not places else rows[:, places[0]] if len(places) == 1 else rows[:, places]

    places = [i for i, each in enumerate(columns) if each == "x"]
    together = places == list(range(places[0], places[-1] + 1))
    x = rows[:, places[0] : places[-1] + 1] if together else rows[:, places]
    valid = column("valid")
    return Draw(
        x if domain.shape else x[:, 0],
        column("pdf"),
        column("weight"),
        column("event"),
        None if valid is None else flags("valid", valid, len(rows)),
    )


@dataclass(eq=False)
class PipeSampler:
    """A program that answers "sample", and "pdf" and "eval" if it says so.

    law      a density that stands in for the program's own, where it answers no "pdf"
    options  further arguments of `check_sampler`
    """

    program: Program
    domain: Domain
    dimensions: int | None
    precision: Precision
    atoms: Mapping[Any, float]
    parameters: Mapping[str, float]
    law: Callable[[np.ndarray], np.ndarray] | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    _seen: bool = field(default=False)

    @property
    def eval(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """What weights are for, None if the program does not answer that."""
        return self._eval if "eval" in self.program.greeting.answers else None

    def sample(self, u: Any, n: int | None = None) -> Draw:
        """Return a `Draw` for uniforms (n, dimensions), or for (rng, n) where the program draws its own numbers."""
        if n is None:
            rows, count, seed = np.asarray(u), len(u), 0
        else:
            rows, count, seed = np.empty((n, 0)), n, int(u.integers(LARGEST_SEED))
        columns = self.program.greeting.columns
        answer = self.program.ask("sample", rows, count, len(columns), seed, self.parameters)
        draw = draw_of(answer, columns, self.domain)
        if not self._seen and count >= 64:
            self._seen, self.program.shown = True, draw.x
            hint = misread(self.domain, answer, columns, self.pdf) or self._misreading(rows, answer)
            if hint:
                raise self.program.refuse(*hint)
        return draw

    def _misreading(self, rows: np.ndarray, answer: np.ndarray) -> tuple[str, str] | None:
        """Return that the program takes its input for big-endian, if its answers make sense only then."""
        columns = self.program.greeting.columns
        if not rows.size or self.program.greeting.type == "text" or _sensible(self.domain, answer, columns) > 0.5:
            return None
        try:
            with self.program.another() as other:
                again = other.ask("sample", swapped(rows), len(rows), len(columns), 0, self.parameters)
        except ProgramError:
            return None
        ways = {"reads big-endian numbers": again, "reads and writes big-endian numbers": swapped(again)}
        told = (words for words, found in ways.items() if _sensible(self.domain, found, columns) > 0.9)
        return next(((f"{words} where little-endian ones are due", "byte order") for words in told), None)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at points x: the program's, or the law that stands in for it."""
        return self._at("pdf", x, 1)[:, 0] if self.law is None else self.law(x)

    def _eval(self, x: np.ndarray) -> np.ndarray:
        channels = max(len(self.program.greeting.places("weight")), 1)
        answer = self._at("eval", x, channels)
        return answer[:, 0] if channels == 1 else answer

    def _at(self, request: str, x: np.ndarray, columns: int) -> np.ndarray:
        rows = x.reshape(len(x), int(np.prod(self.domain.shape, dtype=int)))
        return self.program.ask(request, rows, len(x), columns, 0, self.parameters)


def misread(
    domain: Domain, rows: np.ndarray, columns: tuple[str, ...], density: Density | None
) -> tuple[str, str] | None:
    """Return what is plainly wrong with how the numbers are written, in words and as a class; None if nothing is.

    Only where hardly any point lies in the domain as it is read, and nearly all do as it is read otherwise; or where the known
    density of the numbers in one column is what the other one holds.
    """
    good = partial(_sensible, domain, columns=columns)
    pairs = [i for name in ("x", "pdf") for i, each in enumerate(columns) if each == name]
    if density is not None and len(pairs) == 2 and not domain.shape and _exchanged(domain, rows[:, pairs], density):
        words = "has densities where points are due, and points where densities are due: its columns are swapped"
        return words, "layout"
    if good(rows) > 0.1:
        return None
    if good(swapped(rows)) > 0.9:
        return "writes big-endian numbers where little-endian ones are due", "byte order"
    if rows.dtype == np.float64 and good(_in_type(rows, np.float32)) > 0.9:
        return "writes float32 numbers where float64 ones are due", "number type"
    if rows.dtype == np.float32 and good(_in_type(rows, np.float64)) > 0.9:
        return "writes float64 numbers where float32 ones are due", "number type"
    if good(rows.reshape(rows.shape[1], rows.shape[0]).T) > 0.9:
        return "writes one coordinate after the other where one sample after the other is due", "layout"
    return None


def _exchanged(domain: Domain, pairs: np.ndarray, density: Density) -> bool:
    """Return whether rows (n, 2) hold densities and their points, and not points and their densities."""
    x, pdf = pairs[:_SHOWN].astype(np.float64).T
    if not (np.isfinite(x).all() and np.isfinite(pdf).all() and domain.contains(pdf, _SLACK).all()):
        return False

    def same(points: np.ndarray, densities: np.ndarray) -> bool:
        with np.errstate(all="ignore"):
            return float(np.median(np.abs(density(points) / densities - 1))) < _SAME

    return same(pdf, x) and not same(x, pdf)


def _sensible(domain: Domain, rows: np.ndarray, columns: tuple[str, ...]) -> float:
    """Return the share of rows whose points lie in the domain and are no strange numbers."""
    x = rows[:, [i for i, each in enumerate(columns) if each == "x"]]
    if not len(x):
        return 0.0
    valid = np.isfinite(x).all(axis=1)
    with np.errstate(all="ignore"):
        x = x.astype(np.float64)
        plain = np.abs(x).max(axis=1, initial=0) < 1e30  # what bytes in a wrong order seldom are
        tiny = (np.abs(x) < 1e-30) & (x != 0)
        inside = domain.contains(x if domain.shape else x[:, 0], _SLACK)
    return float(np.mean(valid & plain & inside & ~tiny.any(axis=1)))


def _in_type(rows: np.ndarray, kind: type[np.floating]) -> np.ndarray:
    """Return what the bytes of whole rows are as numbers of another type, as rows of as many columns."""
    size, columns = np.dtype(kind).itemsize, rows.shape[1]
    data = rows.tobytes()
    return np.frombuffer(data[: len(data) // (size * columns) * size * columns], kind).reshape(-1, columns)
