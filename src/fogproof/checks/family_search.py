"""What a search through a family has tried: one member judged, and which members are the most doubtful."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from inspect import signature
from typing import Any

from fogproof.checks.estimator import check_estimator
from fogproof.checks.sampler import check_sampler, sampler_check
from fogproof.checks.sampler_parts import explained
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Verdict
from fogproof.doing import on_behalf_of
from fogproof.errors import FogproofError, InvalidValueError, shorten

Doubt = tuple[bool, float]
"""What members are sorted by, the doubtful ones first."""

NO_IDEA: Doubt = (False, 0.0)
_HARDLY = 100.0  # times its share of alpha: a p-value below that is nothing to pass by

_GIVEN = {"draw", "reference", "sample", "pdf", "domain", "dimensions", "atoms", "eval"}  # by a member
_OPTIONS = {*signature(check_estimator).parameters, *signature(check_sampler).parameters} - _GIVEN


@dataclass
class Search:
    """What has been tried of a family."""

    make: Callable[[Any], Any]
    options: Mapping[str, Any]
    seed: int
    budget: int
    drawn: int = 0
    tried: dict[str, tuple[Any, Verdict]] = field(default_factory=dict)
    explaining: dict[str, Callable[[Verdict], Verdict]] = field(default_factory=dict)
    simplest: tuple[Any, Verdict] | None = None

    def judge(self, parameter: Any, samples: int, alpha: float) -> Verdict:
        """Check the member with one parameter; the same seed for the same parameter, so that a search can be repeated."""
        words = f"{self.seed}/{parameter!r}/{samples}".encode()
        seed = int.from_bytes(hashlib.blake2b(words, digest_size=7).digest(), "little")
        try:
            with on_behalf_of(f"{len(self.tried) + 1}. {shorten(parameter)}"):
                member = call("make(parameter)", self.make, parameter)
                verdict, self.explaining[repr(parameter)] = _check(member, samples, alpha, seed, self.options)
        except FogproofError as error:
            if isinstance(error, InvalidValueError) and self._of_the_caller(error):
                raise
            verdict = _failed(error, alpha, seed)
        self.drawn += verdict.samples
        self.tried[repr(parameter)] = (parameter, verdict)
        if verdict.outcome == "rejected":
            self.simplest = (parameter, verdict)
        return verdict

    def explained(self, parameter: Any, verdict: Verdict) -> Verdict:
        """Return the verdict on a member with its cause, which is looked for where the search ends, and not on its way."""
        with on_behalf_of(shorten(parameter)):
            return self.explaining.get(repr(parameter), _as_it_is)(verdict)

    def _of_the_caller(self, error: InvalidValueError) -> bool:
        """Return whether all members alike are refused: by an option, by one that an option lacks, or for what `make` makes."""
        if error.argument == "make":
            return not self.tried
        return bool(self.options) and error.argument in _OPTIONS


def _as_it_is(verdict: Verdict) -> Verdict:
    return verdict


def _check(
    member: Any, samples: int, alpha: float, seed: int, options: Mapping[str, Any]
) -> tuple[Verdict, Callable[[Verdict], Verdict]]:
    """Return the verdict on a member, and what finds the cause of a rejection."""
    if hasattr(member, "draw"):
        if not hasattr(member, "reference"):
            raise InvalidValueError("make", "must return estimators that have a `reference`", type(member).__name__)
        more = {**getattr(member, "options", {}), **options}
        return check_estimator(
            member.draw, member.reference, samples=samples, alpha=alpha, seed=seed, **more
        ), _as_it_is
    lacking = [name for name in ("sample", "pdf", "domain", "dimensions") if not hasattr(member, name)]
    if lacking:
        rule = "must return estimators (draw, reference) or samplers (sample, pdf, domain, dimensions)"
        raise InvalidValueError("make", f"{rule}; {lacking[0]} is missing", type(member).__name__)
    own = {name: getattr(member, name) for name in ("atoms", "eval") if getattr(member, name, None) is not None}
    check = sampler_check(
        member.sample,
        member.pdf,
        member.domain,
        dimensions=member.dimensions,
        samples=samples,
        alpha=alpha,
        seed=seed,
        **{**own, **getattr(member, "options", {}), **options},
    )
    return check.unexplained(), partial(explained, check.prepared.subject)


def _failed(error: FogproofError, alpha: float, seed: int) -> Verdict:
    """A member that raises or breaks its contract is wrong at this parameter, and nobody knows how much it has drawn."""
    cause = getattr(error, "cause", "contract")
    finding = Finding("contract", "rejected", str(error), alpha=0.0, cause=cause)
    return Verdict((finding,), alpha, 0, seed, cause=cause)


def doubt_of(verdict: Verdict) -> Doubt:
    """Return how well a member does: what cannot be told, or hardly passes, comes before all that passes; then the smaller p.

    p is the smallest p / share over the findings. One that is no test yet, for want of samples, has the p of its statistic in units
    of its standard error, or 0 without any: it still says who looks worse.
    """
    undecided = verdict.outcome == "inconclusive"
    ratio = min((_ratio(finding) for finding in verdict.findings if finding.alpha), default=math.inf)
    return (not undecided and ratio > _HARDLY, ratio)


def _ratio(finding: Finding) -> float:
    assert finding.alpha
    if finding.p_value is not None:
        return finding.p_value / finding.alpha
    if finding.outcome != "inconclusive":
        return math.inf
    return 0.0 if finding.statistic is None else math.erfc(abs(finding.statistic) / math.sqrt(2)) / finding.alpha


def most_doubtful(doubt: dict[int, Doubt], kept: int) -> list[int]:
    """Return the numbers of the `kept` members whose doubt comes first."""
    return [i for _, i in sorted((value, i) for i, value in doubt.items())][:kept]
