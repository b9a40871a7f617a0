"""Do reported standard errors keep their promise? The share of intervals of two standard errors that hold the reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.checks.statistics.tails import binomial_at_most, binomial_interval
from fogproof.checks.verdict import Finding, Interval, Outcome

NOMINAL = 0.9545
"""P(|Z| < 2) for a normal Z."""

LEAST = 0.90
"""Coverage below this is rejected: values need not be quite normal, but a user who sees two standard errors must be safe."""

_MISS = 0.01


@dataclass(frozen=True)
class Coverage:
    """How many of n intervals x +- 2 stderr held the reference, itself known to within its error."""

    n: int = 0
    held: int = 0

    def after(self, x: np.ndarray, stderr: np.ndarray, reference: np.ndarray, error: np.ndarray) -> Coverage:
        """Return the count after values and standard errors (n, channels); a realisation counts if every channel is held."""
        held = np.all(np.abs(x - reference) <= 2 * stderr + error, axis=1)
        return Coverage(self.n + len(held), self.held + int(np.count_nonzero(held)))


def coverage_test(name: str, data: Coverage, channels: int, alpha: float) -> Finding:
    """Test that the coverage is not below `LEAST` (for several channels, that of all together): an exact binomial bound."""
    least = 1 - channels * (1 - LEAST)
    p = binomial_at_most(data.held, data.n, max(least, 0.0))
    share = data.held / max(data.n, 1)
    low, high = binomial_interval(data.held, max(data.n, 1), _MISS)
    outcome: Outcome = "rejected" if p <= alpha else "not rejected"
    message = f"{share:.2%} of the intervals of two standard errors hold the reference, {NOMINAL:.2%} would be right"
    cause = "wrong standard errors" if outcome == "rejected" else ""
    interval = Interval(low - NOMINAL, high - NOMINAL, 1 - _MISS)
    return Finding(name, outcome, message, p, alpha, False, share, share - NOMINAL, interval=interval, cause=cause)
