"""Running the catalogue: every case inside its share of one false-alarm budget, and the record of the run."""

from __future__ import annotations

import contextlib
import difflib
import fnmatch
import importlib.metadata
import importlib.util
import os
import platform
import shlex
import sys
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from fogproof.catalogue import Case, all_cases
from fogproof.catalogue.own import is_file, own_cases, packages
from fogproof.checks import Verdict, batch_generator, jsonable
from fogproof.checks.limits import end_isolated, isolated
from fogproof.errors import FogproofError, InvalidInputError, NotInstalledError
from fogproof.oracle_error import oracle_errors
from fogproof.plan import plan, scene_of

SCHEMA = "fogproof/results/1"
ALPHA = 1e-6
"""False-alarm probability of a run of the whole catalogue, unless told otherwise."""
Status = Literal["passed", "rejected", "inconclusive", "known", "surprise", "skipped", "error"]
_PACKAGES = {"mitsuba": ("Mitsuba 3", "mitsuba"), "miepython": ("miepython", "mie")}
"""Name and extra of each module that a case may need."""
_TWIN_SAMPLES = 20_000
"""A planted error is gross: most twins are rejected by so few samples. Those that are not get all that their case has."""


@dataclass(frozen=True)
class TwinResult:
    """What the checks of a case said of its broken twin, and which of them rejected it; `reason` says why it did not run."""

    outcome: Literal["rejected", "not rejected", "inconclusive", "error"]
    checks: tuple[str, ...] = ()
    cause: str = ""
    p_value: float | None = None
    samples: int = 0
    seconds: float = 0.0
    reason: str = ""


@dataclass(frozen=True)
class Result:
    """What became of one case; `reason` says why it was skipped, failed to run, or is a known finding.

    twin  what became of its broken twin, None if that was not run
    """

    case: Case
    status: Status
    verdict: Verdict | None
    reason: str
    seconds: float
    twin: TwinResult | None = None

    @property
    def good(self) -> bool:
        """Whether the outcome is the expected one, or the case was visibly skipped; and the twin, if run, was rejected."""
        blind = self.twin is not None and self.twin.outcome != "rejected"
        return self.status in ("passed", "known", "skipped") and not blind


def select(patterns: Iterable[str]) -> list[Case]:
    """Return the cases whose name is one of the patterns, begins with one as a folder, or matches it as a glob.

    `my_cases.py` stands for all cases of that file, `my_cases.py::name` for some of them, and the name under which an installed
    package offers cases for the package's. Without patterns: every case of the catalogue that does not ask to be named.
    """
    patterns = list(patterns)
    if not patterns:
        return [case for case in all_cases() if not case.by_name]
    offered = packages()
    chosen: dict[str, Case] = {}
    for pattern in patterns:
        for case in _matching(pattern, offered):
            if chosen.setdefault(case.name, case).origin != case.origin:
                what = f"{case.origin} and {chosen[case.name].origin or 'the catalogue'} both have a case {case.name!r}"
                raise InvalidInputError(f"{what}; rename one of them", pattern)
    origins = sorted({case.origin for case in chosen.values()})
    return [case for origin in origins for case in _whole(origin) if chosen.get(case.name) is case]


def _matching(pattern: str, offered: list[str]) -> list[Case]:
    origin, _, name = pattern.partition("::") if is_file(pattern) else ("", "", pattern)
    if not origin and pattern.partition("/")[0] in offered:
        origin = pattern.partition("/")[0]
    cases = _whole(origin)
    if is_file(pattern):
        prefix = cases[0].name.partition("/")[0]
        name = f"{prefix}/{name}" if name else prefix
    hits = [c for c in cases if c.name == name or c.name.startswith(name.rstrip("/") + "/")]
    hits = hits or [c for c in cases if fnmatch.fnmatchcase(c.name, name)]
    if not hits:
        by_name = {c.name: c for c in cases}
        close = [called(by_name[near]) for near in difflib.get_close_matches(name, by_name, n=3, cutoff=0.4)]
        hint = f"did you mean {', '.join(close)}?" if close else f"'fogproof list {origin}'".replace(" '", "'")
        raise InvalidInputError(f"no case is called {pattern!r}; {hint}{'' if close else ' shows all names'}", pattern)
    return hits


def _whole(origin: str) -> tuple[Case, ...]:
    """Return the catalogue, or all cases of a file or a package."""
    return own_cases(origin) if origin else all_cases()


def called(case: Case) -> str:
    """Return what a user types to name a case."""
    return f"{case.origin}::{case.name.partition('/')[2]}" if is_file(case.origin) else case.name


def shares(cases: Iterable[Case], alpha: float) -> dict[str, float]:
    """Return the part of alpha that the catalogue, a file or a package has in a run of these cases, by its origin.

    A case has its weight's share of that, whichever others of its origin are run.
    """
    weights = {c.origin: sum(case.weight for case in _whole(c.origin)) for c in cases}
    if len(weights) == 1:
        return dict.fromkeys(weights, alpha)
    return {origin: alpha * weight / sum(weights.values()) for origin, weight in weights.items()}


def run(
    cases: list[Case],
    *,
    seed: int,
    alpha: float,
    workers: int,
    twins: bool = False,
    time_limit: float | None = None,
) -> Iterator[Result]:
    """Run cases on threads, yielding each result as it is ready; with `twins`, the broken twin of each as well.

    A case's share of alpha is set by the weights of the whole catalogue, file or package it is from, whichever cases are run:
    choosing some of them does not change any verdict. Its random numbers depend on `seed` and its name alone: neither do the
    workers. Cases of a file or a package run in a process of their own, and the catalogue's as well if there is a limit.

    time_limit  most seconds a case may take, None for any
    """
    parts = shares(cases, alpha)
    totals = {origin: sum(case.weight for case in _whole(origin)) for origin in parts}
    pool = ThreadPoolExecutor(max_workers=workers)
    try:
        jobs = []
        for case in cases:
            share = parts[case.origin] * case.weight / totals[case.origin]
            alone = case.origin or time_limit is not None
            job = partial(run_case_alone, time_limit=time_limit) if alone else run_case
            jobs.append(pool.submit(job, case, seed, share, twins))
        for done in as_completed(jobs):
            yield done.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        end_isolated()
        pool.shutdown(wait=True)


def run_case_alone(case: Case, seed: int, alpha: float, twins: bool = False, time_limit: float | None = None) -> Result:
    """Run one case in a process of its own, so that nothing it does to the process costs another case's result."""
    started = time.perf_counter()
    here = os.getcwd() if case.origin else ""
    try:
        result = isolated(partial(_in_process, here, case.origin, case.name, seed, alpha, twins), time_limit)
    except FogproofError as error:
        return Result(case, "error", None, str(error), time.perf_counter() - started)
    return replace(result, case=case)


def _in_process(folder: str, origin: str, name: str, seed: int, alpha: float, twins: bool) -> Any:
    """Run the case of a name; the result goes back without the case, which no pickle can hold."""
    if folder:
        os.chdir(folder)  # the server of processes began somewhere else, maybe
    with contextlib.redirect_stdout(sys.stderr):
        (case,) = (case for case in _whole(origin) if case.name == name)
        return replace(run_case(case, seed, alpha, twins), case=None)  # type: ignore[arg-type]


def run_case(case: Case, seed: int, alpha: float, twins: bool = False) -> Result:
    """Run one case; whatever goes wrong in it is its result, never the end of the run."""
    result = _run_subject(case, seed, alpha)
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
    except Exception as error:  # the same as of a subject: a defect of one twin is its own result
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


def _run_subject(case: Case, seed: int, alpha: float) -> Result:
    started = time.perf_counter()
    try:
        if case.needs and importlib.util.find_spec(case.needs) is None:
            raise NotInstalledError(*_PACKAGES[case.needs])
        verdict = case.run(alpha, case_seed(seed, case.name))
    except NotInstalledError as error:
        return Result(case, "skipped", None, str(error), time.perf_counter() - started)
    except FogproofError as error:
        return Result(case, "error", None, str(error), time.perf_counter() - started)
    except Exception as error:  # a defect of a case must not cost the other cases' results
        return Result(case, "error", None, f"{type(error).__name__}: {error}", time.perf_counter() - started)
    status: Status
    if verdict.outcome == case.expected:
        status = "passed" if case.expected == "not rejected" else "known"
    elif case.expected != "not rejected":
        status = "surprise"
    else:
        status = "rejected" if verdict.outcome == "rejected" else "inconclusive"
    return Result(case, status, verdict, case.reason, time.perf_counter() - started)


def case_seed(seed: int, name: str) -> int:
    """Return the seed of a case: no two cases of a run share random numbers."""
    return int(batch_generator(seed, name, 0, 0).integers(2**63))


def exit_code(results: Iterable[Result]) -> int:
    """Return 0 if every outcome is as expected, 1 if something was rejected or failed, 3 if something was only inconclusive.

    A broken twin that was not rejected counts as a failure: its checks are blind.
    """
    results = list(results)
    statuses = {result.status for result in results}
    if statuses & {"rejected", "surprise", "error"} or any(r.twin and r.twin.outcome != "rejected" for r in results):
        return 1
    return 3 if "inconclusive" in statuses else 0


def record(
    results: Iterable[Result],
    *,
    seed: int,
    alpha: float,
    command: str,
    started: str,
    seconds: float,
    asked: Iterable[Case] = (),
    stopped: int = 0,
) -> dict[str, Any]:
    """Return the JSON-ready record of a run, cases in the order of the catalogue.

    asked    the cases that were to run; all that have a result by default
    stopped  the exit code of a run that was interrupted, 0 of one that came to its end
    `oracle` in it is the oracle's own error against proven values, measured here and now (a third of a second).
    """
    results, asked = list(results), list(asked)
    origins = sorted({result.case.origin for result in results})
    order = {case.name: i for i, case in enumerate(case for origin in origins for case in _whole(origin))}
    ordered = sorted(results, key=lambda result: order[result.case.name])
    names = [case.name for case in asked] or [result.case.name for result in ordered]
    parts = shares(asked or [result.case for result in ordered], alpha)
    return jsonable(
        {
            "schema": SCHEMA,
            "kind": "verify",
            "fogproof": importlib.metadata.version("fogproof"),
            "environment": environment(),
            "command": command,
            "seed": seed,
            "alpha": alpha,
            "started": started,
            "seconds": seconds,
            "exit_code": stopped or exit_code(ordered),
            "state": "interrupted" if stopped else "finished",
            "title": f"Unfinished: {len(ordered)} of {len(names)}" if len(ordered) < len(names) else "",
            "asked": names,
            "oracle": oracle_errors(),
            "cases": [_case_record(result, seed, parts[result.case.origin]) for result in ordered],
        }
    )


def reproduce(case: Case, seed: int, alpha: float) -> str:
    """Return the command that runs a case again, with the same random numbers and the same verdict.

    alpha  the part of the catalogue, file or package that the case is from, see `shares`
    """
    share = "" if alpha == ALPHA else f" --alpha {alpha:g}" if float(f"{alpha:g}") == alpha else f" --alpha {alpha!r}"
    name = called(case)
    quoted = f"'{name}'" if "'" not in name else shlex.quote(name)
    return f"fogproof verify {quoted} --seed {seed}{share}"


def _case_record(result: Result, seed: int, alpha: float) -> dict[str, Any]:
    case = result.case
    return {
        "name": case.name,
        "title": case.title,
        "kind": case.kind,
        "status": result.status,
        "expected": case.expected,
        "reason": result.reason,
        "source": case.source,
        "reference": f"fogproof.analytic: {case.oracle}"
        if case.reference is not None and not case.origin
        else case.oracle,
        "twin": case.twin.error if case.twin else "",
        "twin_result": result.twin,
        "plan": None if result.verdict is None or case.origin else _plan(case),
        "reproduce": reproduce(case, seed, alpha),
        "seconds": result.seconds,
        "verdict": None if result.verdict is None else result.verdict.to_dict(),
    }


def _plan(case: Case) -> dict[str, Any] | None:
    """Return which terms the case's scene needs, None if it is about no scene."""
    try:
        scene = scene_of(case.make())
        return None if scene is None else plan(scene).to_dict()
    except Exception:  # results are worth more than what is said beside them
        return None


def environment() -> dict[str, Any]:
    """Return the versions and the machine that a record names."""
    versions = {"python": platform.python_version(), "numpy": np.__version__}
    for package in ("scipy", "mitsuba"):
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "not installed"
    return {**versions, "platform": platform.platform(terse=True), "cores": os.cpu_count()}
