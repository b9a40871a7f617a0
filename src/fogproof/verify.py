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
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from fogproof.catalogue import Case, all_cases
from fogproof.checks import Verdict, batch_generator, jsonable
from fogproof.errors import FogproofError, InvalidInputError, NotInstalledError

SCHEMA = "fogproof/results/1"
Status = Literal["passed", "rejected", "inconclusive", "known", "surprise", "skipped", "error"]
_PACKAGES = {"mitsuba": ("Mitsuba 3", "mitsuba"), "miepython": ("miepython", "mie")}
"""Name and extra of each module that a case may need."""


@dataclass(frozen=True)
class Result:
    """What became of one case; `reason` says why it was skipped, failed to run, or is a known finding."""

    case: Case
    status: Status
    verdict: Verdict | None
    reason: str
    seconds: float

    @property
    def good(self) -> bool:
        """Whether the outcome is the expected one, or the case was visibly skipped."""
        return self.status in ("passed", "known", "skipped")


def select(patterns: Iterable[str]) -> list[Case]:
    """Return the cases whose name is one of the patterns, begins with one as a folder, or matches it as a glob; all for none."""
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
    return [c for c in cases if c.name in chosen] if patterns else list(cases)


def run(cases: list[Case], *, seed: int, alpha: float, workers: int) -> Iterator[Result]:
    """Run cases on threads, yielding each result as it is ready.

    A case's share of alpha is set by the weights of the whole catalogue, whichever cases are run: choosing some of them does not
    change any verdict. Its random numbers depend on `seed` and its name alone: neither do the workers.
    """
    total = sum(case.weight for case in all_cases())
    pool = ThreadPoolExecutor(max_workers=workers)
    try:
        jobs = [pool.submit(run_case, case, seed, alpha * case.weight / total) for case in cases]
        for job in as_completed(jobs):
            yield job.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def run_case(case: Case, seed: int, alpha: float) -> Result:
    """Run one case; whatever goes wrong in it is its result, never the end of the run."""
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
    """Return 0 if every outcome is as expected, 1 if something was rejected or failed, 3 if something was only inconclusive."""
    statuses = {result.status for result in results}
    if statuses & {"rejected", "surprise", "error"}:
        return 1
    return 3 if "inconclusive" in statuses else 0


def record(
    results: Iterable[Result], *, seed: int, alpha: float, command: str, started: str, seconds: float
) -> dict[str, Any]:
    """Return the JSON-ready record of a run, cases in the order of the catalogue."""
    order = {case.name: i for i, case in enumerate(all_cases())}
    ordered = sorted(results, key=lambda result: order[result.case.name])
    return jsonable(
        {
            "schema": SCHEMA,
            "kind": "verify",
            "fogproof": importlib.metadata.version("fogproof"),
            "environment": _environment(),
            "command": command,
            "seed": seed,
            "alpha": alpha,
            "started": started,
            "seconds": seconds,
            "exit_code": exit_code(ordered),
            "cases": [_case_record(result, seed) for result in ordered],
        }
    )


def _case_record(result: Result, seed: int) -> dict[str, Any]:
    case = result.case
    return {
        "name": case.name,
        "title": case.title,
        "kind": case.kind,
        "status": result.status,
        "expected": case.expected,
        "reason": result.reason,
        "source": case.source,
        "reference": f"fogproof.analytic: {case.oracle}",
        "twin": case.twin.error,
        "reproduce": f"fogproof verify '{case.name}' --seed {seed}",
        "seconds": result.seconds,
        "verdict": None if result.verdict is None else result.verdict.to_dict(),
    }


def _environment() -> dict[str, Any]:
    versions = {"python": platform.python_version(), "numpy": np.__version__}
    for package in ("scipy", "mitsuba"):
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "not installed"
    return {**versions, "platform": platform.platform(terse=True), "cores": os.cpu_count()}
