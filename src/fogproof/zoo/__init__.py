"""The zoo: known bugs, planted, run against the checks. The tests are tested here.

A folder of bugs is a module here or a folder of modules; each has a function `bugs()`, and nothing lists the modules of a folder.
"""

from __future__ import annotations

import fnmatch
import importlib
import pkgutil
from collections.abc import Iterable
from functools import cache
from zlib import crc32

from fogproof.errors import InvalidInputError
from fogproof.zoo.bug import Bug

__all__ = ["FOLDERS", "Bug", "all_bugs", "bugs_of", "select"]

FOLDERS = ("field", "errata", "families", "outsiders", "mutants", "right")
"""Folders of bugs: `bugs()` of a module of that name here, or of the modules below a folder of that name."""


MANY = ("outsiders", "mutants", "right")
"""Folders of many bugs."""


def _drawn(name: str, one_in: int) -> bool:
    return crc32(name.encode()) % one_in == 0


@cache
def bugs_of(folder: str) -> tuple[Bug, ...]:
    """Return the bugs of a folder of names, which is a module or a folder of modules here, in the order of the modules' names."""
    inside = f"{__name__}.{folder}"
    found = [each.name for each in pkgutil.walk_packages(__path__, prefix=f"{__name__}.") if not each.ispkg]
    modules = [
        importlib.import_module(name) for name in sorted(found) if name == inside or name.startswith(f"{inside}.")
    ]
    return tuple(bug for module in modules if hasattr(module, "bugs") for bug in module.bugs())


def all_bugs() -> tuple[Bug, ...]:
    """Return every bug, folder by folder."""
    return tuple(bug for folder in FOLDERS for bug in bugs_of(folder))


def select(patterns: Iterable[str], one_in: int = 1) -> list[Bug]:
    """Return the bugs whose name begins with one of the patterns as a folder, or matches it as a glob; all without patterns.

    one_in  of the folders of `MANY`, one bug in so many is taken, by a hash of its name; those whose own name is given always are

    >>> len(select(["field/log-of-0"]))
    1
    """
    chosen: dict[str, Bug] = {}
    for pattern in list(patterns) or FOLDERS:
        first = pattern.partition("/")[0]
        offered = bugs_of(first) if first in FOLDERS else all_bugs() if set(first) & set("*?[") else ()
        folder = pattern.rstrip("/")
        hits = [b for b in offered if b.name.startswith(f"{folder}/") or b.name == folder]
        hits = hits or [b for b in offered if fnmatch.fnmatchcase(b.name, pattern)]
        if not hits:
            raise InvalidInputError(f"no bug is called {pattern!r}; the folders are {', '.join(FOLDERS)}", pattern)
        single = len(hits) == 1
        chosen |= {bug.name: bug for bug in hits if single or bug.folder not in MANY or _drawn(bug.name, one_in)}
    return list(chosen.values())
