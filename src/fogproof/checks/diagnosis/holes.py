"""Places that a sampler never reaches, and samples that come from somewhere else: what any domain can suffer from."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_LACK = 0.5  # of the expected samples: a place with fewer belongs to a hole
_GAIN = 20.0  # samples that a hole must lack beyond that
_SOME = 0.4  # share of samples that may follow another law: most do not
_HALF_TURN = 2e-3
_EMPTY = 0.2  # the same for a cell of the tree
_TELLING = 8.0  # samples expected in such a cell


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield a hole along each axis, the cells that are empty, and a share of uniform samples."""
    law = setting.law
    if not law.stepped:
        for axis in range(len(law.axes)):
            found = _hole(setting, axis)
            if found is not None:
                yield _outside(setting, axis, *found)
    yield from _empty_cells(setting)
    yield Hypothesis(
        "mixture",
        "a share of {value} of these samples follows another, broader law",
        lambda s, e: lambda x: (1 - min(e, _SOME)) * s.p(x) + min(e, _SOME) * s.law.density(x),
        (0.003, 0.01, 0.03, 0.1, 0.3),
        null=0.0,
    )


def _coordinate(setting: Setting, x: np.ndarray, axis: int) -> np.ndarray:
    return setting.law.coordinates(x, np.full((len(x), len(setting.law.axes)), 0.5))[:, axis]


def _hole(setting: Setting, axis: int) -> tuple[float, float] | None:
    """Return the ends, in [0, 1], of the stretch along an axis that lacks most samples; None if none lacks half of them.

    A stretch from one sample to another gains half the samples that the claim puts there and loses those that are there: the
    greatest gain is a maximum of differences of one sequence.
    """
    contrast = setting.contrast
    samples = np.concatenate([[0.0], np.sort(_coordinate(setting, contrast.x, axis)), [1.0]])
    known = _coordinate(setting, contrast.z, axis)
    n = len(contrast.x)
    weight = setting.values[n:] / contrast.q[n:]
    order = np.argsort(known)
    share = np.cumsum(weight[order])
    if not share[-1] > 0:
        return None
    places = np.concatenate([[0.0], known[order], [1.0]])
    claim = np.interp(samples, places, np.concatenate([[0.0], share / share[-1], [1.0]]))
    sequence = _LACK * len(contrast.x) * claim - np.arange(len(samples))
    least = np.minimum.accumulate(sequence)
    last = int(np.argmax(sequence - least))
    if sequence[last] - least[last] < _GAIN:
        return None
    return float(samples[int(np.argmin(sequence[: last + 1]))]), float(samples[last])


def _outside(setting: Setting, axis: int, low: float, high: float) -> Hypothesis:
    name = setting.law.axes[axis]
    if len(setting.law.axes) == 1 and not setting.law.stepped:
        ends = setting.law.place(np.array([[low], [min(high, 1 - 2.0**-53)]]))
        where = f"{ends.min():.5g} < x < {ends.max():.5g}"
    else:
        where = f"the share {low:.4g} to {high:.4g} of the axis {name}"
    turn = name.split()[0] == "phi"  # it has no end
    if turn and abs(high - low - 0.5) < _HALF_TURN:
        where += ", half the turn: as of an azimuth over pi where 2 pi is meant"
    end = not turn and (low <= 1e-9 or high >= 1 - 1e-9 or not _any_beyond(setting, axis, low, high))

    def density(x: np.ndarray) -> np.ndarray:
        u = _coordinate(setting, x, axis)
        return np.where((u > low) & (u < high), 0.0, setting.p(x))

    cause = "missing tail" if end else "skipped band"
    return Hypothesis(cause, f"no sample lies in {where}; the others fit the pdf", lambda s, _: density)


def _any_beyond(setting: Setting, axis: int, low: float, high: float) -> bool:
    """Return whether there are samples on both sides of a hole."""
    u = _coordinate(setting, setting.contrast.x, axis)
    return bool(np.any(u <= low) and np.any(u >= high))


def _empty_cells(setting: Setting) -> Iterator[Hypothesis]:
    """Yield the cells of the known law that expect samples and have none, all together."""
    contrast = setting.contrast
    n, cells = len(contrast.x), int(contrast.cell.max()) + 1
    seen = np.bincount(contrast.cell[:n], minlength=cells)
    weight = setting.values[n:] / contrast.q[n:]
    expected = np.bincount(contrast.cell[n:], weight, cells) * n / max(float(weight.sum()), 1e-300)
    empty = (seen < _EMPTY * expected) & (expected > _TELLING)
    if not empty.any() or empty.all():
        return
    leaves = len(contrast.tree.share)

    def density(x: np.ndarray) -> np.ndarray:
        u = setting.law.coordinates(x, np.full((len(x), len(setting.law.axes)), 0.5))
        return np.where(empty[contrast.tree.leaf(u) * cells // leaves], 0.0, setting.p(x))

    share = float(expected[empty].sum() / max(expected.sum(), 1e-300))
    words = f"a region of probability {share:.3g} is never reached; the other samples fit the pdf"
    made: Density = density
    yield Hypothesis("skipped region", words, lambda s, _: made)
