"""The zoo: known bugs, planted, run against the checks. The tests are tested here.

A module below this folder that has a function `bugs()` is a part of it; nothing lists the modules.
"""

from __future__ import annotations

import fnmatch
import importlib
import pkgutil
from collections.abc import Iterable
from functools import cache

from fogproof.errors import InvalidInputError
from fogproof.zoo.bug import Bug

__all__ = ["Bug", "all_bugs", "select"]


@cache
def all_bugs() -> tuple[Bug, ...]:
    """Return every bug, in the order of the folders; in a folder, in the order of the modules' names."""
    names = sorted(found.name for found in pkgutil.walk_packages(__path__, prefix=f"{__name__}.") if not found.ispkg)
    groups = (getattr(importlib.import_module(name), "bugs", None) for name in names)
    return tuple(bug for group in groups if group is not None for bug in group())


def select(patterns: Iterable[str]) -> list[Bug]:
    """Return the bugs whose name begins with one of the patterns as a folder, or matches it as a glob; all without patterns.

    >>> len(select(["field/log-of-0"]))
    1
    """
    patterns = list(patterns)
    chosen: dict[str, Bug] = {} if patterns else {bug.name: bug for bug in all_bugs()}
    for pattern in patterns:
        folder = pattern.rstrip("/")
        hits = [b for b in all_bugs() if b.name == folder or b.name.startswith(f"{folder}/")]
        hits = hits or [b for b in all_bugs() if fnmatch.fnmatchcase(b.name, pattern)]
        if not hits:
            folders = ", ".join(sorted({b.name.partition("/")[0] for b in all_bugs()}))
            raise InvalidInputError(f"no bug is called {pattern!r}; the folders are {folders}", pattern)
        chosen |= {bug.name: bug for bug in hits}
    return list(chosen.values())
