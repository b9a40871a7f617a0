"""The checks: is a sampler's density right, is an estimator's mean? They know neither scenes nor what they judge."""

from fogproof.checks.estimator import check_estimator
from fogproof.checks.sampler import check_sampler
from fogproof.checks.streams import batch_generator, batch_sizes, fresh_seed
from fogproof.checks.verdict import Finding, Interval, Outcome, RejectedError, Resolution, Verdict, jsonable

__all__ = [
    "Finding",
    "Interval",
    "Outcome",
    "RejectedError",
    "Resolution",
    "Verdict",
    "batch_generator",
    "batch_sizes",
    "check_estimator",
    "check_sampler",
    "fresh_seed",
    "jsonable",
]
