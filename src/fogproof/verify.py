"""Running the catalogue: every case inside its share of one false-alarm budget, and the record of the run."""

from __future__ import annotations

import difflib
import fnmatch
import importlib.metadata
import importlib.util
import os
import platform
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from fogproof.catalogue import Case, all_cases
from fogproof.checks import Verdict, batch_generator, jsonable
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

    Without patterns: every case that does not ask to be named.
    """
    patterns = list(patterns)
    cases = all_cases()
    chosen: dict[str, Case] = {}
    for pattern in patterns:
        hits = [c for c in cases if c.name == pattern or c.name.startswith(pattern.rstrip("/") + "/")]
        hits = hits or [c for c in cases if fnmatch.fnmatchcase(c.name, pattern)]
        if not hits:
            close = difflib.get_close_matches(pattern, [c.name for c in cases], n=3, cutoff=0.4)
            hint = f"did you mean {', '.join(close)}?" if close else "'fogproof list' shows all names"
            raise InvalidInputError(f"no case is called {pattern!r}; {hint}", pattern)
        chosen.update((c.name, c) for c in hits)
    return [c for c in cases if (c.name in chosen if patterns else not c.by_name)]


def run(cases: list[Case], *, seed: int, alpha: float, workers: int, twins: bool = False) -> Iterator[Result]:
    """Run cases on threads, yielding each result as it is ready; with `twins`, the broken twin of each as well.

    A case's share of alpha is set by the weights of the whole catalogue, whichever cases are run: choosing some of them does not
    change any verdict. Its random numbers depend on `seed` and its name alone: neither do the workers.
    """
    total = sum(case.weight for case in all_cases())
    pool = ThreadPoolExecutor(max_workers=workers)
    try:
        jobs = [pool.submit(run_case, case, seed, alpha * case.weight / total, twins) for case in cases]
        for job in as_completed(jobs):
            yield job.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def run_case(case: Case, seed: int, alpha: float, twins: bool = False) -> Result:
    """Run one case; whatever goes wrong in it is its result, never the end of the run."""
    result = _run_subject(case, seed, alpha)
    return replace(result, twin=run_twin(case, seed, alpha)) if twins and result.status != "skipped" else result


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
    order = {case.name: i for i, case in enumerate(all_cases())}
    ordered = sorted(results, key=lambda result: order[result.case.name])
    names = [case.name for case in asked] or [result.case.name for result in ordered]
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
            "cases": [_case_record(result, seed, alpha) for result in ordered],
        }
    )


def reproduce(case: Case, seed: int, alpha: float) -> str:
    """Return the command that runs a case again, with the same random numbers and the same verdict."""
    share = "" if alpha == ALPHA else f" --alpha {alpha:g}"
    return f"fogproof verify '{case.name}' --seed {seed}{share}"


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
        "reference": f"fogproof.analytic: {case.oracle}" if case.reference is not None else case.oracle,
        "twin": case.twin.error,
        "twin_result": result.twin,
        "plan": None if result.verdict is None else _plan(case),
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
