"""A run of one's own: verdicts about anybody's samplers and estimators inside one false-alarm probability, and their page."""

from __future__ import annotations

import datetime
import functools
import importlib.metadata
import json
import os
import shlex
import sys
import time
import weakref
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NoReturn

from fogproof.catalogue.cases import LONGEST_NAME
from fogproof.checks import Verdict
from fogproof.checks.arguments import seed_of, shared_among
from fogproof.checks.json_values import jsonable
from fogproof.checks.streams import batch_generator
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.unnamed import unnamed_file
from fogproof.validate import number
from fogproof.verify import ALPHA, SCHEMA, environment

_STATUS = {"not rejected": "passed", "rejected": "rejected", "inconclusive": "inconclusive"}


class Run:
    """Checks that share one false-alarm probability, whatever their number: the k-th gets alpha / (k (k + 1)).

    >>> import numpy as np, fogproof
    >>> run = fogproof.Run(seed=1)
    >>> verdict = run.check("exponential", fogproof.check_sampler, lambda u: -np.log1p(-u[:, 0]), lambda t: np.exp(-t),
    ...                     fogproof.HalfLine(0.0), dimensions=1, samples=20_000)
    >>> run.exit_code
    0

    `run.write(folder)` makes the same page as `fogproof verify --report folder`.
    """

    def __init__(self, alpha: float = ALPHA, seed: int | None = None) -> None:
        self.alpha = number("alpha", alpha, "must lie in (0, 1)", 0, 1, open_ends=True)
        self.seed = seed_of(seed)
        self._started, self._clock = datetime.datetime.now(datetime.UTC), time.perf_counter()
        self._cases: dict[str, dict[str, Any]] = {}
        self._beside = 0.0  # alphas of verdicts that took none of the run's
        self._process, self._forks = os.getpid(), unnamed_file()
        if self._forks is not None:
            weakref.finalize(self, os.close, self._forks)

    def __getstate__(self) -> NoReturn:
        """Refuse to be copied or pickled: what a copy rejects would be lost."""
        ways = "add here what another process returns, run.add(name, verdict), or start it as a fork"
        raise UnsupportedError(f"a Run is neither copied nor pickled, for what the copy finds would be lost: {ways}")

    def check(self, name: str, check: Callable[..., Verdict], *arguments: Any, **options: Any) -> Verdict:
        """Call a check of fogproof's, such as `check_sampler`, and keep the verdict.

        A check that is statistical gets its share of alpha, one that draws random numbers a seed of its own.
        What it raises is raised, after it has been noted: the page shows it as not judged, and so it does where somebody
        interrupts it. A function of one's own that takes no alpha spends one beside the run's; the run's record counts both.
        """
        if "alpha" in options:
            raise InvalidValueError("alpha", "must be given to Run(alpha=...), whose checks share it", options["alpha"])
        title = _name_of(check)
        place = self._placed(name, case_record(name, None, title=title, status="error", reason="it did not end"))
        shared = {
            "alpha": self.alpha / (place * (place + 1)),
            "seed": int(batch_generator(self.seed, name, 0, 0).integers(2**62)),
        }
        options = shared_among(check, shared) | options
        clock = time.perf_counter()
        try:
            verdict = check(*arguments, **options)
            if not isinstance(verdict, Verdict):
                raise InvalidValueError(
                    "check", "must return a Verdict, as those of fogproof do", type(verdict).__name__
                )
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
            self._keep(name, case_record(name, None, title=title, status="error", reason=reason))
            raise
        seconds = time.perf_counter() - clock
        self._keep(name, case_record(name, verdict.to_dict(), title=title, seconds=seconds))
        if "alpha" not in shared_among(check, shared):
            self._beside += verdict.alpha
        return verdict

    def add(self, name: str, verdict: Verdict) -> None:
        """Keep a verdict that was reached elsewhere, with an alpha of its own, which the run's record adds to the run's."""
        if not isinstance(verdict, Verdict):
            raise InvalidValueError("verdict", "must be a Verdict, as the checks of fogproof return", verdict)
        self._placed(name, case_record(name, verdict.to_dict(), seconds=verdict.seconds))
        self._beside += verdict.alpha

    def _placed(self, name: str, case: dict[str, Any]) -> int:
        """Keep a case under a new name and return its place, from 1; also threads at the same time get different ones."""
        if not isinstance(name, str):
            raise InvalidValueError("name", "must be a string", name)
        if len(name) > LONGEST_NAME:
            raise InvalidValueError("name", f"must have at most {LONGEST_NAME} characters", name)
        if self._cases.setdefault(name, case) is not case:
            raise InvalidValueError("name", "must be new in the run", name)
        self._keep(name, case)
        return list(self._cases).index(name) + 1

    def _keep(self, name: str, case: dict[str, Any]) -> None:
        """Keep a case; a forked process also leaves it in a file that it and the run's own have open."""
        self._cases[name] = case
        if self._forks is not None and self._process != os.getpid():
            os.write(self._forks, json.dumps([os.getpid(), name, jsonable(case)]).encode() + b"\n")

    def _all(self) -> list[dict[str, Any]]:
        """Return the cases of this process, and those of the processes that were forked from it."""
        cases = dict[Any, dict[str, Any]](self._cases)
        if self._forks is not None and self._process == os.getpid():
            for line in os.pread(self._forks, os.fstat(self._forks).st_size, 0).splitlines():
                process, name, case = json.loads(line)
                cases[process, name] = {**case, "name": f"{name} (process {process})" if name in self._cases else name}
        return list(cases.values())

    @property
    def exit_code(self) -> int:
        """0 if nothing was rejected, 1 if something was or could not be judged, 3 if something is only inconclusive."""
        return _exit_code(self._all())

    def record(self) -> dict[str, Any]:
        """Return the JSON-ready record of the run."""
        return run_record(
            self._all(),
            kind="run",
            seed=self.seed,
            alpha=self.alpha + self._beside,
            command=shlex.join(sys.argv),
            started=self._started.isoformat(timespec="seconds"),
            seconds=time.perf_counter() - self._clock,
        )

    def write(self, folder: str | Path) -> Path:
        """Write page, figures, results.json, results.csv and junit.xml into a folder, and return the path of the page."""
        from fogproof.reports import prepare_folder, write_report

        prepare_folder(Path(folder))
        return write_report(self.record(), folder)


def _name_of(check: Callable[..., Verdict]) -> str:
    """Return the name of a check, also of one whose arguments are given in part, or that is an object."""
    while isinstance(check, functools.partial):
        check = check.func
    return getattr(check, "__name__", type(check).__name__)


def case_record(
    name: str,
    verdict: dict[str, Any] | None,
    *,
    title: str = "",
    status: str = "",
    reason: str = "",
    reproduce: str = "",
    seconds: float | None = None,
) -> dict[str, Any]:
    """Return one case of a record, made from the plain data of a verdict."""
    status = status or _STATUS[(verdict or {})["outcome"]]
    return {
        "name": name,
        "title": title,
        "kind": "estimator" if "estimator" in title else "sampler",
        "status": status,
        "expected": "not rejected",
        "reason": reason,
        "source": "",
        "reference": "",
        "twin": "",
        "twin_result": None,
        "plan": None,
        "reproduce": reproduce or (verdict or {}).get("reproduce", ""),
        "seconds": float((verdict or {}).get("seconds", 0.0)) if seconds is None else seconds,
        "verdict": verdict,
    }


def run_record(
    cases: list[dict[str, Any]], *, kind: str, seed: int, alpha: float, command: str, started: str, seconds: float
) -> dict[str, Any]:
    """Return the record of cases that no catalogue knows."""
    table: dict[str, Any] = jsonable(
        {
            "schema": SCHEMA,
            "kind": kind,
            "fogproof": importlib.metadata.version("fogproof"),
            "environment": environment(),
            "command": command,
            "seed": seed,
            "alpha": alpha,
            "started": started,
            "seconds": seconds,
            "exit_code": _exit_code(cases),
            "oracle": [],
            "cases": cases,
        }
    )
    return table


def _exit_code(cases: Iterable[dict[str, Any]]) -> int:
    statuses = {case["status"] for case in cases}
    return 1 if statuses & {"rejected", "error"} else 3 if "inconclusive" in statuses else 0
