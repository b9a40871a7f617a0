"""Places that a sampler never reaches, and samples that come from somewhere else: what any domain can suffer from."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting

_LACK = 0.5  # of the expected samples: a place with fewer belongs to a hole
_GAIN = 20.0  # samples that a hole must lack beyond that
_SOME = 0.4  # share of samples that may follow another law: most do not
_NEARLY_ALL = 0.9  # of a hole
_BESIDE = 30  # samples
_END = 1e-9  # of an axis
_PLACED, _CONSTANT = 16, 1e-6  # points, and what differs among them by no more of a stretch is told by it
_ENDLESS = 1e300  # beyond all numbers, as a known law has it
_QUARTERS = {
    1: ", a quarter of the turn: as of an azimuth that misses a quadrant",
    2: ", half the turn",
    3: ", three quarters of the turn",
}
_EMPTIED = {  # quarters of the turn, and the one where it begins, from -x
    (2, 0): ", half the turn: as of an azimuth over pi where 2 pi is meant",
    (2, 3): ", half the turn: as of an arctangent that keeps no quadrant, where atan2 is meant",
    (3, 3): ", three quarters of the turn: as of an azimuth that stays in its first quadrant",
}
_EMPTY = 0.2  # the same for a cell of the tree
_TELLING = 8.0  # samples expected in such a cell


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield a hole along each axis, the cells that are empty, and a share of uniform samples."""
    law = setting.law
    if not law.stepped:
        for axis in range(len(law.axes)):
            yield from along(setting, axis)
    yield from _empty_cells(setting)
    yield Hypothesis(
        "mixture",
        "a share of {value} of these samples follows another, broader law",
        lambda s, e: lambda x: (1 - min(e, _SOME)) * s.p(x) + min(e, _SOME) * s.law.density(x),
        (0.003, 0.01, 0.03, 0.1, 0.3),
        null=0.0,
    )


def along(setting: Setting, axis: int) -> Iterator[Hypothesis]:
    """Yield the hole along one axis, if there is one."""
    name, known = setting.law.axes[axis], _known_shares(setting, axis)
    if known is None:
        return
    turn = name.split()[0] == "phi"  # it has no end
    found = _hole(setting, axis, *known, turn)
    if found is None:
        return
    low, high = found
    exact = False
    if len(setting.law.axes) == 1:
        where = along_a_line(setting, low, high)
    elif turn:
        low, high, guess = _quadrants(low, high, _coordinate(setting, setting.contrast.x, axis))
        exact = bool(guess)
        first, last = _degrees(low), _degrees(high)
        where = f"the azimuths from {first:.4g} to {last:.4g} degrees{name.removeprefix('phi')}{guess}"
    else:
        where = _between(setting, axis, low, high)
    end = not turn and (low <= _END or high >= 1 - _END or not _any_beyond(setting, axis, low, high))

    def density(x: np.ndarray) -> np.ndarray:
        u = _coordinate(setting, x, axis)
        inside = (u - low) % 1.0 < high - low if turn else (u > low) & (u < high)
        return np.where(inside, 0.0, setting.p(x))

    cause = "missing tail" if end else "skipped band"
    words = f"no sample lies in {where}; the others fit the pdf"
    yield Hypothesis(cause, words, lambda s, _: density, fitted=not exact)  # as far as a sample that bounds it


def _between(setting: Setting, axis: int, low: float, high: float) -> str:
    """Return in words where a stretch of an axis is: in what of the points changes along it and along no other one."""
    law, ends = setting.law, (max(low, _END), min(high, 1 - _END))
    u = np.random.default_rng(0).random((2, _PLACED, len(law.axes)))
    u[:, :, axis] = np.array(ends)[:, None]
    x = np.stack([law.place(each) for each in u]).reshape(2, _PLACED, -1)
    readings = {f"x[{column}]": x[:, :, column] for column in range(x.shape[2])} | {"|x|": np.linalg.norm(x, axis=2)}
    for name, value in readings.items():
        (first, spread), (last, other) = ((float(v.mean()), float(np.ptp(v))) for v in value)
        if max(spread, other) < _CONSTANT * abs(last - first):
            if low <= _END or high >= 1 - _END:
                below = (low <= _END) == (last > first)
                return f"{name} {'<' if below else '>'} {last if low <= _END else first:.4g}"
            return f"{min(first, last):.4g} < {name} < {max(first, last):.4g}"
    return f"the share {low:.4g} to {high:.4g} of the axis {law.axes[axis]} of the domain's known law"


def _coordinate(setting: Setting, x: np.ndarray, axis: int) -> np.ndarray:
    return setting.law.coordinates(x, np.full((len(x), len(setting.law.axes)), 0.5))[:, axis]


def _known_shares(setting: Setting, axis: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Return places along an axis, from 0 to 1, and which share of the claim lies before each; None if it has nothing there."""
    n = len(setting.contrast.x)
    known = _coordinate(setting, setting.contrast.z, axis)
    order = np.argsort(known)
    share = np.cumsum((setting.values[n:] / setting.contrast.q[n:])[order])
    if not share[-1] > 0:
        return None
    return np.concatenate([[0.0], known[order], [1.0]]), np.concatenate([[0.0], share / share[-1], [1.0]])


def _hole(setting: Setting, axis: int, places: np.ndarray, share: np.ndarray, turn: bool) -> tuple[float, float] | None:
    """Return the ends of the stretch along an axis that lacks most samples, of [0, 1]; None if none lacks half of them.

    A stretch from one sample to another gains half the samples that the claim puts there and loses those that are there: the
    greatest gain is a maximum of differences of one sequence. A turn is gone twice, and its stretch may end beyond 1.
    """
    samples = np.sort(_coordinate(setting, setting.contrast.x, axis))
    n = len(samples)
    claim = np.interp(samples, places, share)
    if turn:
        samples, claim = np.concatenate([samples, 1 + samples]), np.concatenate([claim, 1 + claim])
    else:
        samples, claim = np.concatenate([[0.0], samples, [1.0]]), np.concatenate([[0.0], claim, [1.0]])
    sequence = _LACK * n * claim - np.arange(len(samples))
    least = np.minimum.accumulate(sequence)
    last = int(np.argmax(sequence - least))
    if sequence[last] - least[last] < _GAIN:
        return None
    first = int(np.argmin(sequence[: last + 1]))
    widest = first + int(np.argmax(np.diff(samples[first : last + 1])))
    if samples[widest + 1] - samples[widest] > _NEARLY_ALL * (samples[last] - samples[first]):
        first, last = widest, widest + 1  # few points tell what the claim puts at an edge, and samples where it is
    return float(samples[first]), float(samples[last])


def along_a_line(setting: Setting, low: float, high: float) -> str:
    """Return in words where a stretch of numbers is; what has no end is told none."""
    first, last = setting.law.place(np.array([[low], [min(high, 1 - 2.0**-53)]])).tolist()
    if high >= 1 - _END and not np.isfinite(setting.domain.measure):
        return f"x > {first:.5g}"
    return f"x < {last:.5g}" if abs(first) > _ENDLESS else f"{first:.5g} < x < {last:.5g}"


def _quadrants(low: float, high: float, u: np.ndarray) -> tuple[float, float, str]:
    """Return the ends of a hole in a turn, at axes if it is one of whole quadrants, and in words what empties such a one.

    u  (n,) of the samples, which bound it: an axis is its end where few samples lie as close to the hole on the other side
    """
    first, last = round(4 * low), round(4 * high)
    quarters, turns = last - first, first // 4
    beside = np.count_nonzero((low - u) % 1.0 <= abs(low - first / 4))
    beyond = np.count_nonzero((u - high) % 1.0 <= abs(high - last / 4))
    if quarters not in _QUARTERS or max(beside, beyond) > _BESIDE:
        return low, high, ""
    return first / 4 - turns, last / 4 - turns, _EMPTIED.get((quarters, first % 4), _QUARTERS[quarters])


def _degrees(share: float) -> float:
    """Return the azimuth of a share of the turn, which begins at -x."""
    return 360 * share - 180


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
    z = contrast.z.reshape(len(contrast.z), -1)
    where = _within(z[empty[contrast.cell[n:]] & (weight > 0)], contrast.points.reshape(-1, z.shape[1]))
    words = f"a region of probability {share:.3g}{where} is never reached; the other samples fit the pdf"
    made: Density = density
    yield Hypothesis("skipped region", words, lambda s, _: made)


def _within(places: np.ndarray, points: np.ndarray) -> str:
    """Return in words the box around places (m, k), in the columns in which it is narrower than all points."""
    ends = np.stack([places.min(axis=0), places.max(axis=0)], axis=1)
    narrow = np.flatnonzero(np.ptp(ends, axis=1) < _NEARLY_ALL * np.ptp(points, axis=0))
    names = [f"x[{k}]" if len(ends) > 1 else "x" for k in range(len(ends))]
    box = " and ".join(f"{ends[k, 0]:.4g} < {names[k]} < {ends[k, 1]:.4g}" for k in narrow.tolist())
    return f", where {box}," if box else ""
