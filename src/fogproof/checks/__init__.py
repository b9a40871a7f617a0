"""The checks: is a sampler's density right, is an estimator's mean? They know neither scenes nor what they judge."""

from fogproof.checks.bound import check_bound
from fogproof.checks.compare import compare_estimators
from fogproof.checks.convergence import check_convergence
from fogproof.checks.estimator import check_estimator
from fogproof.checks.family import check_family
from fogproof.checks.generators import check_streams
from fogproof.checks.limits import within
from fogproof.checks.mis import check_mis
from fogproof.checks.planning import samples_for
from fogproof.checks.reciprocity import check_reciprocity
from fogproof.checks.sampler import SamplerCheck, check_sampler
from fogproof.checks.streams import batch_generator, batch_sizes, fresh_seed
from fogproof.checks.subject import Subject
from fogproof.checks.tally import Tally
from fogproof.checks.verdict import (
    EffectInterval,
    Finding,
    InconclusiveError,
    Outcome,
    RejectedError,
    Resolution,
    Verdict,
    jsonable,
)

__all__ = [
    "EffectInterval",
    "Finding",
    "InconclusiveError",
    "Outcome",
    "RejectedError",
    "Resolution",
    "SamplerCheck",
    "Subject",
    "Tally",
    "Verdict",
    "batch_generator",
    "batch_sizes",
    "check_bound",
    "check_convergence",
    "check_estimator",
    "check_family",
    "check_mis",
    "check_reciprocity",
    "check_sampler",
    "check_streams",
    "compare_estimators",
    "fresh_seed",
    "jsonable",
    "samples_for",
    "within",
]
