"""The record of a session while it runs: whole after every verdict, so that whatever ends the session leaves what it has found.

Until the session's own end replaces it, `results.json` is that of an interrupted session, and `fogproof report DIR` makes its page.
"""

from __future__ import annotations

import contextlib
import datetime
import json
import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fogproof.checks.json_values import jsonable
from fogproof.reports.files import REPORT
from fogproof.reports.records.runs import RESULTS, write_record
from fogproof.runs import case_record, run_record

_INTERRUPTED = 2  # pytest.ExitCode
_END = b"\n]\n}\n"
_EMPTY = b" []\n}\n"
"""How a record ends whose last key is its cases; and one that has none."""
_LONGEST = max(len(_END), len(_EMPTY))
_counts: Counter[str] = Counter()


def begin(folder: str, seed: int, alpha: float, command: str) -> None:
    """Write the record of a session that has found nothing yet, in the place of what an earlier one has left."""
    now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    record = run_record([], kind="tests", seed=seed, alpha=alpha, command=f"pytest {command}", started=now, seconds=0.0)
    for name in {*REPORT} - {RESULTS}:
        for path in Path(folder).glob(name):
            with contextlib.suppress(OSError):
                path.unlink()
    cases = record.pop("cases")  # comes last
    write_record({**record, "exit_code": _INTERRUPTED, "state": "interrupted", "cases": cases}, folder)


def again(test: str, seed: int) -> str:
    """Return the command that runs a test again."""
    return f"pytest '{test}' --fogproof-seed={seed}"


def keep(folder: str, test: str, verdict: dict[str, Any], seed: int, where: str) -> None:
    """Add a verdict to the record. What cannot be written is told at the session's end.

    where  the process, if it is not the session's own: "gw0"
    """
    _counts[test] += 1
    number = f" #{_counts[test]}" if _counts[test] > 1 else ""
    name = f"{test}{number}" + (f" ({where})" if where else "")
    body = {key: value for key, value in verdict.items() if key != "check"}
    case = case_record(name, body, title=verdict["check"], reproduce=again(test, seed))
    line = json.dumps(jsonable(case), allow_nan=False).encode()
    with contextlib.suppress(OSError), _open(Path(folder) / RESULTS) as file:
        os.lseek(file, -_LONGEST, os.SEEK_END)
        tail = os.read(file, _LONGEST)
        for end, begun in ((_END, b",\n"), (_EMPTY, b" [\n")):
            if tail.endswith(end):
                os.lseek(file, -len(end), os.SEEK_END)
                os.write(file, begun + line + _END)


@contextlib.contextmanager
def _open(path: Path) -> Iterator[int]:
    """Open a file that no other process of the session writes into meanwhile."""
    file = os.open(path, os.O_RDWR | getattr(os, "O_BINARY", 0))
    try:
        with contextlib.suppress(ImportError):  # Windows
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX)
        yield file
    finally:
        os.close(file)
