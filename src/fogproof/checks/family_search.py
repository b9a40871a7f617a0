"""What a search through a family has tried: one member judged, and which members are the most doubtful."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from fogproof.checks.estimator import check_estimator
from fogproof.checks.sampler import check_sampler
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Verdict
from fogproof.errors import FogproofError, InvalidValueError


@dataclass
class Search:
    """What has been tried of a family."""

    make: Callable[[Any], Any]
    options: Mapping[str, Any]
    seed: int
    budget: int
    left: int
    tried: dict[str, tuple[Any, Verdict]] = field(default_factory=dict)
    simplest: tuple[Any, Verdict] | None = None

    def judge(self, parameter: Any, samples: int, alpha: float) -> Verdict:
        """Check the member with one parameter; the same seed for the same parameter, so that a search can be repeated."""
        self.left -= samples
        words = f"{self.seed}/{parameter!r}/{samples}".encode()
        seed = int.from_bytes(hashlib.blake2b(words, digest_size=7).digest(), "little")
        try:
            verdict = _check(call("make(parameter)", self.make, parameter), samples, alpha, seed, self.options)
        except FogproofError as error:
            if isinstance(error, InvalidValueError) and error.argument in self.options:
                raise  # said of all members alike: nobody's fault but the caller's
            verdict = _failed(error, alpha, samples, seed)
        self.tried[repr(parameter)] = (parameter, verdict)
        if verdict.outcome == "rejected":
            self.simplest = (parameter, verdict)
        return verdict


def _check(member: Any, samples: int, alpha: float, seed: int, options: Mapping[str, Any]) -> Verdict:
    if hasattr(member, "draw"):
        if not hasattr(member, "reference"):
            raise InvalidValueError("make", "must return estimators that have a `reference`", type(member).__name__)
        more = {**getattr(member, "options", {}), **options}
        return check_estimator(member.draw, member.reference, samples=samples, alpha=alpha, seed=seed, **more)
    lacking = [name for name in ("sample", "pdf", "domain", "dimensions") if not hasattr(member, name)]
    if lacking:
        rule = "must return estimators (draw, reference) or samplers (sample, pdf, domain, dimensions)"
        raise InvalidValueError("make", f"{rule}; {lacking[0]} is missing", type(member).__name__)
    own = {name: getattr(member, name) for name in ("atoms", "eval") if getattr(member, name, None) is not None}
    return check_sampler(
        member.sample,
        member.pdf,
        member.domain,
        dimensions=member.dimensions,
        samples=samples,
        alpha=alpha,
        seed=seed,
        **{**own, **getattr(member, "options", {}), **options},
    )


def _failed(error: FogproofError, alpha: float, samples: int, seed: int) -> Verdict:
    """A member that raises or breaks its contract is wrong at this parameter."""
    cause = getattr(error, "cause", "contract")
    finding = Finding("contract", "rejected", str(error), alpha=0.0, cause=cause)
    return Verdict((finding,), alpha, samples, seed, cause=cause)


def doubt_of(verdict: Verdict) -> float:
    """Return how well a member does: the smallest of p / share over its findings; small is doubtful."""
    ratios = [f.p_value / f.alpha for f in verdict.findings if f.p_value is not None and f.alpha]
    return min(ratios, default=math.inf) if verdict.outcome != "inconclusive" else 0.0


def most_doubtful(doubt: dict[int, float], kept: int) -> list[int]:
    """Return the numbers of the `kept` members whose doubt is smallest."""
    return [i for _, i in sorted((value, i) for i, value in doubt.items())][:kept]
