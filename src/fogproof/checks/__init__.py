"""The checks: is a sampler's density right, is an estimator's mean? They know neither scenes nor what they judge.

Whatever `__all__` names is public as `fogproof.<name>` too; it loads when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fogproof.checks.bound import check_bound
    from fogproof.checks.compare import compare_estimators
    from fogproof.checks.convergence import check_convergence
    from fogproof.checks.estimator import check_estimator
    from fogproof.checks.family import check_family
    from fogproof.checks.generators import check_streams
    from fogproof.checks.json_values import jsonable as jsonable
    from fogproof.checks.limits import within as within
    from fogproof.checks.mis import check_mis
    from fogproof.checks.planning import samples_for
    from fogproof.checks.reciprocity import check_reciprocity
    from fogproof.checks.sampler import check_sampler, sampler_check
    from fogproof.checks.sampler_parts import SamplerCheck
    from fogproof.checks.streams import batch_generator as batch_generator
    from fogproof.checks.streams import batch_sizes as batch_sizes
    from fogproof.checks.streams import fresh_seed
    from fogproof.checks.subject import Subject as Subject
    from fogproof.checks.tally import Tally as Tally
    from fogproof.checks.verdict import (
        EffectInterval,
        Finding,
        InconclusiveError,
        Outcome,
        RejectedError,
        Resolution,
        Verdict,
    )

__all__ = [
    "EffectInterval",
    "Finding",
    "InconclusiveError",
    "Outcome",
    "RejectedError",
    "Resolution",
    "SamplerCheck",
    "Verdict",
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
    "sampler_check",
    "samples_for",
]

_HOMES = {
    "EffectInterval": "verdict",
    "Finding": "verdict",
    "InconclusiveError": "verdict",
    "Outcome": "verdict",
    "RejectedError": "verdict",
    "Resolution": "verdict",
    "SamplerCheck": "sampler_parts",
    "Subject": "subject",
    "Tally": "tally",
    "Verdict": "verdict",
    "batch_generator": "streams",
    "batch_sizes": "streams",
    "check_streams": "generators",
    "compare_estimators": "compare",
    "fresh_seed": "streams",
    "jsonable": "verdict",
    "sampler_check": "sampler",
    "samples_for": "planning",
    "within": "limits",
}
"""The modules of what is not in the module of its name, as `check_mis` is in `mis`; also of what only other rooms ask for."""


def __getattr__(name: str) -> Any:
    if name not in __all__ and name not in _HOMES:
        raise AttributeError(f"module 'fogproof.checks' has no attribute {name!r}")
    home = _HOMES.get(name, name.removeprefix("check_"))
    return getattr(importlib.import_module(f"fogproof.checks.{home}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
