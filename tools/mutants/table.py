"""docs/mutants.md: how many errors the tests see, and which they do not."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from mutants.mutant import Mutant

_HEAD = """# Errors planted in our own source

`make mutants` plants realistic errors one at a time in a copy of the project and runs the tests that should see them: dropped
factors, wrong branches, swapped axes, ignored arguments, shrunken bounds, removed clamps, alpha that is not shared, one-sided
p-values, wrong merges, wrong exit codes. The lists are in `tools/mutants/lists`. This page is written by
`python tools/mutants --table`.

| part | errors | seen | harmless | not seen | not tried |
|---|---|---|---|---|---|
"""


def write(mutants: list[Mutant], results: dict[str, dict], path: Path) -> None:
    """Write the page."""
    parts: dict[str, Counter[str]] = {}
    for mutant in mutants:
        parts.setdefault(mutant.part, Counter())[_fate(mutant, results)] += 1
    rows = [(part, count.total(), *(count[fate] for fate in _FATES)) for part, count in parts.items()]
    rows.append(("**all**", *(sum(row[i] for row in rows) for i in range(1, 6))))
    text = _HEAD + "".join(f"| {' | '.join(map(str, row))} |\n" for row in rows)
    for fate, title in (("not seen", "Not seen yet"), ("harmless", "Harmless")):
        found = [mutant for mutant in mutants if _fate(mutant, results) == fate]
        if found:
            text += f"\n## {title}\n\n| file | error | why |\n|---|---|---|\n"
            text += "".join(f"| `{m.file}` | {m.what} | {m.harmless} |\n" for m in found)
    seen = Counter(results[m.key]["test"].partition("::")[0] for m in mutants if _fate(m, results) == "seen")
    text += "\n## Which tests saw them first\n\n| test file | errors |\n|---|---|\n"
    text += "".join(f"| `{file}` | {count} |\n" for file, count in seen.most_common())
    path.write_text(text)


_FATES = ("seen", "harmless", "not seen", "not tried")


def _fate(mutant: Mutant, results: dict[str, dict]) -> str:
    row = results.get(mutant.key)
    if row is None:
        return "harmless" if mutant.harmless else "not tried"
    return "seen" if row["outcome"] == "killed" else "harmless" if mutant.harmless else "not seen"
