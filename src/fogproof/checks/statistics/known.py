"""What is declared of the law of one realisation: tests may rely on it whatever has been seen, and on nothing else."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Known:
    """Declared facts about one realisation.

    variance   an upper bound on its variance, or None
    low, high  no realisation lies outside
    light      its tails are no heavier than those of the exponential law: Student's test may be used with few realisations
    assumed    bounds are not declared: no negative value was seen, and one that mattered would have to be absurdly large
    told       where nobody declared it: what is relied on, in words
    """

    variance: float | None = None
    low: float = -math.inf
    high: float = math.inf
    light: bool = False
    assumed: bool = False
    told: str = ""

    @property
    def deviation(self) -> float | None:
        """Bound on the standard deviation, or None."""
        return None if self.variance is None else math.sqrt(self.variance)

    @property
    def bounded(self) -> bool:
        """Whether both ends are finite."""
        return math.isfinite(self.high - self.low)

    @property
    def two_sided(self) -> bool:
        """Whether means that are too small as well as too large can be shown, whatever the law."""
        return self.bounded or self.variance is not None

    def words(self) -> str:
        """Return what is relied on, for a message."""
        if self.told:
            return self.told
        facts = [] if self.variance is None else [f"the declared variance {self.variance:.3g}"]
        if self.assumed:
            facts.append("that no value is negative, as none so far was")
        elif math.isfinite(self.low) or math.isfinite(self.high):
            facts.append(f"the declared bounds ({self.low:g}, {self.high:g})")
        return " and ".join(facts)


NOTHING = Known()


@dataclass(frozen=True)
class Declarable:
    """The arguments of a check by which its caller may declare more about one mean, as they are written; "" where it has none.

    variance  of its exact variance, and `zero` where there may be none
    bounds    of its bounds
    tails     of the lightness of its tails
    more      what there may be more of
    other     what else would decide, in words
    """

    variance: str = ""
    zero: str = ""
    bounds: str = ""
    tails: str = ""
    more: str = "samples"
    other: str = ""

    def of_values(self) -> str:
        """Return in words what would decide about values that vary, "" if there is nothing."""
        ways = [way for way in (self.bounds, self.variance, self.tails) if way]
        return f", or declare {_either(ways)}" if ways else f", or {self.other}" if self.other else ""

    def of_a_constant(self) -> str:
        """Return in words what would decide where no value differs from another."""
        ways = [way for way in (self.zero, self.bounds) if way]
        if ways:
            return f". Declare {_either(ways)} of its values"
        return f": ask for more {self.more}" + (f", or {self.other}" if self.other else "")


def _either(ways: list[str]) -> str:
    return f"{', '.join(ways[:-1])}, or {ways[-1]}" if len(ways) > 1 else ways[0]


NOTHING_MORE = Declarable()
