"""Who is soonest, in words and numbers: intervals that hold all at once, and sentences that say no more than they do."""

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fogproof.checks.statistics.tails import binomial_at_most
from fogproof.study.ranking import ranked
from fogproof.study.reaching import TARGETS, Reach
from fogproof.study.speed import Times

ROUNDS = 8


@dataclass(eq=False)
class Timed:
    """An estimator that reaches every error in the times of some rounds."""

    name: str
    seconds: np.ndarray
    status: str = "passed"
    record: dict[str, Any] = field(init=False)

    def __post_init__(self):
        self.cell = SimpleNamespace(name=self.name, points="random", method=SimpleNamespace(axis="samples"))
        self.record = {"label": self.name, "speed": {}, "counts": []}
        self.reaches = tuple(Reach(error, "measured", "", 1.0, Times(self.seconds)) for error in TARGETS)

    @property
    def unbiased(self):
        return self.status == "passed"


def equal(rng, n, scatter=0.05):
    """Return n that take the same time, whose rounds share the machine's moods."""
    moods = 0.3 * rng.normal(size=ROUNDS)
    return [Timed(f"n{k}", np.exp(moods + scatter * rng.normal(size=ROUNDS))) for k in range(n)]


def test_the_speeds_of_a_scene_hold_all_at_once():
    """Twelve alike: chance makes one the soonest, and 99 % of the scenes say nothing false of any other."""
    rng, held = np.random.default_rng(), 0
    for _ in range(150):
        scene = equal(rng, 12)
        ranked(scene)
        speeds = [m.record["speed"]["relative"] for m in scene]
        held += all(s["low"] <= 1 <= s["high"] for s in speeds)
    assert binomial_at_most(held, 150, 0.99) > 1e-6


@pytest.mark.parametrize("status", ["passed", "known"])
def test_a_sentence_says_no_more_than_the_intervals(status):
    """Those that may be as soon are named, biased or not; where all are shown to be later the first is the soonest."""
    rng = np.random.default_rng()
    seen = set()
    for gap in (1.0, 1.05, 3.0) * 4:
        scene = equal(rng, 3)
        scene[0].status = status
        scene[2] = Timed("late", 9 * scene[2].seconds)
        scene[1] = Timed("n1", gap * scene[1].seconds)
        said = ranked(scene)
        beside = [m for m in scene if m.record["speed"]["rank"] > 1 and m.record["speed"]["relative"]["high"] >= 1]
        first = next(m for m in scene if m.record["speed"]["rank"] == 1)
        head = said["text"].split(". ")[0]
        seen.add(bool(beside))
        if beside:
            names = " and ".join(m.name for m in beside)
            assert head.lower().startswith(f"{first.name} is first, though not to be told from {names}: 1 %")
        else:
            assert head.lower().startswith(f"{first.name} is soonest: 1 %")
    assert seen == {True, False}


def test_who_is_first_to_several_errors_is_named_once():
    """Another that cannot be told from it to one error, and is later to the next, is named where it belongs."""
    first, other = equal(np.random.default_rng(), 2, scatter=0.0)
    late = Times(9 * other.seconds)
    other.reaches = (other.reaches[0], *(Reach(error, "measured", "", 1.0, late) for error in TARGETS[1:]))
    head = ranked([first, other])["text"].split(". ")[0]
    assert head.startswith("N0 is first, though not to be told from n1: 1 % in ")
    assert "; soonest: 0.1 % and 0.01 % in " in head
    assert head.count("N0") + head.count("n0") == 1
