"""What a session says at its end, on the terminal and as a page."""

from __future__ import annotations

import datetime
from collections import Counter
from pathlib import Path
from typing import Any

from fogproof.runs import case_record, run_record
from fogproof.text import one_line, state
from fogproof_pytest.kept import again

Told = dict[tuple[str, int], dict[str, Any]]
"""Verdicts in plain data, by test and number."""
_MOST = 12
_INTERRUPTED = 2  # pytest.ExitCode


def summary(told: Told, alpha: float, seed: int) -> list[str]:
    """Return the lines of the terminal's section."""
    outcomes = Counter(verdict["outcome"] for verdict in told.values())
    counts = ", ".join(f"{n} {outcome}" for outcome, n in outcomes.items()) or "none"
    spent = sum(verdict["alpha"] for verdict in told.values())
    lines = [
        f"verdicts: {counts}",
        f"false-alarm probability spent: {spent:.2g} of {alpha:g}; repeat with --fogproof-seed={seed}",
    ]
    passed = [(key, v) for key, v in told.items() if v["outcome"] == "not rejected" and v["resolution"]]
    for (test, _), verdict in passed[:_MOST]:
        resolution = verdict["resolution"]
        would = f"{resolution['kind']} above {float(resolution['value']):.2g} would have been caught"
        lines.append(f"{one_line(test)}: {verdict['check']}, {would}")
    if len(passed) > _MOST:
        lines.append(f"... and {len(passed) - _MOST} more passes with their resolutions, see --fogproof-report DIR")
    return lines


def written(told: Told, crashed: list[str], folder: str, seed: int, alpha: float, exit_code: int, command: str) -> Path:
    """Write the report of a session into a folder, and return its page.

    crashed  tests that ended with their worker of xdist
    """
    from fogproof.reports import prepare_folder, write_report

    prepare_folder(Path(folder))
    numbers = Counter(test for test, _ in told)
    cases = []
    for (test, number), verdict in told.items():
        name = test if numbers[test] == 1 else f"{test} #{number + 1}"
        body = {key: value for key, value in verdict.items() if key != "check"}
        cases.append(case_record(name, body, title=verdict["check"], reproduce=again(test, seed)))
    ended = "its process ended before it was finished"
    cases += [
        case_record(
            f"{test} (end)" if numbers[test] else test, None, status="error", reason=ended, reproduce=again(test, seed)
        )
        for test in dict.fromkeys(crashed)
    ]
    now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    seconds = sum(float(verdict["seconds"]) for verdict in told.values())
    record = run_record(
        cases, kind="tests", seed=seed, alpha=alpha, command=f"pytest {command}", started=now, seconds=seconds
    )
    stopped = state(exit_code == _INTERRUPTED)  # by Ctrl-C, or where tests could not be collected
    return write_report({**record, "exit_code": exit_code, "state": stopped}, folder)
