"""The record of a convergence study: scenes, the estimators that were put to them, and how they compare."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

from fogproof.checks.verdict import Finding, Outcome, Verdict
from fogproof.errors import InvalidInputError, shorten
from fogproof.plan import Plan
from fogproof.reports.records.runs import Case, RunRecord, validated


@dataclass(frozen=True)
class EstimateRecord:
    """A value and the interval, at the study's confidence, that holds the truth."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class OrderRecord(EstimateRecord):
    """The error falls like count^-value between two counts; see `study.convergence.Order`. `expected` is 0.5 for random points."""

    first: int
    last: int
    points: int
    misfit: float
    p: float | None = None
    expected: float | None = None


@dataclass(frozen=True)
class FloorRecord:
    """How near a marched estimate comes, with so many steps, and whether rounding ends the fall there."""

    error: float
    at: int
    reached: bool


@dataclass(frozen=True)
class Variance:
    """Variance of a realisation: measured, and `exact` by the oracle where it knows it."""

    measured: float
    low: float
    high: float
    exact: float | None = None
    exact_error: float | None = None
    method: str | None = None


@dataclass(frozen=True)
class Count:
    """The error after so many samples (steps, if marched); `predicted` is the oracle's."""

    count: int
    replicates: int
    mean: float
    rmse: float
    rmse_low: float
    rmse_high: float
    predicted: float | None = None


@dataclass(frozen=True)
class Timing:
    """Processor seconds of one estimate with so many samples or steps."""

    count: int
    seconds: float
    low: float
    high: float


@dataclass(frozen=True)
class TargetRecord:
    """What a relative error takes; None if it is not reached: `why` says how near the last count comes, in `low` seconds."""

    error: float
    how: Literal["measured", "less-than", "extrapolated", "not-reached", "never"]
    why: str
    samples: float | None
    seconds: float | None
    low: float
    high: float | None


@dataclass(frozen=True)
class Speed:
    """Time, and what it buys: `relative` is the soonest's time to the first target's error, divided by this one's."""

    cpu: EstimateRecord
    wall: float
    batches: int
    cpu_total: float
    counts: tuple[Timing, ...]
    targets: tuple[TargetRecord, ...]
    relative: EstimateRecord | None = None
    rank: int | None = None


@dataclass(frozen=True)
class StudyEntry:
    """One estimator of a scene."""

    name: str
    kind: str
    title: str
    label: str
    points: Literal["random", "sobol"]
    axis: Literal["samples", "steps", "nothing"]
    expected: Literal["not rejected", "rejected"]
    outcome: Outcome
    status: Literal["passed", "known", "rejected", "inconclusive"]
    moments: dict[str, Any]
    counts: tuple[Count, ...]
    findings: tuple[Finding, ...] = ()
    reason: str = ""
    warning: str = ""
    options: dict[str, Any] = field(default_factory=dict)
    bias: EstimateRecord | None = None
    variance: Variance | None = None
    wants: float = 1.0
    order: OrderRecord | None = None
    floor: FloorRecord | None = None
    cost: float | None = None
    speed: Speed | None = None


@dataclass(frozen=True)
class Answer:
    """Which estimator to take, in words; both names are of the soonest to the first target's error."""

    best: str | None
    best_unbiased: str | None
    text: str
    ranking: tuple[str, ...] = ()
    out: tuple[str, ...] = ()
    question: str = ""
    scene: str = ""


@dataclass(frozen=True)
class Truth:
    """The oracle's value: |value - truth| <= error."""

    value: float
    error: float
    method: str
    source: str


@dataclass(frozen=True)
class SceneRecord:
    """A scene, its reference, and its estimators in the order of the study file."""

    name: str
    question: str
    quantity: str
    unit: str
    described: dict[str, Any]
    reference: Truth
    answer: Answer
    estimators: tuple[StudyEntry, ...]
    plan: Plan | None = None


@dataclass(frozen=True)
class Change:
    """What became of an estimator since an earlier run; time and variance are ratios after / before."""

    scene: str
    estimator: str
    became: tuple[str, ...]
    time: EstimateRecord | None = None
    variance: EstimateRecord | None = None


@dataclass(frozen=True)
class History:
    """What changed since an earlier run of the same study."""

    before: dict[str, Any]
    same_draws: bool
    mood: float
    wander: float
    worse: bool
    text: str
    changes: tuple[Change, ...]
    gone: tuple[str, ...] = ()
    new: tuple[str, ...] = ()


@dataclass(frozen=True)
class StudyRecord:
    """A whole study."""

    title: str
    command: str
    started: str
    seconds: float
    cpu_seconds: float
    seed: int
    alpha: float
    confidence: float
    fogproof: str
    environment: dict[str, Any]
    executor: str
    workers: int
    exit_code: int
    digest: str
    settings: dict[str, Any]
    batches: dict[str, int]
    scenes: tuple[SceneRecord, ...]
    answers: tuple[Answer, ...] = ()
    failures: tuple[dict[str, Any], ...] = ()
    sessions: tuple[dict[str, Any], ...] = ()
    mixed: bool = False
    advice: str = ""
    history: History | None = None
    state: Literal["finished", "interrupted"] = "finished"


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
