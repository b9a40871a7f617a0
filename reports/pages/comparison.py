"""Two runs on one page: what came out worse, what was mended, what is new or gone, and what it costs."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from fogproof.reports.charts.before_after import BeforeAfter
from fogproof.reports.charts.pictures import Picture, render
from fogproof.reports.charts.time_changes import TimeChanges
from fogproof.reports.pages.templates import cases as some_cases
from fogproof.reports.pages.templates import fill
from fogproof.reports.records.runs import Case, RunRecord
from fogproof.reports.records.study_record import History
from fogproof.whole_files import write_file

BECAME = ("biased", "noisier", "slower", "different", "less noisy", "faster")
"""What may have become of an estimator of a study that is judged as before."""
CHANGES = ("worse", *BECAME[:4], "changed", "gone", "mended", *BECAME[4:], "new", "same")
"""What may have become of a case, from what needs attention to what does not."""

_WRONG = {"rejected", "surprise", "error"}


@dataclass(frozen=True)
class Pair:
    """One case in two runs; None in the run that lacks it. `became` holds those of `BECAME` that were found of it.

    worse  whether that is worse than it was
    """

    name: str
    before: Case | None
    after: Case | None
    became: tuple[str, ...] = ()
    worse: bool = False

    @property
    def change(self) -> str:
        """One of `CHANGES`: worse and mended are between right and wrong, changed is any other change of status."""
        if self.before is None:
            return "worse" if self.wrong else "new"
        if self.after is None:
            return "gone"
        if self.wrong != (self.before.status in _WRONG):
            return "worse" if self.wrong else "mended"
        if self.before.status != self.after.status:
            return "changed"
        return self.became[0] if self.became else "same"

    @property
    def wrong(self) -> bool:
        """Whether the newer run has the case, and has it wrong."""
        return self.after is not None and self.after.status in _WRONG


def pair_cases(before: RunRecord, after: RunRecord, history: History | None = None) -> list[Pair]:
    """Return the cases of both runs, matched by name, what needs attention first."""
    old, new = ({case.name: case for case in run.cases} for run in (before, after))
    changes = {f"{change.scene} / {change.estimator}": change for change in (history.changes if history else ())}
    became = {name: tuple(word for word in BECAME if word in change.became) for name, change in changes.items()}
    worse = {name for name, change in changes.items() if change.worse}
    pairs = [Pair(name, old.get(name), new.get(name), became.get(name, ()), name in worse) for name in old | new]
    return sorted(pairs, key=lambda pair: (CHANGES.index(pair.change), not pair.wrong))


def exit_code(before: RunRecord, after: RunRecord, history: History | None = None) -> int:
    """Return 1 if a case came out worse in the newer run, 3 if one is gone: nothing is known of it any more; else 0.

    history  of a study: what else came out worse, beyond noise
    """
    changes = {pair.change for pair in pair_cases(before, after)}
    return 1 if "worse" in changes or (history and history.worse) else 3 if "gone" in changes or after.unfinished else 0


def write_comparison_page(before: RunRecord, after: RunRecord, folder: Path, history: History | None = None) -> Path:
    """Write `folder/comparison.html` and its figures; return the page's path."""
    pairs = pair_cases(before, after, history)
    figures = _figures(pairs, history)
    for picture in figures:
        picture.save(folder / "figures")
    counts = {change: sum(pair.change == change for pair in pairs) for change in CHANGES}
    still = sum(pair.wrong and pair.change != "worse" for pair in pairs)
    became = {word: sum(word in pair.became or word == pair.change for pair in pairs) for word in CHANGES}
    words = headline(became, still, len(pairs), sum(pair.worse or pair.change == "worse" for pair in pairs))
    page = fill(
        "comparison.html",
        kind="comparison",
        before=before,
        after=after,
        pairs=pairs,
        counts=counts,
        settings=_settings(before, after),
        figures=figures,
        history=history,
        headline=(words[0], f"{words[1]}; both are one and the same run") if before == after else words,
        tone="bad"
        if counts["worse"] or still or (history and history.worse)
        else "care"
        if counts["changed"] or counts["different"] or counts["gone"]
        else "good",
    )
    return write_file(folder / "comparison.html", page)


def headline(counts: dict[str, int], still: int, total: int, slipped: int = 0) -> tuple[str, str]:
    """Return what changed in words: a sentence that stands alone, and the counts behind it.

    slipped  how many came out worse: wrong, biased, slower or noisier
    """
    if slipped or counts["worse"]:
        first = f"{some_cases(max(slipped, counts['worse']))} came out worse"
    elif still:
        first = f"Nothing came out worse, but {some_cases(still)} {'is' if still == 1 else 'are'} wrong as before"
    elif counts["gone"]:
        first = f"{some_cases(counts['gone'])} {'is' if counts['gone'] == 1 else 'are'} gone; of the others, nothing came out worse"
    elif counts["same"] == total:
        first = "Every case came out as before"
    else:
        first = "Nothing came out worse"
    words = {"changed": "otherwise changed", "same": "as before"}
    listed = [f"{counts[change]} {words.get(change, change)}" for change in CHANGES if counts[change]]
    return first, ", ".join(listed) or "Both records are empty"


def _settings(before: RunRecord, after: RunRecord) -> list[tuple[str, Any, Any]]:
    """Return (name, before, after) of what could explain a change, what differs first."""
    names = ("command", "seed", "alpha", "fogproof", "started", "seconds", "exit_code")
    old, new = ({name: getattr(run, name) for name in names} | run.environment for run in (before, after))
    rows = [(name, old.get(name), new.get(name)) for name in old | new]
    return sorted(rows, key=lambda row: row[1] == row[2])


def _figures(pairs: list[Pair], history: History | None) -> list[Picture]:
    """Return what a run is compared by: how small an error is caught, and time; of a study's estimators that of one estimate."""

    def resolution(case: Case) -> float:
        found = case.verdict.resolution if case.verdict is not None and case.verdict.outcome != "rejected" else None
        return found.value if found else 0.0

    def kind(case: Case) -> str:
        return case.verdict.resolution.kind if case.verdict is not None and case.verdict.resolution else ""

    both = [(pair.name, pair.before, pair.after) for pair in pairs if pair.before and pair.after]
    seconds = [(name, a.seconds, b.seconds) for name, a, b in both if a.verdict is not None and b.verdict is not None]
    caught = [(name, resolution(a), resolution(b)) for name, a, b in both if kind(a) == kind(b)]
    told = _times(history)
    figures = [render(told, "comparison-times", told.size)] if told else []
    rest = (("resolution", "Smallest error caught", caught), ("seconds", "Time [s]", [] if told else seconds))
    for stem, what, rows in rest:
        usable = [row for row in rows if 0 < row[1] < inf and 0 < row[2] < inf]
        if usable:
            drawing = BeforeAfter(what, *(tuple(column) for column in zip(*usable, strict=True)))
            figures.append(render(drawing, f"comparison-{stem}", (560, 440)))
    return figures


def _times(history: History | None) -> TimeChanges | None:
    """Return how the times of a study's estimators changed, None where none is in both runs."""
    told = [
        (f"{change.scene} / {change.estimator}", change.time, bool({"slower", "faster"} & set(change.became)))
        for change in (history.changes if history else ())
        if change.time is not None and 0 < change.time.value < inf
    ]
    if not told:
        return None
    names, times, changed = zip(*told, strict=True)
    value, low, high = (tuple(getattr(time, end) for time in times) for end in ("value", "low", "high"))
    return TimeChanges(names, value, low, high, changed)
