"""Are realisations independent? Runs of large values, and whole stretches that occur twice.

Both hold whatever the law of the values: standard errors of correlated realisations are wrong even where the mean is right.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from fogproof.checks.statistics.tails import normal_two_sided
from fogproof.checks.verdict import Finding, Outcome

_WINDOW = 64  # realisations of a stretch
_MOST_WINDOWS = 1 << 14  # remembered
_CHANCE = 1e-12  # a repetition less likely than this is none


@dataclass(frozen=True)
class Succession:
    """How values x (n,) follow each other.

    threshold  between small and large values
    large      how many are large
    pairs      how many successions were looked at, and `both` how many were of two large values
    alike      how many values equalled the next one
    windows    fingerprints of stretches of 64 values
    """

    threshold: float
    n: int = 0
    large: int = 0
    pairs: int = 0
    both: int = 0
    alike: int = 0
    windows: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.uint64))

    def after(self, x: np.ndarray) -> Succession:
        """Return the record after one more batch; its first value is not taken for the successor of the last one."""
        large = x > self.threshold
        windows = self.windows
        whole = len(x) // _WINDOW * _WINDOW
        if len(windows) < _MOST_WINDOWS and whole:
            windows = np.concatenate([windows, _fingerprints(x[:whole].reshape(-1, _WINDOW))])[:_MOST_WINDOWS]
        return Succession(
            self.threshold,
            self.n + len(x),
            self.large + int(np.count_nonzero(large)),
            self.pairs + max(len(x) - 1, 0),
            self.both + int(np.count_nonzero(large[1:] & large[:-1])),
            self.alike + int(np.count_nonzero(x[1:] == x[:-1])),
            windows,
        )


def _fingerprints(rows: np.ndarray) -> np.ndarray:
    bits = np.ascontiguousarray(rows + 0.0).view(np.uint64)
    with np.errstate(over="ignore"):
        total = np.zeros(len(rows), dtype=np.uint64)
        for column in bits.T:
            mixed = (column ^ (column >> np.uint64(32))) * np.uint64(0x9E3779B97F4A7C15)
            total = (total ^ (mixed >> np.uint64(29))) * np.uint64(0xC2B2AE3D27D4EB4F) + mixed
    return total


def runs_test(name: str, record: Succession, alpha: float) -> Finding:
    """Test that a large value is followed by a large one as often as by a small one (Wald & Wolfowitz 1940)."""
    share = record.large / max(record.n, 1)
    spread = share * (1 - share)
    if record.pairs * spread**2 < 25:
        return Finding(name, "not rejected", "too few large or small values to see a correlation", 1.0, alpha)
    correlation = (record.both / record.pairs - share**2) / spread
    z = correlation * math.sqrt(record.pairs)
    p = normal_two_sided(z)
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"correlation of successive realisations, large against small, is {correlation:+.3g}"
    cause = "correlation" if outcome == "rejected" else ""
    return Finding(name, outcome, message, p, alpha, False, z, correlation, cause=cause)


def repeated_stretches(name: str, record: Succession) -> Finding | None:
    """Return whether stretches of 64 realisations occur twice, where chance alone would not explain one; else None."""
    alike = (record.alike + 1) / (record.pairs + 1)
    windows = len(record.windows)
    chance = 0.5 * windows**2 * alike**_WINDOW
    if windows < 2 or chance > _CHANCE:
        return None
    repeats = windows - len(np.unique(record.windows))
    if repeats == 0:
        return Finding(name, "not rejected", f"no two of {windows} stretches of {_WINDOW} realisations are equal")
    message = f"{repeats} of {windows} stretches of {_WINDOW} realisations occurred before: a stream that starts again"
    return Finding(name, "rejected", message, effect=repeats / windows, cause="correlation")
