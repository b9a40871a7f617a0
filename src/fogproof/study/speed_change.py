"""How much longer an estimate takes than it did: two runs on machines that are faster on one day than on another.

Where both runs timed the same fixed work, times over its times are compared, of one estimator as of many. Of `LEAST` estimators or
more, the common change of all their times is taken out as well, and how much the times of the others wander says how much a single
one must change to be noticed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from fogproof.study.convergence import CONFIDENCE, Z
from fogproof.study.fixed_work import COLUMNS

LEAST = 4
"""Estimators that are needed to tell a change of the machine from a change of one without fixed work."""
ASIDE = math.log(1.05)
"""How far times over those of fixed work differ between processes of the same code that run at once: each meets its memory in
another layout. Of 19 processes the furthest two were 6 % apart, the others 3 % at most."""
SHARE = 0.5
"""How much of the machine's own change fixed work may fail to follow: what slows it down slows not all code alike. Of 1651 pairs
among 155 runs of equal code, drawn while the machine was busy with other things, none was said to differ at alpha = 1e-6 and one in
800 at 0.003; with 10 % aside and no share of the machine's change 7 were at 1e-6. `tools/study_speeds.py` draws such pairs."""
SEEN = 0.999
"""Probability with which a change of the stated resolution is said."""
_MAD = 1.4826
"""From the median absolute deviation to the standard deviation of a normal law."""
Against = Literal["fixed-work", "each-other", "nothing"]
_Pairs = Sequence[tuple[dict[str, Any], dict[str, Any]]]


@dataclass(frozen=True)
class SpeedChange:
    """Logarithm of after / before, of one estimator.

    aside    how far it may be off by what no scatter shows: another process, and how differently the machine ran
    scatter  its standard error, with so many degrees of `freedom`
    """

    off: float
    aside: float
    scatter: float
    freedom: float

    def reach(self, alpha: float) -> float:
        """Return how far it may be off, but for a probability alpha."""
        from scipy.special import stdtrit

        return self.aside + (float(stdtrit(self.freedom, 1 - alpha / 2)) * self.scatter if self.scatter else 0.0)

    def became(self, alpha: float) -> list[str]:
        """Say which way it changed, if it did."""
        return [] if abs(self.off) <= self.reach(alpha) else ["slower" if self.off > 0 else "faster"]

    def resolution(self, alpha: float) -> float:
        """Return the factor of a change that would have been said with probability `SEEN`."""
        return bounded_exp(self.reach(alpha) + self.reach(2 * (1 - SEEN)))

    def estimate(self) -> dict[str, float]:
        """Return the factor with its interval."""
        reach = self.reach(1 - CONFIDENCE)
        return {key: bounded_exp(self.off + d) for key, d in (("value", 0.0), ("low", -reach), ("high", reach))}


@dataclass(frozen=True)
class Speeds:
    """The changes of all estimators, told in several ways, or in none where there is no time in both runs.

    machine  the factor that was taken out of all times, and `wander`, the scatter of what is left
    against  what they were told against: "fixed-work", "each-other" or "nothing"
    """

    changes: list[tuple[SpeedChange, ...]]
    machine: float
    wander: float
    against: Against


def speed_changes(pairs: _Pairs, same_machine: bool) -> Speeds:
    """Return how the speeds of (before, after) estimators of two records changed, each at the largest count that both have.

    same_machine  whether both ran in the same environment: another is faster to one code than to another, whatever fixed work says
    """
    timings = [_at_common_count(old, young) for old, young in pairs]
    plain = [None if two is None else _plain(*two) for two in timings]
    fixed = [None if two is None or not same_machine else _over_fixed_work(*two) for two in timings]
    offs = np.array([p.off for p in plain if p])
    middle = float(np.median(offs)) if len(offs) >= LEAST else 0.0
    wander = _MAD * float(np.median(np.abs(offs - middle))) if len(offs) >= LEAST else math.log(2)
    others = [p and SpeedChange(p.off - middle, 0.0, math.hypot(p.scatter, wander), math.inf) for p in plain]
    if not any(fixed):
        against: Against = "each-other" if len(offs) >= LEAST else "nothing"
        return Speeds([(o,) if o else () for o in others], bounded_exp(middle), wander, against)
    ways = [
        tuple(way for way in (f, o if len(offs) >= LEAST else None) if way) for f, o in zip(fixed, others, strict=True)
    ]
    machine = np.median([p.off - f.off for f, p in zip(fixed, plain, strict=True) if f and p])
    return Speeds(ways, bounded_exp(float(machine)), float(np.median([f.aside for f in fixed if f])), "fixed-work")


def became(ways: Sequence[SpeedChange], alpha: float) -> list[str]:
    """Say which way an estimator's time changed, if one of the ways that it is told in says so; they share alpha."""
    return next((said for way in ways if (said := way.became(alpha / len(ways)))), [])


def estimate(ways: Sequence[SpeedChange], alpha: float) -> dict[str, float]:
    """Return the factor with its interval, by the way that is surest, and the resolution."""
    surest = min(ways, key=lambda way: way.reach(alpha))
    return {**surest.estimate(), "resolution": surest.resolution(alpha / len(ways))}


def _at_common_count(old: dict[str, Any], young: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]] | None:
    """Return the timings at the largest count that both have: a fixed cost is less of a larger one."""
    before, after = ({t["count"]: t for t in e["speed"]["counts"]} if e["speed"] else {} for e in (old, young))
    count = max(before.keys() & after.keys(), default=None)
    return None if count is None else (before[count], after[count])


def _plain(old: dict[str, Any], young: dict[str, Any]) -> SpeedChange | None:
    a, b = old["seconds"], young["seconds"]
    if not (a > 0 and b > 0):
        return None
    return SpeedChange(math.log(b / a), 0.0, math.hypot(_spread(old), _spread(young)), math.inf)


def _spread(time: dict[str, float]) -> float:
    return math.log(time["high"] / time["low"]) / (2 * Z) if 0 < time["low"] < time["high"] else 0.0


def _over_fixed_work(old: dict[str, Any], young: dict[str, Any]) -> SpeedChange | None:
    """Return the change of a time over that of fixed work, and what its sorts disagree by; None where there is none."""
    before, after = old.get("fixed_work"), young.get("fixed_work")
    if not before or not after or before["version"] != after["version"]:
        return None
    *sorts, off = (math.log(after[name] / before[name]) for name in COLUMNS)
    a, b = (work["stderr"] ** 2 for work in (before, after))
    within = a**2 / before["freedom"] + b**2 / after["freedom"]
    freedom = (a + b) ** 2 / within if within else math.inf  # Welch 1947
    disagreement = max(abs(sort - off) for sort in sorts)
    return SpeedChange(off, ASIDE + disagreement + SHARE * abs(_machine(old, young, off)), math.sqrt(a + b), freedom)


def _machine(old: dict[str, Any], young: dict[str, Any], off: float) -> float:
    """Return by how much the fixed work itself took longer, as a logarithm; 0 where a clock saw no time pass."""
    plain = _plain(old, young)
    return plain.off - off if plain else 0.0


def bounded_exp(x: float) -> float:
    """Return e^x, as a number that is finite."""
    return math.exp(min(max(x, -700.0), 700.0))
