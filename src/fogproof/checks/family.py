"""`check_family`: is a sampler or an estimator right for every parameter, and which is the simplest it is wrong for?

Hypothesis proposes parameters, simple and extreme ones first. All of them get a few samples; the eighth that looks most doubtful
gets eight times as many in the next round, and so on (successive halving; Karnin, Koren & Somekh 2013, who halve: eighths find as
much, and give every member more in a third of the rounds). A rejection ends the search, and Hypothesis shrinks: it looks for the
simplest parameter that is still rejected. Every check of the search has its own share of one false-alarm probability.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Iterable
from typing import Any

from fogproof.checks.family_search import NO_IDEA, Doubt, Search, doubt_of, most_doubtful
from fogproof.checks.family_verdict import verdict_of
from fogproof.checks.streams import fresh_seed
from fogproof.checks.verdict import Verdict
from fogproof.errors import InvalidValueError, NotInstalledError
from fogproof.validate import number

_SHRINKING = 200
"""Parameters that are tried to make a rejected one simpler."""

_KEPT = 8  # one of so many goes on to the next round
_ENOUGH = 1000  # samples of a member in a first round that another may follow
_LEAST = 100  # samples of a member


class _FalsifiedError(Exception):
    """Tells Hypothesis that a parameter is rejected."""


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
    members     how many parameters are tried; of a list, all are
    samples     most samples of the search, 100 for each member at least; shrinking may take as many again
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
    search = Search(make, options, fresh_seed() if seed is None else seed, samples)
    listed = list(parameters) if isinstance(parameters, Iterable) else None
    if listed == []:
        raise InvalidValueError("parameters", "must not be empty", parameters)
    tried = members if listed is None else len(listed)
    if samples < _LEAST * tried:
        raise InvalidValueError(
            "samples", f"must be at least {_LEAST * tried}, {_LEAST} for each of {tried} members", samples
        )
    if listed is not None:
        _among(search, listed, samples, alpha)
    else:
        _by_hypothesis(search, parameters, members, samples, alpha)
    return verdict_of(search, alpha, time.perf_counter() - started)


def _rounds(members: int, samples: int, alpha: float) -> list[tuple[int, int, float]]:
    """Return (members kept, samples of each, alpha of each check) of the rounds; each round has an equal part of the samples.

    Half of alpha is for the rounds, half for shrinking.
    """
    count = max(1, math.ceil(math.log(members, _KEPT)))
    count = min(count, max(1, samples // (_ENOUGH * members)))
    kept = [max(1, members // _KEPT**r) for r in range(count)]
    return [(k, samples // (count * k), alpha / (2 * count * k)) for k in kept]


def _among(search: Search, parameters: list[Any], samples: int, alpha: float) -> None:
    """Try a list, simple parameters first: a round with a rejection is the last, and the first one rejected is the simplest."""
    doubt: dict[int, Doubt] = dict.fromkeys(range(len(parameters)), NO_IDEA)
    for kept, each, share in _rounds(len(parameters), samples, alpha):
        chosen = sorted(most_doubtful(doubt, kept))
        verdicts = {i: search.judge(parameters[i], each, share) for i in chosen}
        doubt = {i: doubt_of(verdict) for i, verdict in verdicts.items()}
        wrong = [i for i, verdict in verdicts.items() if verdict.outcome == "rejected"]
        if wrong:
            search.simplest = (parameters[wrong[0]], verdicts[wrong[0]])
            return


def _by_hypothesis(search: Search, strategy: Any, members: int, samples: int, alpha: float) -> None:
    try:
        import hypothesis
    except ImportError:
        raise NotInstalledError("Hypothesis", "hypothesis") from None
    doubt: dict[int, Doubt] | None = None
    for kept, each, share in _rounds(members, samples, alpha):
        chosen = None if doubt is None else set(most_doubtful(doubt, kept))
        doubt = _round(hypothesis, search, strategy, members, chosen, each, share, alpha / (2 * _SHRINKING))
        if search.simplest is not None:
            return


def _round(
    hypothesis: Any,
    search: Search,
    strategy: Any,
    members: int,
    chosen: set[int] | None,
    each: int,
    share: float,
    shrink: float,
) -> dict[int, Doubt]:
    """Let Hypothesis propose its parameters, the same in each round, and check those that are chosen; return their doubts.

    After a rejection what it proposes are simpler parameters. Each of those is checked, at a share of its own.
    """
    doubt: dict[int, Doubt] = {}
    count = [0, 0]

    def trial(parameter: Any) -> None:
        if search.simplest is None:
            index = count[0]
            count[0] += 1
            if chosen is not None and index not in chosen:
                return
            verdict = search.judge(parameter, each, share)
            doubt[index] = doubt_of(verdict)
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
