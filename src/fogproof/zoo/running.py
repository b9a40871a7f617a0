"""Running the zoo: each bug against the same checks that users call, its verdict as one row."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from fogproof.errors import InvalidInputError, NotInstalledError
from fogproof.input_files import read_text
from fogproof.journal import add_line, whole_lines
from fogproof.verify import case_seed
from fogproof.zoo.bug import Bug

Status = Literal[
    "killed", "survived", "infeasible", "equal", "passed", "inconclusive", "false-alarm", "error", "skipped"
]


@dataclass(frozen=True)
class ZooRow:
    """What came of one bug, or of a right subject.

    name, title, source, causes   of the bug; a right subject has no causes
    status    killed; survived; infeasible (not rejected, and no test could have at so many samples); equal (not rejected, and
              nothing is wrong); of right subjects passed, inconclusive or false-alarm; error; skipped
    outcome   of the verdict; cause is its, `named` whether it is one of those that are right
    checks    the findings that rejected, the strongest first
    samples   drawn until the check stopped
    needed    of the bug where nothing was rejected, 0 otherwise
    seed      of the check
    others    p-values of other tests on the same subject, None where a test does not apply
    """

    name: str
    title: str
    source: str
    causes: tuple[str, ...]
    status: Status
    outcome: str = ""
    cause: str = ""
    named: bool = False
    checks: tuple[str, ...] = ()
    samples: int = 0
    seconds: float = 0.0
    needed: float = 0.0
    seed: int = 0
    reason: str = ""
    others: dict[str, float | None] = field(default_factory=dict)

    @property
    def folder(self) -> str:
        """The first part of the name."""
        return self.name.partition("/")[0]


Judge = Callable[[Any, int], dict[str, float | None]]


def run_zoo(
    bugs: Iterable[Bug],
    *,
    samples: int,
    alpha: float,
    seed: int,
    workers: int,
    others: Judge | None = None,
    known: Iterable[ZooRow] = (),
) -> Iterator[ZooRow]:
    """Run the bugs on threads, yielding each row as it is ready; a row depends on `seed` and the bug's name alone.

    samples  most of one check;  alpha its false-alarm probability
    others   other tests to run on each sampler: (sampler, seed) -> p-values
    known    rows of an earlier run, whose bugs are not run again
    """
    done = {row.name for row in known}
    pool = ThreadPoolExecutor(max_workers=workers)
    try:
        jobs = [pool.submit(run_bug, bug, samples, alpha, seed, others) for bug in bugs if bug.name not in done]
        for job in as_completed(jobs):
            yield job.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def run_bug(bug: Bug, samples: int, alpha: float, seed: int, others: Judge | None = None) -> ZooRow:
    """Run one bug; whatever goes wrong in it is its row, never the end of the run."""
    started, own = time.perf_counter(), case_seed(seed, bug.name)
    common: dict[str, Any] = {"name": bug.name, "title": bug.title, "source": bug.source, "causes": bug.causes}
    common["seed"] = own
    samples = min(samples, bug.most or samples)
    needs = getattr(bug.case, "needs", "")
    if needs and importlib.util.find_spec(needs) is None:
        return ZooRow(**common, status="skipped", reason=f"{needs} is not installed")
    try:
        verdict = bug.case.run(alpha, own, samples)
        asked = {} if others is None else others(bug.case, own)
        needed = 0.0 if verdict.outcome == "rejected" or not bug.causes else float(bug.needed())
    except NotInstalledError as error:
        return ZooRow(**common, status="skipped", reason=str(error))
    except Exception as error:  # a defect of one subject is its own row
        return ZooRow(**common, status="error", reason=f"{type(error).__name__}: {error}")
    rejecting = sorted((f for f in verdict.findings if f.outcome == "rejected"), key=lambda f: f.p_value or 0.0)
    return ZooRow(
        **common,
        needed=needed,
        status=_status(bug, verdict.outcome, needed, samples),
        outcome=verdict.outcome,
        cause=verdict.cause,
        named=verdict.outcome == "rejected" and verdict.cause in bug.causes,
        checks=tuple(f.check for f in rejecting),
        samples=verdict.samples,
        seconds=round(time.perf_counter() - started, 3),
        others=asked,
    )


def _status(bug: Bug, outcome: str, needed: float, samples: int) -> Status:
    if not bug.causes and not bug.equal:
        return {"rejected": "false-alarm", "inconclusive": "inconclusive"}.get(outcome, "passed")  # type: ignore[return-value]
    if bug.equal:
        return "false-alarm" if outcome == "rejected" else "equal"
    if outcome == "rejected":
        return "killed"
    if np.isinf(needed):
        return "equal"
    return "infeasible" if needed > samples else "survived"


_SUM = "sum"
"""The key of a row's checksum."""


@dataclass(frozen=True)
class ZooLog:
    """Rows of a run, a line of JSON each, so that a run that was stopped goes on where it was.

    path      of the file
    settings  what the rows depend on: a file of other settings is refused
    """

    path: Path
    settings: dict[str, Any]

    def read(self) -> tuple[list[ZooRow], int]:
        """Return the rows of earlier runs, and how many lines are not what was written: what stood there is run again.

        A file without our head is refused.
        """
        lines = self._lines()
        if not lines:
            add_line(self.path, self.settings)
            return [], 0
        head = self._head(lines)
        if head is None:
            rows_there = any(isinstance(held, dict) and _SUM in held for held in lines)
            what = "holds no rows of a zoo; choose another folder, or delete it"
            if rows_there:
                what = "has rows, but not the line before them that says what they depend on; put it back, or choose another folder"
            raise InvalidInputError(f"{self.path} {what}", str(self.path))
        if head != self.settings:
            what = f"{self.path} is of other settings, {head}; choose another folder, or delete it"
            raise InvalidInputError(what, str(self.path))
        rest = [held for held in lines if held is not head]
        rows = [row for held in rest if (row := self._row(held)) is not None]
        return list({row.name: row for row in rows}.values()), len(rest) - len(rows)

    def seed(self) -> int | None:
        """Return the seed of the rows that are kept, None if there are none."""
        seed = (self._head(self._lines()) or {}).get("seed")
        return seed if isinstance(seed, int) else None

    def add(self, row: ZooRow) -> None:
        """Write one row, with a checksum of it and of what it depends on."""
        add_line(self.path, {**asdict(row), _SUM: self._sum(asdict(row))})

    def _lines(self) -> list[Any]:
        """Return what the lines hold, None of one that is no JSON."""
        return [_read(line) for line in whole_lines(read_text(self.path, "the rows"))] if self.path.exists() else []

    def _head(self, lines: list[Any]) -> dict[str, Any] | None:
        """Return the first line that says what rows depend on; somebody may have written before it."""
        wanted = self.settings.keys()
        return next((h for h in lines if isinstance(h, dict) and _SUM not in h and wanted <= h.keys()), None)

    def _row(self, held: Any) -> ZooRow | None:
        """Return the row that a line holds, None if it holds none, or not what was written."""
        try:
            said = {key: value for key, value in held.items() if key != _SUM}
            if held[_SUM] != self._sum(said):
                return None
            row = ZooRow(**{**said, "causes": tuple(said["causes"]), "checks": tuple(said["checks"])})
        except (AttributeError, TypeError, KeyError):
            return None
        return row if row.status in get_args(Status) and isinstance(row.name, str) else None

    def _sum(self, row: dict[str, Any]) -> str:
        words = json.dumps([self.settings, row], sort_keys=True).encode()
        return hashlib.blake2b(words, digest_size=8).hexdigest()


def _read(line: str) -> Any:
    """Return what a line of JSON holds, None if it is none."""
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
