"""The record of a run, ready for JSON, and the command that runs a case again."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shlex
from collections.abc import Iterable
from typing import Any

import numpy as np

from fogproof.catalogue import Case
from fogproof.checks.json_values import jsonable
from fogproof.oracle_error import oracle_errors
from fogproof.plan import plan, scene_of
from fogproof.text import state, unfinished
from fogproof.verify.results import Result, exit_code
from fogproof.verify.selection import called, shares, whole

SCHEMA = "fogproof/results/1"
ALPHA = 1e-6
"""False-alarm probability of a run of the whole catalogue, unless told otherwise."""


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
    order = {case.name: i for i, case in enumerate(case for origin in origins for case in whole(origin))}
    ordered = sorted(results, key=lambda result: order[result.case.name])
    names = [case.name for case in asked] or [result.case.name for result in ordered]
    parts = shares(asked or [result.case for result in ordered], alpha)
    table: dict[str, Any] = jsonable(
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
            "state": state(stopped),
            "title": unfinished(len(ordered), len(names)),
            "asked": names,
            "oracle": oracle_errors(),
            "cases": [_case_record(result, seed, parts[result.case.origin]) for result in ordered],
        }
    )
    return table


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
