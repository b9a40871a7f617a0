"""Who is soonest to each error, who may be as soon, and where the counts do not tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from fogproof.study.measures import Measured
from fogproof.study.reaching import TARGETS, Reach


@dataclass(frozen=True, eq=False)
class Soonest:
    """The one that comes to an error in the least time, by `reach`.

    beside   those whose time may be as little
    target   index of the error
    waiting  those that may be sooner: they had not come so near by their last count, and are nothing to be mended first; or values
             too rare to be met may make their time longer. Of the first itself, where that is so of all
    """

    first: Measured
    reach: Reach
    beside: tuple[Measured, ...]
    waiting: tuple[Measured, ...]
    target: int

    @property
    def unsure(self) -> tuple[Measured, ...]:
        """Those of the waiting that come to the error, unless values too rare to be met hold more of it."""
        return tuple(m for m in self.waiting if _unsure(m, self.target))

    def record(self) -> dict[str, Any]:
        """Return it JSON-ready, estimators by their names."""
        return {
            "name": self.first.cell.name,
            "how": self.reach.how,
            "seconds": self.reach.times.estimate.value,
            "unless": self.reach.unless,
            "beside": [m.cell.name for m in self.beside],
            "waiting": [m.cell.name for m in self.waiting],
            "unsure": [m.cell.name for m in self.unsure],
        }


def reaches(m: Measured, target: int) -> bool:
    """Return whether an estimator comes to one of `TARGETS` in a time that is known."""
    return bool(m.reaches) and m.reaches[target].reached


def soonest(scene: Sequence[Measured], sure: float) -> list[Soonest | None]:
    """Return who is soonest to each of `TARGETS`, None where nobody comes; times are compared with the confidence `sure`."""
    found: list[Soonest | None] = []
    for target in range(len(TARGETS)):
        there = [m for m in scene if reaches(m, target)]
        known = [m for m in there if m.reaches[target].unless != "rare"]
        first = min(known or there, key=lambda m: m.reaches[target].times.estimate.value, default=None)
        if first is None:
            found.append(None)
        else:
            beside, waiting = _beside(scene, first, target, sure), _may_be_sooner(scene, first, target)
            found.append(Soonest(first, first.reaches[target], beside, waiting, target))
    return found


def table(scene: Sequence[Measured], sure: float) -> list[dict[str, Any]]:
    """Return, for each of `TARGETS`, who is soonest of all and of the unbiased, JSON-ready."""
    of_all, of_unbiased = soonest(scene, sure), soonest([m for m in scene if m.unbiased], sure)
    return [
        {"error": error, "all": a and a.record(), "unbiased": u and u.record()}
        for error, a, u in zip(TARGETS, of_all, of_unbiased, strict=True)
    ]


def _beside(scene: Sequence[Measured], first: Measured, target: int, sure: float) -> tuple[Measured, ...]:
    others = [m for m in scene if m.reaches and m is not first and m.reaches[target].unless != "rare"]
    there = [(m, m.reaches[target].relative_to(first.reaches[target], sure)) for m in others]
    return tuple(m for m, ratio in there if ratio is not None and not ratio.low > 1)


def _may_be_sooner(scene: Sequence[Measured], first: Measured, target: int) -> tuple[Measured, ...]:
    least = first.reaches[target].times.estimate.value
    late = [m for m in scene if m.reaches and (m.reaches[target].how == "not-reached" or _unsure(m, target))]
    return tuple(m for m in late if m.waited_for and (m is first or m.reaches[target].at_least < least))


def _unsure(m: Measured, target: int) -> bool:
    """Return whether values too rare to be met may make the time longer."""
    return m.reaches[target].reached and m.reaches[target].unless == "rare"
