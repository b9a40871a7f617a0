"""What goes wrong with one part of several, a distance and a direction say: whatever goes wrong with such a part alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import permutations

import numpy as np

from fogproof.checks.diagnosis import lines, regions
from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting
from fogproof.domains import Discrete, Domain, HalfLine, Product, RealLine

_SHORT = 4  # entries of a table that may be exchanged
_WHOLE = {"uniform law", "another law"}  # of a whole point: they say nothing of how one part depends on another


def hypotheses(
    setting: Setting, product: Product, of_part: Callable[[Setting], Iterator[Hypothesis]]
) -> Iterator[Hypothesis]:
    """Yield what may have happened to all coordinates, if each part is a number, and what may have happened to one part."""
    if all(part.shape == () for part in product.parts):
        yield from regions.hypotheses(setting)
        if all(isinstance(part, (RealLine, HalfLine)) for part in product.parts):
            yield lines.of_another_exponent(" in all columns")
    yield from _together(setting, product)
    first = 0
    for part in product.parts:
        last = first + math.prod(part.shape)
        columns = slice(first, last) if part.shape else first
        name = f" in the columns {first} to {last - 1}" if last - first > 1 else f" in the column {first}"
        for hypothesis in of_part(_part(setting, part, columns)):
            if hypothesis.cause not in _WHOLE:
                yield _lifted(hypothesis, part, columns, name)
        first = last


def _together(setting: Setting, product: Product) -> Iterator[Hypothesis]:
    """Yield that entries of a short table are exchanged, each with its own probability: one's other parts are drawn for another."""
    first = 0
    for part in product.parts:
        size = part.measure
        if isinstance(part, Discrete) and 1 < size <= _SHORT:
            for order in permutations(range(int(size))):
                if order != tuple(range(int(size))):
                    names = ", ".join(map(str, order))
                    words = f"what belongs to the entries {names} of column {first} is drawn for 0 to {len(order) - 1}"
                    yield Hypothesis("swapped entries", words, partial(_exchanged, np.array(order), first))
        first += math.prod(part.shape)


def _exchanged(order: np.ndarray, column: int, setting: Setting, _: float) -> Density:
    """Return the density with the entries of one column exchanged, where each keeps its probability, told by the known points."""
    contrast = setting.contrast
    n = len(contrast.x)
    weight = np.maximum(setting.values[n:], 0.0) / contrast.q[n:]
    share = np.bincount(_entries(contrast.z, column, order), weight, len(order))

    def density(x: np.ndarray) -> np.ndarray:
        at, y = _entries(x, column, order), x.copy()
        y[:, column] = order[at]
        return setting.p(y) * share[at] / np.maximum(share[order[at]], 1e-300)

    return density


def _entries(x: np.ndarray, column: int, order: np.ndarray) -> np.ndarray:
    return np.clip(np.rint(x[:, column]), 0, len(order) - 1).astype(np.intp)


def _lifted(hypothesis: Hypothesis, part: Domain, columns: slice | int, name: str) -> Hypothesis:
    """Return the hypothesis about one part as one about the whole points."""

    def density(s: Setting, value: float) -> Density:
        alone = _part(s, part, columns)
        return lambda x: hypothesis.density(alone, value)(alone.contrast.points if x is s.contrast.points else x)

    def of_one(s: Setting, value: float) -> Density:
        """Return the density of which the other parts are not raised to a power, if they are independent."""
        raised, usual = density(s, value), s.claimed_points(3)[1, columns]

        def lowered(x: np.ndarray) -> np.ndarray:
            other = x.copy()
            other[:, columns] = usual
            return raised(x) * np.maximum(s.p(other), 1e-300) ** (1 - value)

        return lowered

    return replace(hypothesis, words=hypothesis.words + name, density=of_one if hypothesis.power else density)


def _part(setting: Setting, part: Domain, columns: slice | int) -> Setting:
    """Return what one part is, the others staying as they are: its density is the claim with that part replaced.

    It may be asked at all points, or at any number of others, where the other parts are those of the first point.
    """
    whole = setting.contrast
    law = part.law(whole.x[:, columns])

    def claim(y: np.ndarray) -> np.ndarray:
        moved = whole.points.copy() if len(y) == len(whole.points) else np.repeat(whole.points[:1], len(y), axis=0)
        moved[:, columns] = y
        return setting.p(moved)

    contrast = replace(whole, law=law, x=whole.x[:, columns], z=whole.z[:, columns])
    return Setting(part, law, claim, contrast, setting.values)
