"""`check_family`: is a sampler or an estimator right for every parameter, and which is the simplest it is wrong for?

Hypothesis proposes parameters, simple and extreme ones first. All of them get a few samples; the half that looks most doubtful gets
twice as many in the next round, and so on (successive halving; Karnin, Koren & Somekh 2013). A rejection ends the search, and
Hypothesis shrinks: it looks for the simplest parameter that is still rejected. Every check of the search has its own share of one
false-alarm probability.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
import numbers
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from fogproof.checks.estimator import check_estimator
from fogproof.checks.sampler import check_sampler
from fogproof.checks.streams import fresh_seed
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Outcome, Verdict
from fogproof.errors import FogproofError, InvalidValueError, NotInstalledError
from fogproof.validate import number

_SHRINKING = 200
"""Parameters that are tried to make a rejected one simpler."""


class _FalsifiedError(Exception):
    """Tells Hypothesis that a parameter is rejected."""


@dataclass
class _Search:
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
            verdict = _failed(error, alpha, samples, seed)
        self.tried[repr(parameter)] = (parameter, verdict)
        if verdict.outcome == "rejected":
            self.simplest = (parameter, verdict)
        return verdict


def check_family(
    make: Callable[[Any], Any],
    parameters: Any,
    *,
    members: int = 64,
    samples: int = 10_000_000,
    alpha: float = 1e-6,
    seed: int | None = None,
    **options: Any,
) -> Verdict:
    """Test a sampler or an estimator at many parameters; if it is wrong for some, return the simplest one and where they lie.

    make        parameter -> a sampler (`sample`, `pdf`, `domain`, `dimensions`; `atoms`, `eval`) or an estimator (`draw`,
                `reference`); a dict `options` of either holds further arguments of its check
    parameters  a Hypothesis strategy, or a sequence of parameters, simple ones first
    members     how many parameters are tried
    samples     most samples of the search; shrinking may take as many again
    alpha       false-alarm probability of the whole search
    options     further arguments of `check_sampler` or `check_estimator`, the same for all members

    Needs Hypothesis for strategies: python -m pip install 'fogproof[hypothesis]'.

    >>> import numpy as np, fogproof
    >>> class Exponential:
    ...     domain, dimensions = fogproof.HalfLine(0.0), 1
    ...     def __init__(self, sigma):
    ...         self.sigma = sigma
    ...     def sample(self, u):
    ...         return -np.log1p(-u[:, 0]) / max(self.sigma, 0.5)  # a guard that should not be there
    ...     def pdf(self, t):
    ...         return self.sigma * np.exp(-self.sigma * t)
    >>> verdict = fogproof.check_family(Exponential, [4.0, 2.0, 1.0, 0.5, 0.25, 0.125], samples=600_000, seed=1)
    >>> verdict.outcome, verdict.findings[0].message
    ('rejected', 'wrong at 0.25, the simplest of 2 rejected; not rejected for parameter >= 0.5, rejected for parameter <= 0.25')
    """
    number("alpha", alpha, "must lie in (0, 1)", 0, 1, open_ends=True)
    if not callable(make):
        raise InvalidValueError("make", "must be a function or class: parameter -> sampler or estimator", make)
    members, samples = (int(number(n, v, "must be >= 1", 1)) for n, v in (("members", members), ("samples", samples)))
    started = time.perf_counter()
    search = _Search(make, options, fresh_seed() if seed is None else seed, samples, samples)
    if isinstance(parameters, Iterable):
        listed = list(parameters)
        if not listed:
            raise InvalidValueError("parameters", "must not be empty", parameters)
        _among(search, listed, samples, alpha)
    else:
        _by_hypothesis(search, parameters, members, samples, alpha)
    return _verdict(search, alpha, time.perf_counter() - started)


def _rounds(members: int, samples: int, alpha: float) -> list[tuple[int, int, float]]:
    """Return (members kept, samples of each, alpha of each check) of the rounds; each round has an equal part of the samples.

    Half of alpha is for the rounds, half for shrinking.
    """
    count = max(1, math.ceil(math.log2(members)))
    kept = [max(1, members >> r) for r in range(count)]
    return [(k, max(1000, samples // (count * k)), alpha / (2 * count * k)) for k in kept]


def _among(search: _Search, parameters: list[Any], samples: int, alpha: float) -> None:
    """Try a list, simple parameters first: a round with a rejection is the last, and the first one rejected is the simplest."""
    doubt = dict.fromkeys(range(len(parameters)), 0.0)
    for kept, each, share in _rounds(len(parameters), samples, alpha):
        chosen = sorted(_most_doubtful(doubt, kept))
        verdicts = {i: search.judge(parameters[i], each, share) for i in chosen}
        doubt = {i: _doubt(verdict) for i, verdict in verdicts.items()}
        wrong = [i for i, verdict in verdicts.items() if verdict.outcome == "rejected"]
        if wrong:
            search.simplest = (parameters[wrong[0]], verdicts[wrong[0]])
            return


def _by_hypothesis(search: _Search, strategy: Any, members: int, samples: int, alpha: float) -> None:
    try:
        import hypothesis
    except ImportError:
        raise NotInstalledError("Hypothesis", "hypothesis") from None
    doubt: dict[int, float] | None = None
    for kept, each, share in _rounds(members, samples, alpha):
        chosen = None if doubt is None else set(_most_doubtful(doubt, kept))
        doubt = _round(hypothesis, search, strategy, members, chosen, each, share, alpha / (2 * _SHRINKING))
        if search.simplest is not None:
            return


def _round(
    hypothesis: Any,
    search: _Search,
    strategy: Any,
    members: int,
    chosen: set[int] | None,
    each: int,
    share: float,
    shrink: float,
) -> dict[int, float]:
    """Let Hypothesis propose its parameters, the same in each round, and check those that are chosen; return their doubts.

    After a rejection what it proposes are simpler parameters. Each of those is checked, at a share of its own.
    """
    doubt: dict[int, float] = {}
    count = [0, 0]

    def trial(parameter: Any) -> None:
        if search.simplest is None:
            index = count[0]
            count[0] += 1
            if chosen is not None and index not in chosen:
                return
            verdict = search.judge(parameter, each, share)
            doubt[index] = _doubt(verdict)
        elif repr(parameter) in search.tried:  # Hypothesis runs what it has found once more
            verdict = search.tried[repr(parameter)][1]
        elif count[1] >= _SHRINKING:
            return
        else:
            count[1] += 1
            verdict = search.judge(parameter, each, shrink)
        if verdict.outcome == "rejected":
            search.simplest = (parameter, verdict)
            raise _FalsifiedError

    settings = hypothesis.settings(
        max_examples=members,
        database=None,
        deadline=None,
        derandomize=False,
        report_multiple_bugs=False,
        phases=(hypothesis.Phase.generate, hypothesis.Phase.shrink),
        suppress_health_check=list(hypothesis.HealthCheck),
        verbosity=hypothesis.Verbosity.quiet,
    )
    try:
        with contextlib.suppress(_FalsifiedError, hypothesis.errors.Flaky):
            hypothesis.seed(search.seed)(settings(hypothesis.given(strategy)(trial)))()
    except (hypothesis.errors.InvalidArgument, hypothesis.errors.Unsatisfiable) as error:
        rule = f"must be a Hypothesis strategy that gives parameters, or a sequence of them; it says: {error}"
        raise InvalidValueError("parameters", rule, strategy) from None
    return doubt


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
    finding = Finding("contract", "rejected", f"{type(error).__name__}: {error}", alpha=0.0)
    return Verdict((finding,), alpha, samples, seed, cause="contract")


def _doubt(verdict: Verdict) -> float:
    """Return how well a member does: the smallest of p / share over its findings; small is doubtful."""
    ratios = [f.p_value / f.alpha for f in verdict.findings if f.p_value is not None and f.alpha]
    return min(ratios, default=math.inf) if verdict.outcome != "inconclusive" else 0.0


def _most_doubtful(doubt: dict[int, float], kept: int) -> list[int]:
    return [i for _, i in sorted((value, i) for i, value in doubt.items())][:kept]


def _verdict(search: _Search, alpha: float, seconds: float) -> Verdict:
    tried = list(search.tried.values())
    drawn = sum(verdict.samples for _, verdict in tried)
    if search.simplest is not None:
        parameter, found = search.simplest
        wrong = sum(verdict.outcome == "rejected" for _, verdict in tried)
        message = f"wrong at {parameter!r}, the simplest of {wrong} rejected{_where(tried)}"
        p = min((f.p_value for f in found.findings if f.outcome == "rejected" and f.p_value is not None), default=None)
        family = Finding("family", "rejected", message, p, alpha, cause=found.cause)
        return replace(
            found,
            findings=(family, *found.findings),
            alpha=alpha,
            samples=drawn,
            seed=search.seed,
            seconds=seconds,
            settings={**found.settings, "parameter": repr(parameter)},
        )
    unsure = [(parameter, verdict) for parameter, verdict in tried if verdict.outcome == "inconclusive"]
    least = min(verdict.samples for _, verdict in tried)
    most = max(verdict.samples for _, verdict in tried)
    message = f"{len(tried)} parameters, {least} samples each, {most} where doubt was greatest"
    if unsure:
        message += f"; no decision at {len(unsure)} of them. {_why(*unsure[0], search.budget)}"
    worst = max(
        (verdict.resolution for _, verdict in tried if verdict.resolution is not None),
        key=lambda r: r.value,
        default=None,
    )
    outcome: Outcome = "inconclusive" if unsure else "not rejected"
    finding = Finding("family", outcome, message, alpha=alpha, resolution=worst)
    return Verdict((finding,), alpha, drawn, search.seed, seconds)


def _why(parameter: Any, verdict: Verdict, budget: int) -> str:
    """Return what one member lacks for a decision, in its own words, and how much of the search it has to get."""
    reason = next(f.message for f in verdict.findings if f.outcome == "inconclusive")
    share = (
        f"it got 1 / {budget / verdict.samples:.3g} of samples={budget}; with more, each member gets as many times more"
    )
    return f"At {parameter!r}, with {verdict.samples}: {reason}. {share[0].upper()}{share[1:]}"


def _where(tried: list[tuple[Any, Verdict]]) -> str:
    """Return on which side of which number the rejected parameters lie, if one number tells them apart."""
    rows = [(_coordinates(parameter), verdict.outcome == "rejected") for parameter, verdict in tried]
    if not all(row for row, _ in rows) or len({tuple(row) for row, _ in rows}) > 1:
        return ""
    for name in rows[0][0]:
        wrong = [row[name] for row, bad in rows if bad]
        right = [row[name] for row, bad in rows if not bad]
        if right and max(wrong) < min(right):
            return f"; not rejected for {name} >= {min(right):g}, rejected for {name} <= {max(wrong):g}"
        if right and min(wrong) > max(right):
            return f"; not rejected for {name} <= {max(right):g}, rejected for {name} >= {min(wrong):g}"
    return ""


def _coordinates(parameter: Any) -> dict[str, float]:
    """Return the numbers a parameter is made of, by name."""
    if isinstance(parameter, numbers.Real):
        return {"parameter": float(parameter)}
    if isinstance(parameter, Mapping):
        named = {str(key): value for key, value in parameter.items()}
    elif isinstance(parameter, tuple):
        named = {f"parameter[{i}]": value for i, value in enumerate(parameter)}
    else:
        named = {key: value for key, value in getattr(parameter, "__dict__", {}).items() if not key.startswith("_")}
    return {key: float(value) for key, value in named.items() if isinstance(value, numbers.Real)}
