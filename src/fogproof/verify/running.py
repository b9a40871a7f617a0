"""Running cases: each inside its share of one false-alarm budget, and none at the cost of another's result."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from typing import Any

from fogproof.catalogue import Case
from fogproof.checks.limits import UnstartedError, end_isolated, isolated
from fogproof.checks.streams import batch_generator
from fogproof.errors import FogproofError, NotInstalledError, is_stop
from fogproof.verify.elsewhere import Elsewhere, case_of
from fogproof.verify.results import Result, TwinResult, status_of
from fogproof.verify.selection import shares, whole

_PACKAGES = {"mitsuba": ("Mitsuba 3", "mitsuba"), "miepython": ("miepython", "mie")}
"""Name and extra of each module that a case may need."""
_LOOK = 0.1
"""Seconds between looks for processes to be ended, when a run is given up."""
_TWIN_SAMPLES = 20_000
"""A planted error is gross: most twins are rejected by so few samples. Those that are not get all that their case has."""


def run(
    cases: list[Case],
    *,
    seed: int,
    alpha: float,
    workers: int,
    twins: bool = False,
    time_limit: float | None = None,
    elsewhere: Elsewhere | None = None,
) -> Iterator[Result]:
    """Run cases on threads, yielding each result as it is ready; with `twins`, the broken twin of each as well.

    A case's share of alpha is set by the weights of the whole catalogue, file or package it is from, whichever cases are run:
    choosing some of them does not change any verdict. Its random numbers depend on `seed` and its name alone: neither do the
    workers. Cases of a file or a package run in a process of their own, and the catalogue's as well if there is a limit.

    Where no process can be started for a case, the others are run all the same; then comes the `UnstartedError`.

    time_limit  most seconds a case may take, None for any
    elsewhere   who draws for samplers of many samples, one case after another
    """
    parts = shares(cases, alpha)
    totals = {origin: sum(case.weight for case in whole(origin)) for origin in parts}
    pool, one = ThreadPoolExecutor(max_workers=workers), ThreadPoolExecutor(max_workers=1)
    jobs: list[Future[Result]] = []
    try:
        for case in cases:
            share = parts[case.origin] * case.weight / totals[case.origin]
            drawn = elsewhere if elsewhere is not None and elsewhere.draws_for(case) else None
            if case.origin or time_limit is not None or drawn is not None:
                jobs.append(
                    (one if drawn else pool).submit(run_case_alone, case, seed, share, twins, time_limit, drawn)
                )
            else:
                jobs.append(pool.submit(run_case, case, seed, share, twins))
        unstarted: UnstartedError | None = None
        for done in as_completed(jobs):
            try:
                result = done.result()
            except UnstartedError as error:
                unstarted = error
            else:
                yield result
        if unstarted is not None:
            raise unstarted
    finally:
        for each in (pool, one):
            each.shutdown(wait=False, cancel_futures=True)
        while not all(job.done() for job in jobs):  # one that was about to start a process may start it only now
            end_isolated()
            time.sleep(_LOOK)
        for each in (pool, one):
            each.shutdown(wait=True)


def run_case_alone(
    case: Case,
    seed: int,
    alpha: float,
    twins: bool = False,
    time_limit: float | None = None,
    elsewhere: Elsewhere | None = None,
) -> Result:
    """Run one case in a process of its own, so that nothing it does to the process costs another case's result."""
    started = time.perf_counter()
    here = os.getcwd() if case.origin else ""
    try:
        asked = partial(_in_process, here, case.origin, case.name, seed, alpha, twins, elsewhere)
        result: Result = isolated(asked, time_limit)
    except FogproofError as error:
        return Result(case, "error", None, str(error), time.perf_counter() - started)
    return replace(result, case=case)


def _in_process(
    folder: str, origin: str, name: str, seed: int, alpha: float, twins: bool, elsewhere: Elsewhere | None
) -> Any:
    """Run the case of a name; the result goes back without the case, which no pickle can hold."""
    with contextlib.redirect_stdout(sys.stderr):
        case = case_of(folder, origin, name)
        return replace(run_case(case, seed, alpha, twins, elsewhere), case=None)  # type: ignore[arg-type]


def run_case(case: Case, seed: int, alpha: float, twins: bool = False, elsewhere: Elsewhere | None = None) -> Result:
    """Run one case; whatever goes wrong in it is its result, never the end of the run."""
    result = _run_subject(case, seed, alpha, elsewhere)
    again = twins and case.twin is not None and result.status != "skipped"
    return replace(result, twin=run_twin(case, seed, alpha)) if again else result


def run_twin(case: Case, seed: int, alpha: float) -> TwinResult:
    """Put the broken twin of a case to the same checks, inside the same false-alarm probability."""
    started = time.perf_counter()
    few = min(_TWIN_SAMPLES, case.samples)
    try:
        verdict = case.run(alpha, case_seed(seed, case.name), few, twin=True)
        if verdict.outcome != "rejected" and few < case.samples:
            verdict = case.run(alpha, case_seed(seed, case.name), twin=True)
    except BaseException as error:  # the same as of a subject: a defect of one twin is its own result
        if _ends_all(error):
            raise
        return TwinResult("error", seconds=time.perf_counter() - started, reason=f"{type(error).__name__}: {error}")
    rejecting = [finding for finding in verdict.findings if finding.outcome == "rejected"]
    return TwinResult(
        verdict.outcome,
        tuple(finding.check for finding in rejecting),
        verdict.cause,
        min((finding.p_value for finding in rejecting if finding.p_value is not None), default=None),
        verdict.samples,
        time.perf_counter() - started,
    )


def _run_subject(case: Case, seed: int, alpha: float, elsewhere: Elsewhere | None) -> Result:
    started = time.perf_counter()
    try:
        if case.needs and importlib.util.find_spec(case.needs) is None:
            raise NotInstalledError(*_PACKAGES[case.needs])
        own = case_seed(seed, case.name)
        verdict = case.run(alpha, own) if elsewhere is None else elsewhere.verdict(case, alpha, own)
    except NotInstalledError as error:
        return Result(case, "skipped", None, str(error), time.perf_counter() - started)
    except FogproofError as error:
        return Result(case, "error", None, str(error), time.perf_counter() - started)
    except BaseException as error:  # a defect of a case must not cost the other cases' results
        if _ends_all(error):
            raise
        return Result(case, "error", None, f"{type(error).__name__}: {error}", time.perf_counter() - started)
    return Result(case, status_of(verdict.outcome, case.expected), verdict, case.reason, time.perf_counter() - started)


def _ends_all(error: BaseException) -> bool:
    """Whether an error is no case's: a signal, or a module in another's place that asks for the end."""
    return is_stop(error) or isinstance(error, SystemExit)


def case_seed(seed: int, name: str) -> int:
    """Return the seed of a case: no two cases of a run share random numbers."""
    return int(batch_generator(seed, name, 0, 0).integers(2**63))
