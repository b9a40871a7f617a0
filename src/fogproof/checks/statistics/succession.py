"""How realisations follow each other: what is remembered of them, batch by batch, in a size that does not grow with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from fogproof.checks.statistics.evenness import CALLS, GROUPS
from fogproof.checks.statistics.moments import mean_of

LAGS = (1, 2, 3, 4, 8, 16, 32, 64)
WAYS = (*(f"{lag} apart" for lag in LAGS), "half a call apart", "mirrored in their call")
WINDOW = 64  # realisations of a stretch
_SOME = np.uint64(63)  # a stretch begins where so many bits of a fingerprint are zero, wherever that is
_MOST_WINDOWS = 1 << 14  # remembered
_WEIGHTS = np.cumprod(
    np.full(WINDOW, 0x9E3779B97F4A7C15, dtype=np.uint64)
)  # odd powers: order matters, and every one counts
_ENOUGH = 50 * GROUPS  # realisations of a call whose values are counted cell by cell
_REMEMBERED = 1 << 17  # realisations whose fingerprints are kept


@dataclass(frozen=True)
class Succession:
    """How values x (n, channels) follow each other.

    threshold  (channels,) between small and large values
    n          how many realisations
    large      (channels,) how many are large
    pairs      (ways,) how many pairs were looked at, and `both` (ways, channels) how many were of two large values
    alike      how many realisations equalled the next one
    windows    fingerprints of stretches of 64 realisations
    prints     fingerprints of realisations, and `calls` the calls that they came from
    means      size and (channels,) mean of every call
    edges      (channels, cells - 1) between cells of about equal probability
    counts     (calls, channels, cells) of the first calls that are large enough
    """

    threshold: np.ndarray
    n: int = 0
    large: np.ndarray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    pairs: np.ndarray = field(default_factory=lambda: np.zeros(len(WAYS), dtype=np.int64))
    both: np.ndarray = field(default_factory=lambda: np.zeros((len(WAYS), 1), dtype=np.int64))
    alike: int = 0
    windows: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.uint64))
    prints: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.uint64))
    calls: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    means: tuple[tuple[int, np.ndarray], ...] = ()
    edges: np.ndarray = field(default_factory=lambda: np.empty((1, 0)))
    counts: tuple[np.ndarray, ...] = ()

    @staticmethod
    def about(first: np.ndarray) -> Succession:
        """Return the empty record for an estimator whose first batch is (n, channels)."""
        if len(first) == 0:
            return Succession(np.zeros(first.shape[1]))
        # The middle of few values is one of them: what is larger must not be what is never drawn.
        middle = np.quantile(first, 0.5, axis=0, method="lower")
        edges = np.quantile(first, np.arange(1, GROUPS) / GROUPS, axis=0, method="lower").T
        return Succession(
            np.where(middle == first.max(axis=0), np.nextafter(middle, -np.inf), middle),
            edges=np.ascontiguousarray(edges),
        )

    def after(self, x: np.ndarray, sizes: Sequence[int]) -> Succession:
        """Return the record after one more batch (n, channels), drawn in calls of these sizes."""
        large, prints = np.ascontiguousarray((x > self.threshold).T), fingerprints(x)
        pairs, both = self.pairs.copy(), self.both + np.zeros((1, x.shape[1]), dtype=np.int64)
        means, windows = [], []
        counts: list[np.ndarray] = []
        alike, start = self.alike, 0
        for size in sizes:
            here = slice(start, start + size)
            start += size
            for way, (left, right) in enumerate(_paired(large[:, here])):
                pairs[way] += left.shape[1]
                both[way] += [np.count_nonzero(a & b) for a, b in zip(left, right, strict=True)]
            alike += int(np.count_nonzero(prints[here][1:] == prints[here][:-1]))
            means.append((size, mean_of(x[here])))
            if size >= _ENOUGH and len(self.counts) + len(counts) < CALLS:
                counts.append(_counted(x[here], self.edges))
            if len(self.windows) < _MOST_WINDOWS:
                windows.append(_stretches(prints[here]))
        room = max(_REMEMBERED - len(self.prints), 0)
        calls = np.repeat(np.arange(len(sizes)) + len(self.means), sizes)
        return replace(
            self,
            n=self.n + len(x),
            large=self.large + np.array([np.count_nonzero(one) for one in large]),
            pairs=pairs,
            both=both,
            alike=alike,
            windows=np.concatenate([self.windows, *windows])[:_MOST_WINDOWS],
            prints=np.concatenate([self.prints, prints[:room]]),
            calls=np.concatenate([self.calls, calls[:room]]),
            means=(*self.means, *means),
            counts=(*self.counts, *counts),
        )


def _counted(x: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return (channels, cells) how many values (n, channels) lie in each cell."""
    cells = [np.searchsorted(edge, column) for edge, column in zip(edges, x.T, strict=True)]
    return np.stack([np.bincount(cell, minlength=edges.shape[1] + 1) for cell in cells])


def _paired(large: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return all pairs of realisations that are looked at, of (channels, n)."""
    n, half = large.shape[1], large.shape[1] // 2
    pairs = [(large[:, : max(n - lag, 0)], large[:, lag:]) for lag in LAGS]
    return [*pairs, (large[:, :half], large[:, half : 2 * half]), (large[:, :half], large[:, ::-1][:, :half])]


def fingerprints(rows: np.ndarray) -> np.ndarray:
    """Return (n,) uint64 of rows (n, channels): equal rows have equal ones."""
    bits = np.ascontiguousarray(rows + 0.0).view(np.uint64)
    with np.errstate(over="ignore"):
        total = np.zeros(len(rows), dtype=np.uint64)
        for column in bits.T:
            total = _mixed(total * np.uint64(0xD6E8FEB86659FD93) + column)
        return total


def _mixed(x: np.ndarray) -> np.ndarray:
    x = (x ^ (x >> np.uint64(32))) * np.uint64(0x9E3779B97F4A7C15)
    x = (x ^ (x >> np.uint64(29))) * np.uint64(0xC2B2AE3D27D4EB4F)
    return x ^ (x >> np.uint64(32))


def _stretches(prints: np.ndarray) -> np.ndarray:
    """Return fingerprints of stretches that begin where the values themselves say so: a copy may begin anywhere."""
    if len(prints) < WINDOW:
        return prints[:0]
    with np.errstate(over="ignore"):
        several = _mixed(
            prints[:-3] + np.uint64(3) * prints[1:-2] + np.uint64(5) * prints[2:-1] + np.uint64(7) * prints[3:]
        )
        starts = np.flatnonzero((several[: len(prints) - WINDOW + 1] & _SOME) == 0)[: _MOST_WINDOWS // 4]
        return _mixed(sliding_window_view(prints, WINDOW)[starts] @ _WEIGHTS)
