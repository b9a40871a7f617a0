"""The zoo as a page: what the checks killed, what the field's tests killed of the same, and what each rejects that is right."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from fogproof.text import unfinished
from fogproof.zoo.matrix import GOALS, ZooCount, counts
from fogproof.zoo.others import OtherTest, other_tests
from fogproof.zoo.running import ZooRow

STRICT = 1e-6
_PAGE = """\
# {title}

Written by `fogproof zoo --others -o build/zoo` (`make zoo`), which plants known bugs and puts the same subjects to the tests that
renderers and libraries use. Those are written anew from their descriptions; Mitsuba's own is called.

## What is killed

At most {samples} samples and a false-alarm probability of {alpha:g} for each check. *Infeasible* are errors that the best of all
tests, which knows them beforehand (Neyman & Pearson), could not tell with so many samples; *equal* are changes that change nothing.
A cause is right if it is one that was written down beforehand.

{folders}

## Against the field

Subjects are those to which a test applies. *Own level* is the one at which it is used where it comes from.

{others}

Three habits matter more than the choice of a test:

1. **Deterministic first.** That a pdf integrates to one needs no random numbers; a wrong constant is found to a millionth, not to
   a percent.
2. **One budget.** A thousand tests at 1 % fail ten times a day. Here a run of all cases together rejects something right once in a
   million runs.
3. **Test the tests.** Every case has a broken twin with one planted error, and `fogproof zoo` plants the errors that others have
   shipped.

## What survived

{survivors}

## Bugs that shipped, and misprints

Where each was reported, what rejected it after how many samples, and which of the other tests reject it at their own level (· where
a test does not apply).

{bugs}
"""


def page(rows: Iterable[ZooRow], samples: int, alpha: float, existing: Mapping[str, int], asked: int = 0) -> str:
    """Return the page as Markdown.

    existing  how many bugs each folder has, run or not
    asked     how many bugs were to be run; as many as there are rows by default
    """
    rows = list(rows)
    title = unfinished(len(rows), asked)
    return _PAGE.format(
        samples=samples,
        alpha=alpha,
        folders=_folders(counts(rows), existing),
        others=_others(rows),
        survivors=_survivors(rows) or (f"Nothing yet. {title}." if title else "Nothing."),
        title=f"{title} bugs were run" if title else "Beside other tests",
        bugs=_bugs([row for row in rows if row.folder in ("field", "errata", "families")]),
    )


def _table(head: Sequence[str], rows: Iterable[Sequence[object]], numbers: int) -> str:
    """Return a table whose last columns are numbers."""
    line = ["---"] * (len(head) - numbers) + ["--:"] * numbers
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in (head, line, *rows))


def _folders(sums: list[ZooCount], existing: Mapping[str, int]) -> str:
    def share(part: int, whole: int) -> str:
        return f"{part} of {whole}" if whole else "–"

    bugs = [
        (
            c.folder,
            share(c.total, existing[c.folder]),
            share(c.killed, c.feasible),
            share(c.named, c.killed),
            c.infeasible,
            c.equal,
            c.median,
            f"{GOALS[c.folder]:.0%}",
        )
        for c in sums
        if not c.right
    ]
    head = ("bugs", "run", "killed", "cause right", "infeasible", "equal", "median samples", "goal")
    right = [
        f"Right subjects, {share(c.total, existing[c.folder])} run: {c.false_alarms} rejected, {c.inconclusive} inconclusive"
        " (goal: none, and at most 2 %)."
        for c in sums
        if c.right
    ]
    return "\n\n".join([_table(head, bugs, 7), *right])


def rejected(test: OtherTest, row: ZooRow, level: float | None = None) -> bool | None:
    """Return whether a test rejects the subject of a row at its own level, or another; None where it does not apply."""
    p = row.others.get(test.name)
    return None if p is None else not p >= (test.alpha if level is None else level)


def _others(rows: list[ZooRow]) -> str:
    wrong = [row for row in rows if row.status in ("killed", "survived")]
    right = [row for row in rows if row.status in ("passed", "inconclusive", "false-alarm") and not row.causes]
    lines = []
    for test in other_tests():
        bugs = [row for row in wrong if rejected(test, row) is not None]
        fine = [row for row in right if rejected(test, row) is not None]
        lines.append((
            test.title, f"{test.alpha:.2g}", f"{test.samples:.0e}".replace("e+0", "e"),
            f"{sum(bool(rejected(test, row)) for row in bugs)} of {len(bugs)}",
            f"{sum(bool(rejected(test, row, STRICT)) for row in bugs)}",
            f"{sum(row.status == 'killed' for row in bugs)}",
            f"{sum(bool(rejected(test, row)) for row in fine)} of {len(fine)}",
            f"{sum(bool(rejected(test, row, STRICT)) for row in fine)}",
            f"{sum(row.status == 'false-alarm' for row in fine)}",
        ))  # fmt: skip
    head = (
        "test", "own level", "samples", "bugs killed at its level", "at 1e-6", "fogproof, at 1e-6",
        "right ones rejected at its level", "at 1e-6", "fogproof",
    )  # fmt: skip
    return _table(head, lines, 8)


def _survivors(rows: list[ZooRow]) -> str:
    told = [
        f"* `{row.name}` ({row.title}): {row.status}"
        + (
            f", the best test needs {row.needed:.2g} samples"
            if row.status == "infeasible"
            else f", verdict {row.outcome}"
        )
        for row in rows
        if row.status in ("survived", "infeasible", "false-alarm") or (row.status == "inconclusive" and not row.causes)
    ]
    broken = [f"* `{row.name}`: {row.status}, {row.reason}" for row in rows if row.status in ("error", "skipped")]
    return "\n".join(told + broken)


def _bugs(rows: list[ZooRow]) -> str:
    tests = other_tests()
    marks = {True: "yes", False: "no", None: "·"}
    lines = [
        (
            row.title.replace("|", "\\|"),
            row.source,
            f"{row.cause or row.status}{'' if row.named or row.status != 'killed' else ' (wrong)'}",
            row.samples,
            *(marks[rejected(test, row)] for test in tests),
        )
        for row in rows
    ]
    return _table(("bug", "reported", "named", "samples", *(test.name for test in tests)), lines, 1 + len(tests))
