"""Which cases a run is of, and the part of the false-alarm budget that each origin has."""

from __future__ import annotations

import contextlib
import difflib
import fnmatch
import os
from collections.abc import Iterable
from functools import partial

from fogproof.catalogue import Case, all_cases
from fogproof.catalogue.own import is_file, own_cases, packages
from fogproof.checks.limits import isolated
from fogproof.errors import FogproofError, InvalidInputError, SubjectError


def select(patterns: Iterable[str]) -> list[Case]:
    """Return the cases whose name is one of the patterns, begins with one as a folder, or matches it as a glob.

    `my_cases.py` stands for all cases of that file, `my_cases.py::name` for some of them, and the name under which an installed
    package offers cases for the package's. Without patterns: every case of the catalogue that does not ask to be named.
    """
    patterns = list(patterns)
    if not patterns:
        return [case for case in all_cases() if not case.by_name]
    with contextlib.chdir(os.curdir):  # a file of cases may go elsewhere; names that were given mean what they meant
        return _selected(patterns)


def require_listed(patterns: Iterable[str], seconds: float) -> None:
    """Have the cases of files and packages listed in a process of its own, or say that it takes longer than `seconds`."""
    offered = packages()
    for pattern in patterns:
        origin = pattern.partition("::")[0] if is_file(pattern) else pattern.partition("/")[0]
        if is_file(pattern) or origin in offered:
            try:
                isolated(partial(_list, os.getcwd(), origin), seconds)
            except SubjectError as error:
                raise InvalidInputError(f"{origin}: its cases cannot be listed: {error}", origin) from None


def _list(folder: str, origin: str) -> None:
    os.chdir(folder)
    with contextlib.suppress(FogproofError):  # whoever reads it next says so
        own_cases(origin)


def _selected(patterns: list[str]) -> list[Case]:
    offered = packages()
    chosen: dict[str, Case] = {}
    for pattern in patterns:
        for case in _matching(pattern, offered):
            if chosen.setdefault(case.name, case).origin != case.origin:
                what = f"{case.origin} and {chosen[case.name].origin or 'the catalogue'} both have a case {case.name!r}"
                raise InvalidInputError(f"{what}; rename one of them", pattern)
    origins = sorted({case.origin for case in chosen.values()})
    return [case for origin in origins for case in whole(origin) if chosen.get(case.name) is case]


def _matching(pattern: str, offered: list[str]) -> list[Case]:
    origin, _, name = pattern.partition("::") if is_file(pattern) else ("", "", pattern)
    if not origin and pattern.partition("/")[0] in offered:
        origin = pattern.partition("/")[0]
    cases = whole(origin)
    if is_file(pattern):
        prefix = cases[0].name.partition("/")[0]
        name = f"{prefix}/{name}" if name else prefix
    hits = [c for c in cases if c.name == name or c.name.startswith(name.rstrip("/") + "/")]
    hits = hits or [c for c in cases if fnmatch.fnmatchcase(c.name, name)]
    if not hits:
        by_name = {c.name: c for c in cases}
        close = [called(by_name[near]) for near in difflib.get_close_matches(name, by_name, n=3, cutoff=0.4)]
        hint = f"did you mean {', '.join(close)}?" if close else f"'fogproof list {origin}'".replace(" '", "'")
        raise InvalidInputError(f"no case is called {pattern!r}; {hint}{'' if close else ' shows all names'}", pattern)
    return hits


def whole(origin: str) -> tuple[Case, ...]:
    """Return the catalogue, or all cases of a file or a package."""
    return own_cases(origin) if origin else all_cases()


def called(case: Case) -> str:
    """Return what a user types to name a case."""
    return f"{case.origin}::{case.name.partition('/')[2]}" if is_file(case.origin) else case.name


def shares(cases: Iterable[Case], alpha: float) -> dict[str, float]:
    """Return the part of alpha that the catalogue, a file or a package has in a run of these cases, by its origin.

    A case has its weight's share of that, whichever others of its origin are run.
    """
    weights = {c.origin: sum(case.weight for case in whole(c.origin)) for c in cases}
    if len(weights) == 1:
        return dict.fromkeys(weights, alpha)
    return {origin: alpha * weight / sum(weights.values()) for origin, weight in weights.items()}
