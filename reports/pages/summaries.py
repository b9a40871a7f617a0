"""What many cases have in common: outcomes of each system, what rejects broken twins, which terms scenes need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from fogproof.plan import Plan
from fogproof.reports.records.runs import Case, RunRecord


@dataclass(frozen=True)
class System:
    """The cases whose names share what stands before the first slash.

    resolutions  (kind, best, worst) of the passes
    twins        (rejected, run)
    """

    name: str
    cases: tuple[Case, ...]
    resolutions: tuple[tuple[str, float, float], ...]
    twins: tuple[int, int]
    seconds: float

    def count(self, status: str) -> int:
        """Return how many cases have this status."""
        return sum(case.status == status for case in self.cases)


@dataclass(frozen=True)
class Catch:
    """What one check did to the broken twins: how many it rejected, and the cases whose twin it alone rejected."""

    check: str
    twins: int
    alone: tuple[Case, ...]


@dataclass(frozen=True)
class Need:
    """Scenes that need the same treatment."""

    plan: Plan
    cases: tuple[Case, ...]


def systems(run: RunRecord) -> list[System]:
    """Return the systems in the order of the record."""
    groups: dict[str, list[Case]] = {}
    for case in run.cases:
        groups.setdefault(case.name.partition("/")[0], []).append(case)
    found = []
    for name, cases in groups.items():
        kinds: dict[str, list[float]] = {}
        for case in cases:
            resolution = case.verdict.resolution if case.verdict is not None and case.status == "passed" else None
            if resolution and 0 < resolution.value < inf:
                kinds.setdefault(plain(resolution.kind), []).append(resolution.value)
        twins = [case.twin_result for case in cases if case.twin_result]
        found.append(
            System(
                name,
                tuple(cases),
                tuple((kind, min(values), max(values)) for kind, values in kinds.items()),
                (sum(twin.outcome == "rejected" for twin in twins), len(twins)),
                sum(case.seconds for case in cases),
            )
        )
    return found


def catches(run: RunRecord) -> list[Catch]:
    """Return what rejected the broken twins, the check that rejects most of them first."""
    twins: dict[str, int] = {}
    alone: dict[str, list[Case]] = {}
    for case in run.cases:
        checks = {plain(check) for check in case.twin_result.checks} if case.twin_result else set()
        for check in checks:
            twins[check] = twins.get(check, 0) + 1
        if len(checks) == 1:
            alone.setdefault(checks.pop(), []).append(case)
    order = sorted(twins, key=lambda check: (-twins[check], check))
    return [Catch(check, twins[check], tuple(alone.get(check, ()))) for check in order]


def needs(cases: Sequence[Case]) -> list[Need]:
    """Return the different treatments that the cases' scenes need, what keeps most terms first."""
    groups: dict[tuple[object, ...], list[Case]] = {}
    for case in cases:
        if case.plan:
            kept = tuple(term.kept for term in case.plan.terms)
            groups.setdefault((kept, case.plan.solver, case.plan.estimator), []).append(case)
    found = [Need(group[0].plan, tuple(group)) for group in groups.values() if group[0].plan]
    return sorted(found, key=lambda need: -sum(term.kept for term in need.plan.terms))


def by_cause(cases: Sequence[Case]) -> list[tuple[str, list[Case]]]:
    """Return the rejected cases by their likely cause, "" for none, the commonest first."""
    groups: dict[str, list[Case]] = {}
    for case in cases:
        if case.status == "rejected":
            groups.setdefault(case.verdict.cause if case.verdict is not None else "", []).append(case)
    return sorted(groups.items(), key=lambda pair: -len(pair[1]))


def blind(case: Case) -> bool:
    """Return whether the broken twin of a case was run and not rejected."""
    return case.twin_result is not None and case.twin_result.outcome != "rejected"


def plain(name: str) -> str:
    """Return the name of a check or an error without what it looks at: "scan in mu" is a scan."""
    return name.partition(" in ")[0].partition(" of ")[0] or name
