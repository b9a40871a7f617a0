"""The record of a convergence study: scenes, the estimators that were put to them, and how they compare."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fogproof.checks.verdict import Verdict
from fogproof.errors import InvalidInputError, shorten
from fogproof.reports.records.runs import Case, RunRecord, validated
from fogproof.reports.records.study_record import SceneRecord, StudyEntry, StudyRecord


def parse_study(record: dict[str, Any], origin: str = "record") -> StudyRecord:
    """Return the record of a study as dataclasses; a fault is an `InvalidInputError` that names its place."""
    study = validated(StudyRecord, record, origin)
    names: set[tuple[str, str]] = set()
    for scene in study.scenes:
        for entry in scene.estimators:
            if (scene.name, entry.name) in names:
                raise InvalidInputError(
                    f"{origin}: scene {shorten(scene.name)} has {shorten(entry.name)} twice", "scenes"
                )
            names.add((scene.name, entry.name))
            if entry.speed and len(entry.speed.counts) != len(entry.counts):
                place = f"scenes.{scene.name}.{entry.name}.speed.counts"
                raise InvalidInputError(f"{origin}: {place} must be as many as counts", place)
    return study


def as_run(study: StudyRecord) -> RunRecord:
    """Return the bias gate of a study as a run: each estimator in its scene is a case."""
    cases = [_case(study, scene, entry) for scene in study.scenes for entry in scene.estimators]
    return RunRecord(
        schema="fogproof/results/1",
        kind="study",
        fogproof=study.fogproof,
        environment=study.environment,
        command=study.command,
        seed=study.seed,
        alpha=study.alpha,
        started=study.started,
        seconds=study.seconds,
        exit_code=study.exit_code,
        cases=tuple(cases),
        state=study.state,
    )


def _case(study: StudyRecord, scene: SceneRecord, entry: StudyEntry) -> Case:
    reference = scene.reference
    case = Case(
        name=f"{scene.name} / {entry.name}",
        title=entry.label,
        kind="estimator",
        status=entry.status,
        expected=entry.expected,
        reason=entry.reason,
        source=reference.source,
        reference=f"{reference.value:.12g} ± {reference.error:.2g}, {reference.method}",
        twin="",
        reproduce=study.command,
        seconds=entry.speed.cpu_total if entry.speed else 0.0,
        plan=scene.plan,
    )
    if not entry.findings:
        return case
    drawn = int(entry.moments.get("n") or 0)
    return replace(case, verdict=Verdict(entry.findings, study.alpha, drawn, study.seed, case.seconds, entry.options))
