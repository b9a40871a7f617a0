"""One benchmark: ways to the same number, and the one that the others are compared with."""

from __future__ import annotations

import operator
import resource
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Clock = Callable[[], float]


def of_children() -> float:
    """Return the seconds that ended child processes have computed, in user and system."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@dataclass(frozen=True)
class Way:
    """One way to a number.

    run    does it once
    units  of work that one run does: samples, rays, lines
    error  of what `run` returned: the median relative error, None where there is none to speak of
    factor multiplies the time: the variance of one unit, where fewer units of less variance do as well
    clock  seconds of the processor; of child processes, where the work is theirs
    """

    run: Callable[[], Any]
    units: float = 1.0
    error: Callable[[Any], float] | None = None
    factor: float = 1.0
    clock: Clock = time.process_time


@dataclass(frozen=True)
class Goal:
    """What the ratio of a way's time to that of the base should be.

    >>> Goal("<=", 1.7).met(1.5)
    True
    """

    relation: Literal["<=", ">="]
    ratio: float

    def met(self, ratio: float) -> bool:
        """Return whether it is."""
        return bool({"<=": operator.le, ">=": operator.ge}[self.relation](ratio, self.ratio))

    def __str__(self) -> str:
        return f"{self.relation} {self.ratio:g}"


@dataclass(frozen=True)
class Benchmark:
    """Ways to the same number.

    name, title  of it
    unit   what one unit of work is
    base   the name of the way that times are divided by
    ways   name -> way; built when it is run
    goals  way -> what its ratio should be
    needs  the module that must be installed, "" if none
    rounds how many, relative to the others
    """

    name: str
    title: str
    unit: str
    base: str
    ways: Callable[[], Mapping[str, Way]]
    goals: Mapping[str, Goal] = field(default_factory=dict)
    needs: str = ""
    rounds: float = 1.0
