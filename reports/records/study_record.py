"""The parts of a study's record, as pages read them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from fogproof.checks.verdict import Finding, Outcome
from fogproof.plan import Plan


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
    """Processor seconds of one estimate with so many samples or steps; `fixed_work`: over those of work that never changes."""

    count: int
    seconds: float
    low: float
    high: float
    fixed_work: dict[str, Any] | None = None


@dataclass(frozen=True)
class TargetRecord:
    """What a relative error takes; None if it is not reached: `why` says how near the last count comes, in `low` seconds.

    unless  what was not seen and would make it longer: a bias of so much, or values too rare to be met
    """

    error: float
    how: Literal["measured", "less-than", "extrapolated", "not-reached", "rises", "never"]
    why: str
    samples: float | None
    seconds: float | None
    low: float
    high: float | None
    unless: Literal["", "bias", "rare"] = ""


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
    unbiased_to: float | None = None
    calls: Literal["independent", "doubtful", "dependent", "stratified"] = "independent"
    options: dict[str, Any] = field(default_factory=dict)
    bias: EstimateRecord | None = None
    variance: Variance | None = None
    times_as_many: float = 1.0
    order: OrderRecord | None = None
    floor: FloorRecord | None = None
    cost: float | None = None
    speed: Speed | None = None


@dataclass(frozen=True)
class SoonestRecord:
    """Who comes to an error in the least time, who may be `beside` it, and who may be sooner and is `waiting` for more samples.

    Of those the `unsure` come to it, but values too rare to be met may hold more of the error.
    """

    name: str
    how: str
    seconds: float
    unless: Literal["", "bias", "rare"] = ""
    beside: tuple[str, ...] = ()
    waiting: tuple[str, ...] = ()
    unsure: tuple[str, ...] = ()


@dataclass(frozen=True)
class ErrorReached:
    """Who is soonest to a relative error, of `all` and of the `unbiased`; None where nobody comes."""

    error: float
    all: SoonestRecord | None = None
    unbiased: SoonestRecord | None = None


@dataclass(frozen=True)
class Answer:
    """Which estimator to take, in words, one sentence a line; both names are of the soonest to the first target's error.

    notes  the sentences that say more than `soonest`
    """

    best: str | None
    best_unbiased: str | None
    text: str
    ranking: tuple[str, ...] = ()
    unranked: tuple[str, ...] = ()
    soonest: tuple[ErrorReached, ...] = ()
    notes: tuple[str, ...] = ()
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
class TimeChange(EstimateRecord):
    """A ratio of times; a change by the factor `resolution` would have been said."""

    resolution: float | None = None


@dataclass(frozen=True)
class Change:
    """What became of an estimator since an earlier run; time and variance are ratios after / before.

    worse  biased, or slower or noisier without as much the better for it
    """

    scene: str
    estimator: str
    became: tuple[str, ...]
    time: TimeChange | None = None
    variance: EstimateRecord | None = None
    worse: bool = False


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
    against: Literal["fixed-work", "each-other", "nothing"] = "each-other"


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
    mixed_environments: bool = False
    advice: str = ""
    history: History | None = None
    state: Literal["finished", "interrupted"] = "finished"
