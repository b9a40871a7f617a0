"""The page of a study: the answers and their picture first, then how fast each estimator nears the oracle's value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf, nan
from pathlib import Path

from fogproof.reports.charts.convergence import Convergence, ErrorCurve
from fogproof.reports.charts.pictures import Picture, render
from fogproof.reports.pages.page import STATUSES
from fogproof.reports.pages.summaries import needs
from fogproof.reports.pages.templates import fill
from fogproof.reports.records.runs import Case, Status
from fogproof.reports.records.studies import as_run
from fogproof.reports.records.study_record import Answer, SceneRecord, StudyEntry, StudyRecord, TargetRecord
from fogproof.reports.text import file_stem
from fogproof.text import marked, unbiased, unfinished
from fogproof.whole_files import write_file


@dataclass(frozen=True)
class StudyRow:
    """An estimator as the page shows it: its entry and its verdict."""

    entry: StudyEntry
    case: Case


@dataclass(frozen=True)
class SceneShown:
    """A scene with its figures (title, picture), the first over time, and its estimators, the soonest first."""

    scene: SceneRecord
    rows: tuple[StudyRow, ...]
    figures: tuple[tuple[str, Picture], ...]

    @property
    def targets(self) -> tuple[TargetRecord, ...]:
        """The errors that times are told for."""
        return next((row.entry.speed.targets for row in self.rows if row.entry.speed and row.entry.speed.targets), ())

    def label(self, name: str) -> str:
        """Return the label of an estimator."""
        return next((row.entry.label for row in self.rows if row.entry.name == name), name)

    @property
    def reached(self) -> bool:
        """Whether anybody comes to any of the errors."""
        return any(row.all for row in self.scene.answer.soonest)

    @property
    def any_unbiased(self) -> bool:
        """Whether any came out unbiased."""
        return any(row.entry.status == "passed" for row in self.rows)

    @property
    def biased(self) -> list[StudyEntry]:
        """Those that are soonest to some error and are not unbiased, or not known to be."""
        first = {row.all.name for row in self.scene.answer.soonest if row.all}
        return [row.entry for row in self.rows if row.entry.name in first and row.entry.status != "passed"]


def write_study_page(study: StudyRecord, folder: Path) -> Path:
    """Write `folder/index.html` and its figures; return the page's path."""
    run = as_run(study)
    cases = {case.name: case for case in run.cases}
    shown = []
    for scene in study.scenes:
        figures = tuple(
            (title, render(drawing, file_stem(scene.name, name), drawing.size))
            for name, title, drawing in _figures(scene, study.confidence)
        )
        for _, picture in figures:
            picture.save(folder / "figures")
        rows = [StudyRow(entry, cases[f"{scene.name} / {entry.name}"]) for entry in scene.estimators]
        place = {name: k for k, name in enumerate((*scene.answer.ranking, *scene.answer.unranked))}
        rows.sort(key=lambda row: place.get(row.entry.name, len(place)))
        shown.append(SceneShown(scene, tuple(rows), figures))
    counts = {status: sum(case.status == status for case in run.cases) for status in STATUSES}
    page = fill(
        "study.html",
        kind="study",
        study=study,
        run=run,
        scenes=shown,
        questions=_questions(study, shown),
        timed=next((one.scene.name for one in shown if one.targets), ""),
        counts=counts,
        heavy=[row for one in shown for row in one.rows if row.entry.warning],
        needs=needs(run.cases),
        has_csv=(folder / "results.csv").exists(),
        headline=headline(study, counts),
        tone=_tone(study, counts),
        unbiased_in_words=_unbiased,
        marked=marked,
    )
    return write_file(folder / "index.html", page)


def headline(study: StudyRecord, counts: Mapping[Status, int]) -> tuple[str, str]:
    """Return the outcome of a study in words: a sentence that stands alone, and the counts behind it."""
    total = sum(counts.values())
    done, planned = study.batches.get("done", 0), study.batches.get("planned", 0)
    left = unfinished(done, planned, study.state == "interrupted")
    if not total:
        first = "No estimator was studied"
    elif counts["rejected"]:
        first = (
            f"{counts['rejected']} of {total} estimators {'is' if counts['rejected'] == 1 else 'are'} {_fault(study)}"
        )
    elif left:
        first = ""
    elif study.history and study.history.worse:
        first = "Something came out worse than before"
    elif counts["inconclusive"]:
        n = counts["inconclusive"]
        first = f"No bias was found, but {n} of {total} estimators {'is' if n == 1 else 'are'} not judged unbiased yet"
    else:
        first = "Every estimator came out as expected"
    if left:
        first = f"{left} batches are drawn" + (f"; {first[0].lower()}{first[1:]}" if first else "")
    words = {"passed": "unbiased as far as seen", "known": "biased as declared", "rejected": "wrong"}
    parts = [f"{counts[status]} {words.get(status, status)}" for status in STATUSES if counts[status]]
    scenes = f"{len(study.scenes)} scene{'' if len(study.scenes) == 1 else 's'}"
    return first, ", ".join([f"{study.title}: {scenes}" if study.title.strip() else scenes, *parts])


def _fault(study: StudyRecord) -> str:
    """Return what is to be said of those that were rejected: biased, where nothing else was found wrong with any."""
    entries = [entry for scene in study.scenes for entry in scene.estimators if entry.status == "rejected"]
    return "wrong" if any(rejected_for(entry) for entry in entries) else "biased"


def rejected_for(entry: StudyEntry) -> str:
    """Return the checks that rejected an estimator if none of them is about its bias, else ""."""
    checks = [finding.check for finding in entry.findings if finding.outcome == "rejected"]
    return "" if {"mean", "value", "random points"} & set(checks) else ", ".join(checks)


def _unbiased(entry: StudyEntry) -> str:
    return unbiased(entry.status, entry.axis != "samples", entry.unbiased_to, rejected_for(entry))


def _tone(study: StudyRecord, counts: Mapping[Status, int]) -> str:
    if counts["rejected"] or study.failures or (study.history and study.history.worse):
        return "bad"
    return "care" if counts["inconclusive"] or not sum(counts.values()) else "good"


def _questions(study: StudyRecord, shown: Sequence[SceneShown]) -> list[tuple[str, list[tuple[Answer, SceneShown]]]]:
    """Return the answers by question, both in the order of the study."""
    scenes = {one.scene.name: one for one in shown}
    asked: dict[str, list[tuple[Answer, SceneShown]]] = {}
    for answer in study.answers:
        if answer.scene in scenes:
            asked.setdefault(answer.question, []).append((answer, scenes[answer.scene]))
    return list(asked.items())


def _figures(scene: SceneRecord, confidence: float) -> Iterator[tuple[str, str, Convergence]]:
    """Yield (name, title, drawing): all estimators over time; then random points, and Sobol points and marching, over their number.

    Errors are relative to the reference, unless that is 0.
    """
    size = abs(scene.reference.value)
    unit = "" if scene.unit == "1" else f" [{scene.unit.replace('^2', '²')}]"
    up = "relative root mean square error" if size else f"root mean square error{unit}"
    looks = list(dict.fromkeys((entry.kind, str(entry.options)) for entry in scene.estimators))
    timed: list[ErrorCurve] = []
    counted: tuple[list[ErrorCurve], list[ErrorCurve]] = ([], [])
    for entry in scene.estimators:
        if entry.axis == "nothing":  # exact: there is no error to fall
            continue
        look = looks.index((entry.kind, str(entry.options)))
        other = entry.points == "sobol" or entry.axis == "steps"
        counted[other].extend(_curve(entry, look, [float(c.count) for c in entry.counts], other, size or 1.0))
        if entry.speed:
            milliseconds = [1e3 * timing.seconds for timing in entry.speed.counts]
            timed += _curve(entry, look, milliseconds, other, size or 1.0, False)
    errorless = tuple(
        e.label for e in scene.estimators if e.counts and e.axis != "nothing" and not any(c.rmse for c in e.counts)
    )
    for name, across, title, curves, slope in (
        ("time", "processor time of one estimate [ms]", "Error against time", timed, 0.0),
        ("samples", "samples", "Error against samples", counted[0], -0.5),
        ("other", "Sobol points, or steps of a march", "Sobol points and marching", counted[1], -1.0),
    ):
        if curves and (
            not slope or any(len(curve.effort) > 1 for curve in curves)
        ):  # over counts one point tells nothing
            yield name, title, Convergence(across, up, tuple(curves), confidence, slope, errorless if not slope else ())


def _curve(
    entry: StudyEntry, look: int, effort: list[float], dashed: bool, size: float, predicted: bool = True
) -> list[ErrorCurve]:
    """Return the curve of an estimator over its effort, relative to `size`, without what a logarithm cannot show; or none."""
    kept = [(x, c) for x, c in zip(effort, entry.counts, strict=True) if x > 0 and 0 < c.rmse < inf]
    if not kept:
        return []
    counts = [c for _, c in kept]
    return [
        ErrorCurve(
            entry.label,
            look,
            tuple(x for x, _ in kept),
            tuple(c.rmse / size for c in counts),
            tuple(c.rmse_low / size for c in counts),
            tuple(c.rmse_high / size for c in counts),
            tuple(nan if c.predicted is None or not predicted else c.predicted / size for c in counts),
            dashed,
        )
    ]
