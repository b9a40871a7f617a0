"""The kill matrix: how many bugs of each folder were killed, how many causes named rightly, and what was missed and why."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from fogproof.text import unfinished
from fogproof.zoo.running import ZooRow

GOALS = {"field": 0.97, "errata": 1.0, "families": 1.0, "outsiders": 1.0, "mutants": 0.99}
"""Share of the feasible bugs of a folder that must be killed."""
NAMED = 0.85
"""Share of the causes that must be right."""
UNDECIDED = 0.02
"""Share of right subjects that may be inconclusive; none may be rejected."""


@dataclass(frozen=True)
class ZooCount:
    """Sums of a folder.

    asked       how many were to run, where that is known
    feasible    bugs that some test could tell at so many samples
    named       of the killed, whose cause was named rightly
    median      samples that half of the killed needed at most
    """

    folder: str
    total: int
    killed: int
    feasible: int
    infeasible: int
    equal: int
    named: int
    median: int
    false_alarms: int
    inconclusive: int
    errors: int
    skipped: int
    asked: int = 0

    @property
    def right(self) -> bool:
        """Whether these are right subjects, of which none should be rejected."""
        return self.folder == "right"

    @property
    def good(self) -> bool:
        """Whether the folder's goal is met."""
        if self.errors or self.false_alarms:
            return False
        if self.right:
            return self.inconclusive <= UNDECIDED * self.total
        return self.killed >= GOALS.get(self.folder, 1.0) * self.feasible and self.named >= NAMED * self.killed

    @property
    def outcome(self) -> str:
        """Whether the goal is met, in words: a part does not tell, unless what it found cannot be made good any more."""
        if self.total < self.asked and not (self.errors or self.false_alarms):
            return unfinished(self.total, self.asked).lower()
        return "met" if self.good else "NOT met"


def counts(rows: Iterable[ZooRow], asked: Mapping[str, int] | None = None) -> list[ZooCount]:
    """Return the sums of each folder, in the order of the rows; `asked` says how many of each were to run."""
    folders: dict[str, list[ZooRow]] = {folder: [] for folder in asked or ()}
    for row in rows:
        folders.setdefault(row.folder, []).append(row)
    return [_count(folder, of, (asked or {}).get(folder, len(of))) for folder, of in folders.items()]


def _count(folder: str, rows: list[ZooRow], asked: int) -> ZooCount:
    def many(*status: str) -> int:
        return sum(row.status in status for row in rows)

    needed = sorted(row.samples for row in rows if row.status == "killed")
    return ZooCount(
        folder,
        len(rows),
        many("killed"),
        many("killed", "survived"),
        many("infeasible"),
        many("equal"),
        sum(row.named for row in rows if row.status == "killed"),
        needed[len(needed) // 2] if needed else 0,
        many("false-alarm"),
        many("inconclusive"),
        many("error"),
        many("skipped"),
        asked,
    )


def summary(rows: Iterable[ZooRow], asked: Mapping[str, int] | None = None) -> str:
    """Return the sums as a table for people; see `counts`."""
    lines = [
        f"{'folder':10} {'killed':>12} {'named':>12} {'infeasible':>10} {'equal':>6} {'errors':>7} {'samples':>9}  goal"
    ]
    for c in counts(rows, asked):
        if c.right:
            what = (
                f"{c.total} right subjects: {c.false_alarms} rejected, {c.inconclusive} inconclusive, {c.errors} errors"
            )
            lines.append(f"{c.folder:10} {what}  {c.outcome}")
            continue
        killed, named = f"{c.killed} of {c.feasible}", f"{c.named} of {c.killed}"
        goal = f"{GOALS.get(c.folder, 1.0):.0%} killed, {NAMED:.0%} named: {c.outcome}"
        lines.append(
            f"{c.folder:10} {killed:>12} {named:>12} {c.infeasible:10} {c.equal:6} {c.errors:7} {c.median:9}  {goal}"
        )
    return "\n".join(lines)


def line(row: ZooRow, width: int) -> str:
    """Return one row for people."""
    if row.status in ("error", "skipped"):
        return f"{row.name:{width}} {row.status:12} {row.reason}"
    told = row.cause
    if row.status == "killed" and not row.named:
        told += f" (right: {' or '.join(row.causes)})"
    if row.status == "infeasible":
        told = f"the best test needs {row.needed:.2g} samples"
    by = f"by {row.checks[0]}" if row.checks else ""
    return f"{row.name:{width}} {row.status:12} {row.samples:8} {row.seconds:7.2f} s  {told}  {by}".rstrip()
