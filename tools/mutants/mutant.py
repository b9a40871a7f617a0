"""One realistic error in the source, and the list of all of them.

A list is a TOML file for a part of the project; its tables are named by the file that they change:

    ["src/fogproof/checks/statistics/tails.py"]
    mutants = [
      { what = "lower tail without its own count", old = "betaincc(count + 1,", new = "betaincc(count," },
    ]

`tests`, of a file or of one error, names the test files (or tests) that should see it; `harmless` says why nothing can.
"""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LISTS = Path(__file__).parent / "lists"
_FIELDS = {"what", "old", "new", "tests", "harmless"}


@dataclass(frozen=True)
class Mutant:
    """One error: `old` occurs exactly once in `file` and becomes `new`.

    part      the list it is from
    tests     test files or tests that are expected to see it, tried first
    harmless  why no test can see it, "" if one should
    """

    part: str
    file: str
    what: str
    old: str
    new: str
    tests: tuple[str, ...] = ()
    harmless: str = ""

    @property
    def key(self) -> str:
        """A name that changes with the error, and with nothing else."""
        return hashlib.blake2b("\0".join((self.file, self.old, self.new)).encode(), digest_size=6).hexdigest()

    @property
    def stale(self) -> bool:
        """Whether the source has moved on: the error has to be written anew."""
        return (ROOT / self.file).read_text().count(self.old) != 1

    def applied(self, text: str) -> str:
        """Return the text of the file with the error in it."""
        count = text.count(self.old)
        if count != 1:
            raise ValueError(f"{self.part}: {self.file}: {self.old!r} occurs {count} times, not once: write it anew")
        return text.replace(self.old, self.new)


def mutants() -> list[Mutant]:
    """Return all errors, in the order of the lists."""
    return [mutant for path in sorted(LISTS.glob("*.toml")) for mutant in _of(path)]


def _of(path: Path) -> list[Mutant]:
    found = []
    for file, table in tomllib.loads(path.read_text()).items():
        for row in table["mutants"]:
            if unknown := set(row) - _FIELDS:
                raise ValueError(f"{path.name}: {file}: unknown fields {sorted(unknown)}")
            tests = (*row.get("tests", ()), *table.get("tests", ()))
            found.append(Mutant(path.stem, file, **{**row, "tests": tests}))
    return found
