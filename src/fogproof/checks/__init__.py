"""The checks: is a sampler's density right, is an estimator's mean? They know neither scenes nor what they judge."""

from fogproof.checks.compare import compare_estimators
from fogproof.checks.estimator import check_estimator
from fogproof.checks.limits import within
from fogproof.checks.reciprocity import check_reciprocity
from fogproof.checks.sampler import SamplerCheck, check_sampler
from fogproof.checks.streams import batch_generator, batch_sizes, fresh_seed
from fogproof.checks.subject import Subject
from fogproof.checks.tally import Tally
from fogproof.checks.verdict import (
    Finding,
    InconclusiveError,
    Interval,
    Outcome,
    RejectedError,
    Resolution,
    Verdict,
    jsonable,
)

__all__ = [
    "Finding",
    "InconclusiveError",
    "Interval",
    "Outcome",
    "RejectedError",
    "Resolution",
    "SamplerCheck",
    "Subject",
    "Tally",
    "Verdict",
    "batch_generator",
    "batch_sizes",
    "check_estimator",
    "check_reciprocity",
    "check_sampler",
    "compare_estimators",
    "fresh_seed",
    "jsonable",
    "within",
]
