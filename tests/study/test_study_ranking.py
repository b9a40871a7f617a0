"""Who is soonest, in words and numbers: intervals that hold all at once, and sentences that say no more than they do."""

import re
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fogproof.checks.statistics.tails import binomial_at_most
from fogproof.study.measures import Measured
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
    failed: int = 0
    unfinished: bool = False
    record: dict[str, Any] = field(init=False)

    def __post_init__(self):
        self.cell = SimpleNamespace(name=self.name, points="random", method=SimpleNamespace(axis="samples"))
        self.judged = SimpleNamespace(wrong=frozenset({"mean"}))
        self.record = {"label": self.name, "speed": {}, "counts": [{"count": 4096, "rmse": 0.1}]}
        self.reaches = tuple(Reach(error, "measured", "", 1.0, Times(self.seconds)) for error in TARGETS)

    unbiased = Measured.unbiased
    waited_for = Measured.waited_for


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
        head = said["text"].split("\n")[0]
        seen.add(bool(beside))
        if beside:
            names = " and ".join(m.name for m in beside)
            assert re.match(rf"{first.name} is first: 1 %.*, not to be told from {names}[;.]", head.lower())
        else:
            assert head.lower().startswith(f"{first.name} is soonest: 1 %")
    assert seen == {True, False}


def test_who_is_first_to_several_errors_is_named_once():
    """Another that cannot be told from it to one error, and is later to the next, is named where it belongs."""
    first, other = equal(np.random.default_rng(), 2, scatter=0.0)
    late = Times(9 * other.seconds)
    other.reaches = (other.reaches[0], *(Reach(error, "measured", "", 1.0, late) for error in TARGETS[1:]))
    head = ranked([first, other])["text"].split("\n")[0]
    assert re.fullmatch("N0 is first: 1 % in [^,]*, not to be told from n1; 0.1 % and 0.01 % in [^,]*", head)
    assert head.count("N0") + head.count("n0") == 1


def test_the_least_time_to_each_error_is_named_whoever_was_first_before():
    """One that is sooner to 0.1 %, though not shown to be, is named there: as the table and the figure say."""
    wide = np.exp(0.3 * np.array([1, -1] * 4))
    first, other = Timed("first", wide), Timed("other", 1.2 / wide)
    for m, late in ((first, 3.0), (other, 1.5)):
        m.reaches = (
            m.reaches[0],
            *(Reach(error, "measured", "", 1.0, Times(late * m.seconds)) for error in TARGETS[1:]),
        )
    said = ranked([first, other])
    for row, at in zip(said["soonest"], range(3), strict=True):
        least = min((first, other), key=lambda m: m.reaches[at].times.estimate.value)
        assert (row["all"]["name"], row["all"]["seconds"]) == (least.name, least.reaches[at].times.estimate.value)
    assert [row["all"]["name"] for row in said["soonest"]] == ["first", "other", "other"]
    assert all(len(row["all"]["beside"]) == 1 for row in said["soonest"])
    assert (
        said["text"].split("\n")[0].endswith("; other is first: 0.1 % and 0.01 % in 1.8 s, not to be told from first.")
    )


def test_the_table_of_the_soonest_says_what_the_sentences_say():
    """To each error: who, in what time, who may be as soon; of the unbiased apart, where the soonest of all is none."""
    rng = np.random.default_rng()
    fast, other = equal(rng, 2, scatter=0.0)
    fast.status = "known"
    late = Timed("late", 9 * other.seconds)
    late.reaches = (*late.reaches[:2], Reach(TARGETS[2], "not-reached", "", None, Times(late.seconds / 90)))
    said = ranked([fast, other, late])
    rows = said["soonest"]
    assert [row["error"] for row in rows] == list(TARGETS)
    assert [(row["all"]["name"], row["all"]["beside"]) for row in rows] == [("n0", ["n1"])] * 3
    assert [(row["unbiased"]["name"], row["unbiased"]["beside"]) for row in rows] == [("n1", [])] * 3
    assert [row["unbiased"]["waiting"] for row in rows] == [[], [], ["late"]]
    assert rows[0]["all"]["seconds"] == fast.reaches[0].times.estimate.value
    assert said["notes"] == said["text"].split("\n")[-len(said["notes"]) :]


def not_there(name, how="not-reached", **more):
    late = Timed(name, np.linspace(1, 1.1, ROUNDS), **more)
    late.reaches = tuple(Reach(error, how, "", None, Times(1e-3 * late.seconds)) for error in TARGETS)
    return late


def test_what_is_to_be_mended_first_keeps_no_answer_open():
    first = Timed("first", np.linspace(1, 1.1, ROUNDS))
    others = [not_there("few"), not_there("wrong", status="rejected"), not_there("broken", failed=4096)]
    said = ranked([first, *others])
    assert [row["all"]["waiting"] for row in said["soonest"]] == [["few"]] * 3
    assert "Failed at 4096: broken." in said["notes"]
    assert ranked([first, *others[1:]])["text"].startswith("First is soonest: 1 %, 0.1 % and 0.01 % in ")


@pytest.mark.parametrize(
    ("scene", "end"),
    [
        ([not_there("a")], "; a comes nearest with 4096. Raise `samples`."),
        ([not_there("a", "never")], ", and none will: the bias of a stays."),
        (
            [not_there("a", "never"), not_there("b", "rises"), not_there("c", "never")],
            ", and none will: the bias of a and c stays and the error of b grows.",
        ),
        ([not_there("a", "never"), not_there("b")], "; a comes nearest with 4096. Raise `samples` for b."),
        ([not_there("a", status="rejected")], "; a comes nearest with 4096."),
        ([not_there("a", failed=4096)], "; a comes nearest with 4096."),
    ],
)
def test_more_samples_are_asked_for_where_they_can_help(scene, end):
    assert ranked(scene)["notes"][0] == f"None comes within 1 %{end}"


def test_an_interrupted_study_is_to_be_finished():
    """Other counts would not help: those that there are have not been drawn."""
    assert ranked([not_there("a", unfinished=True)])["notes"][0].endswith(
        "a comes nearest with 4096. Let the study finish."
    )
    late = not_there("a", unfinished=True)
    late.reaches = tuple(replace(reach, untimed=True) for reach in late.reaches)
    assert (
        "Of a what more samples would take these counts do not tell: let the study finish." in ranked([late])["notes"]
    )


def test_those_that_are_not_named_are_counted():
    """Of many that are slower three are named, and how many more there are is said."""
    scene = [Timed(f"n{k}", np.full(ROUNDS, 10.0**k) * np.linspace(1, 1.01, ROUNDS)) for k in range(7)]
    (said,) = ranked(scene)["notes"]
    assert (
        said
        == "To 1 % n0 is 10 times as fast as n1, 100 times as fast as n2, 1 000 times as fast as n3 and more than that of 3 others."
    )


def test_a_speed_of_what_is_only_bounded_is_a_bound():
    """Numbers and words have one rule: nothing "is k times" as fast as what takes less than its first count, or than that first."""
    wobble = np.linspace(1, 1.001, ROUNDS)
    first, second = (Timed(name, seconds * wobble) for name, seconds in (("first", 1.0), ("second", 2.0)))

    def speed(*bounded):
        for one in (first, second):
            how = "less-than" if one in bounded else "measured"
            one.reaches = tuple(replace(reach, how=how) for reach in one.reaches)
        text, found = ranked([first, second])["text"].lower(), second.record["speed"]["relative"]
        assert ("first is soonest" in text) == (found["high"] < 1) == ("not to be told from second" not in text)
        said = re.search("to 1 % first is (.*) as fast as second", text)
        return found["low"], found["high"], said and said[1]

    assert speed() == (*(pytest.approx(0.5, rel=1e-9),) * 2, "2 times")
    assert speed(second) == (pytest.approx(0.5, rel=1e-9), np.inf, None)
    assert speed(first) == (0.0, pytest.approx(0.5, rel=1e-9), "at least 2 times")
    assert speed(first, second) == (0.0, np.inf, None)


@pytest.mark.parametrize("hidden", [(False, False), (True, False), (False, True), (True, True)])
def test_a_time_on_condition_is_compared_on_that_condition(hidden):
    """A bias that is not seen makes later, never sooner: it leaves open what is told from one without, and nothing between two."""
    wobble = np.linspace(1, 1.001, ROUNDS)
    scene = [Timed(name, seconds * wobble) for name, seconds in (("first", 1.0), ("second", 2.0))]
    for one, hides in zip(scene, hidden, strict=True):
        one.reaches = tuple(replace(reach, unless="bias" if hides else "") for reach in one.reaches)
    said = ranked(scene)
    lines, found = said["text"].split("\n"), scene[1].record["speed"]["relative"]
    assert ("(if unbiased)" in lines[0]) == hidden[0]
    assert (found["high"] < 1) == (hidden != (True, False)) == (said["soonest"][0]["all"]["beside"] == [])
    assert (found["low"] == 0) == (hidden == (False, True))
    words = {(False, False): " is 2", (False, True): " is at least 2", (True, True): ", if unbiased, is 2"}
    assert lines[1:] == ([f"To 1 % first{words[hidden]} times as fast as second."] if hidden in words else [])


def test_values_that_were_not_met_leave_it_open_who_is_soonest():
    wobble = np.linspace(1, 1.001, ROUNDS)
    known, rare = Timed("known", 2.0 * wobble), Timed("rare", wobble)
    rare.reaches = tuple(replace(reach, unless="rare") for reach in rare.reaches)
    said = ranked([rare, known])
    assert (said["best"], said["ranking"]) == ("known", ["known", "rare"])
    assert [row["all"]["unsure"] for row in said["soonest"]] == [["rare"]] * 3
    assert said["text"] == (
        "Who is soonest to 1 %, 0.1 % and 0.01 % these counts do not tell: rare is not sure yet. So far: 1 % known in 2 s, "
        "0.1 % known in 2 s, 0.01 % known in 2 s."
    )
    assert rare.record["speed"]["relative"]["low"] == 0
    late = Timed("late", 9 * wobble)
    late.reaches = tuple(replace(reach, unless="rare") for reach in late.reaches)
    assert ranked([late, known])["text"].startswith("Known is soonest: ")  # rare values make it later still
    assert ranked([rare])["text"].startswith(
        "Who is soonest to 1 %, 0.1 % and 0.01 % these counts do not tell: rare is not sure"
    )


def test_what_rounds_to_once_as_fast_is_not_said():
    """That the second takes 1.03 times as long is sure, and no news."""
    wobble = np.linspace(1, 1.001, ROUNDS)
    scene = [Timed(f"n{k}", seconds * wobble) for k, seconds in enumerate((1.0, 1.03, 2.0))]
    assert ranked(scene)["notes"] == ["To 1 % n0 is 2 times as fast as n2."]
    assert ranked(scene[:2])["notes"] == []
