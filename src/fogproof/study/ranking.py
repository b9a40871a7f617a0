"""Who reaches a given error soonest in a scene, in words too. Bias is part of the error; whether there is any is told beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from itertools import groupby
from typing import Any

from fogproof.study.convergence import CONFIDENCE, Estimate
from fogproof.study.judgement import BY_BIAS
from fogproof.study.measures import Measured
from fogproof.study.methods.own import Own
from fogproof.study.reaching import TARGETS, Reach
from fogproof.study.soonest import Soonest, reaches, soonest, table
from fogproof.text import duration

_AT = 0
"""Ranks, and ratios of times, are those to the first of `TARGETS`."""
_SHOWN = 3


def ranked(scene: Sequence[Measured]) -> dict[str, Any]:
    """Return the ranking of a scene's estimators, who is soonest, and sentences, one a line; writes ranks and relative speeds.

    Those that do not reach the first target within their counts follow, the nearest first; last those without a curve. The
    intervals of a scene's relative speeds hold all at once: whoever comes out first, its ratio to any other is one of all pairs'
    (Bonferroni 1936).
    """
    sure = _of_all_pairs(scene)
    order = sorted((m for m in scene if m.reaches), key=_key)
    reaching = [m for m in order if reaches(m, _AT)]
    unbiased = [m for m in reaching if m.unbiased]
    first = reaching[0] if reaching else None
    for m in scene:
        speed = m.record["speed"]
        if speed is not None:
            relative = None if first is None or not m.reaches else first.reaches[_AT].relative_to(m.reaches[_AT], sure)
            relative = Estimate(1.0, 1.0, 1.0) if m is first else relative
            speed["rank"] = order.index(m) + 1 if m in reaching else None
            speed["relative"] = None if relative is None else asdict(relative)
    notes = _notes(scene, sure)
    return {
        "best": None if first is None else first.cell.name,
        "best_unbiased": unbiased[0].cell.name if unbiased else None,
        "ranking": [m.cell.name for m in order],
        "unranked": [m.cell.name for m in scene if not m.reaches],
        "soonest": table(scene, sure),
        "notes": notes,
        "text": "\n".join(_to_the_errors(scene, sure) + notes),
    }


def _of_all_pairs(scene: Sequence[Measured]) -> float:
    """Return the confidence that each pair is compared with, so that all of them hold with `CONFIDENCE`."""
    n = sum(bool(m.reaches) for m in scene)
    return 1 - (1 - CONFIDENCE) / max(1, n * (n - 1) // 2)


def _key(m: Measured) -> tuple[int, float]:
    if reaches(m, _AT):
        return int(m.reaches[_AT].unless == "rare"), m.reaches[_AT].times.estimate.value
    return 2, m.record["counts"][-1]["rmse"]


def _to_the_errors(scene: Sequence[Measured], sure: float) -> list[str]:
    """Return the sentences that say who is soonest, of all and of the unbiased."""
    found = [one for one in soonest(scene, sure) if one is not None]
    biased = list(dict.fromkeys(one.first for one in found if not one.first.unbiased))
    said = _soonest(soonest(scene, sure), "")
    if biased:
        said += [f"{_first(m)} {_why_not_unbiased(m)}." for m in biased]
        unbiased = [m for m in scene if m.unbiased]
        said += _soonest(soonest(unbiased, sure), "Of the unbiased, ") if unbiased else ["None is judged unbiased."]
    return said


def _notes(scene: Sequence[Measured], sure: float) -> list[str]:
    """Return the sentences that say more than who is soonest."""
    if not any(m.reaches for m in scene):
        zero = all(float(m.cell.reference.value) == 0 for m in scene)
        return [
            "The reference is 0: no error is relative to it."
            if zero
            else "Nothing has been measured that could be compared."
        ]
    said = []
    firsts = [one.first for one in soonest(scene, sure) if one is not None]
    if not firsts:
        said.append(_none_comes([m for m in scene if m.reaches]))
    said += _compared(scene, sure)
    said += [_marched(m) for m in scene if m.cell.method.axis == "steps" and m.record["counts"]]
    failed = sorted((m for m in scene if m.failed), key=lambda m: m.failed)
    for count, those in groupby(failed, key=lambda m: m.failed):
        said.append(f"Failed at {count}: {_listed([_inside(m) for m in those])}.")
    at = [soonest(some, sure)[_AT] for some in (scene, [m for m in scene if m.unbiased])]
    waiting = [m for one in at if one is not None for m in one.waiting]
    late = [m for m in scene if m.reaches and m.reaches[_AT].untimed and m.waited_for]
    untimed = [_inside(m) for m in late if m in waiting or at[0] is None]
    if untimed:
        fix = "let the study finish" if any(m.unfinished for m in late) else "add a larger one to `samples`"
        said.append(f"Of {_listed(untimed)} what more samples would take these counts do not tell: {fix}.")
    biased = [m for m in firsts if not m.unbiased]
    open_ = [_inside(m) for m in scene if m.status == "inconclusive" and m.cell.points == "random" and m not in biased]
    if open_:
        said.append(f"Not judged unbiased yet: {_listed(open_)}.")
    wrong = [_rejected(m) for m in scene if m.status == "rejected"]
    if wrong:
        said.append(f"Rejected: {_listed(wrong)}.")
    return said


def _none_comes(scene: Sequence[Measured]) -> str:
    """Return who comes nearest to the first target, which nobody reaches, and whether more samples would help."""
    ways = {how: [m for m in scene if m.reaches[_AT].how == how] for how in ("not-reached", "never", "rises")}
    coming = [_inside(m) for m in ways["not-reached"] if m.waited_for]
    if not ways["not-reached"]:
        words = (("never", "the bias of {} stays"), ("rises", "the error of {} grows"))
        why = [said.format(_listed([_inside(m) for m in ways[how]])) for how, said in words if ways[how]]
        return f"None comes within {_percent(TARGETS[_AT])}, and none will: {_listed(why)}."
    nearest = min(scene, key=_key)
    count = nearest.record["counts"][-1]["count"]
    told = f"None comes within {_percent(TARGETS[_AT])}; {_inside(nearest)} comes nearest with {count}."
    if not coming:
        return told
    if any(m.unfinished for m in scene):
        return f"{told} Let the study finish."
    return f"{told} Raise `samples`{'' if len(coming) == len(scene) else f' for {_listed(coming)}'}."


def _soonest(found: Sequence[Soonest | None], lead: str) -> list[str]:
    """Return who is soonest to each error, in what time, and who is not to be told from it; and where the counts do not tell."""
    parts: list[str] = []
    untold: list[tuple[int, Soonest]] = []
    before = None
    there = [(one, target) for target, one in enumerate(found) if one is not None]
    for (first, beside), group in groupby(there, key=lambda pair: (pair[0].first, pair[0].beside)):
        told: dict[str, list[str]] = {}
        for one, target in group:
            if one.waiting:
                untold.append((target, one))
            else:
                told.setdefault(_time(one.reach), []).append(_percent(TARGETS[target]))
        if told:
            times = ", ".join(f"{_listed(errors)} in {time}" for time, errors in told.items())
            who = "" if first is before else f"{_inside(first)} is {'first' if beside else 'soonest'}: "
            parts.append(f"{who}{times}{f', not to be told from {_some(beside)}' if beside else ''}")
            before = first
    text = lead + "; ".join(parts)
    said = [f"{text[:1].upper() + text[1:]}."] if parts else []
    for _, group_of in groupby(untold, key=lambda pair: (pair[1].waiting, pair[1].unsure)):
        targets = list(group_of)
        errors = _listed([_percent(TARGETS[target]) for target, _ in targets])
        there_now = [
            f"{_percent(TARGETS[target])} {_inside(one.first)} in {_time(one.reach)}" for target, one in targets
        ]
        late = _may_be_sooner(targets[0][1])
        asked = f"{lead}who" if lead else "Who"
        said.append(f"{asked} is soonest to {errors} these counts do not tell: {late}. So far: {', '.join(there_now)}.")
    return said


def _may_be_sooner(one: Soonest) -> str:
    """Return why it is open who is soonest: who has not come so near yet, and whose error may be larger than it seems."""
    late = [m for m in one.waiting if m not in one.unsure]
    groups = [(late, "not there yet"), (one.unsure, "not sure yet")]
    return " and ".join(
        f"{_listed([_inside(m) for m in group])} {'is' if len(group) == 1 else 'are'} {why}"
        for group, why in groups
        if group
    )


def _why_not_unbiased(m: Measured) -> str:
    if m.status == "known":
        return "is biased by construction"
    return "was rejected" if m.status == "rejected" else "is not judged unbiased yet"


def _compared(scene: Sequence[Measured], sure: float) -> list[str]:
    """Return how many times as long others take that came out unbiased, to the first target; at least, where no end is known."""
    there = sorted((m for m in scene if m.unbiased and reaches(m, _AT)), key=_key)
    if len(there) < 2:
        return []
    first, *others = there
    said = []
    for other in others:
        ratio = other.reaches[_AT].relative_to(first.reaches[_AT], sure)
        if ratio is not None and ratio.low > 1:
            endless = ratio.high == math.inf
            times = _plain(ratio.low if endless else ratio.value)
            if times != "1":
                said.append(f"{'at least ' if endless else ''}{times} times as fast as {_inside(other)}")
    more = len(said) - _SHOWN
    shown = said if more <= 1 else [*said[:_SHOWN], f"more than that of {more} others"]
    condition = ", if unbiased," if first.reaches[_AT].unless == "bias" else ""
    return [f"To {_percent(TARGETS[_AT])} {_inside(first)}{condition} is {_listed(shown)}."] if said else []


def _marched(m: Measured) -> str:
    if m.unbiased:
        return f"{_first(m)} is exact here."
    order = m.record["order"]
    if order is None:
        return f"The order of {_inside(m)} cannot be seen within these counts."
    within = f"{order['value']:.2f} [{order['low']:.2f}, {order['high']:.2f}]"
    return f"{_first(m)} is of order {within} from {order['first']} steps on."


def _time(reach: Reach) -> str:
    time = duration(reach.times.estimate.value)
    words = {"less-than": f"less than {time}", "extrapolated": f"about {time}"}
    on = ["beyond the last count"] * (reach.how == "extrapolated") + ["if unbiased"] * (reach.unless == "bias")
    return words.get(reach.how, time) + (f" ({', '.join(on)})" if on else "")


def _plain(ratio: float) -> str:
    """Return two digits, without an exponent."""
    return f"{float(f'{ratio:.2g}'):,g}".replace(",", " ") if ratio < 1e6 else f"{ratio:.1g}"


def _percent(error: float) -> str:
    return f"{100 * error:g} %"


def _inside(m: Measured) -> str:
    """Return a label inside a sentence; our own begin with a plain word, those that somebody else wrote stand in quotes."""
    label: str = m.record["label"]
    if isinstance(m.cell.method, Own):
        return f"“{label}”"
    return label if label[1:2].isupper() else label[:1].lower() + label[1:]


def _first(m: Measured) -> str:
    """Return a label that begins a sentence."""
    text = _inside(m)
    return text[:1].upper() + text[1:]


def _rejected(m: Measured) -> str:
    """Return the label of what was rejected, and of what it was rejected for if not for a bias."""
    wrong = m.judged.wrong
    return _inside(m) if wrong & BY_BIAS else f"{_inside(m)} ({', '.join(sorted(wrong))})"


def _some(scene: Sequence[Measured]) -> str:
    """Return the labels of a few, and how many more there are."""
    labels = [_inside(m) for m in scene]
    more = len(labels) - _SHOWN
    return _listed(labels if more <= 1 else [*labels[:_SHOWN], f"{more} more"])


def _listed(items: Sequence[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"
