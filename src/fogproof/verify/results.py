"""What became of the cases of a run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from fogproof.catalogue import Case
from fogproof.checks import Verdict

Status = Literal["passed", "rejected", "inconclusive", "known", "surprise", "skipped", "error"]


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


def status_of(outcome: str, expected: str) -> Status:
    """Return what a verdict's outcome means for a case that is expected to come to another one.

    Who declares that nothing can be told may be told something all the same: right is passed, wrong is rejected.
    """
    if expected == "rejected":
        return "known" if outcome == "rejected" else "surprise"
    if expected == outcome == "inconclusive":
        return "known"
    return "passed" if outcome == "not rejected" else "rejected" if outcome == "rejected" else "inconclusive"


def exit_code(results: Iterable[Result]) -> int:
    """Return 0 if every outcome is as expected, 1 if something was rejected or failed, 3 if something was only inconclusive.

    A broken twin that was not rejected counts as a failure: its checks are blind.
    """
    return code_of((result.status, result.twin) for result in results)


def code_of(outcomes: Iterable[tuple[str, TwinResult | None]]) -> int:
    """Return the exit code of cases by their (status, broken twin)."""
    outcomes = list(outcomes)
    statuses = {status for status, _ in outcomes}
    if statuses & {"rejected", "surprise", "error"} or any(twin and twin.outcome != "rejected" for _, twin in outcomes):
        return 1
    return 3 if "inconclusive" in statuses else 0
