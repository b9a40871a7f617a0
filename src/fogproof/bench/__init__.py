"""Speed against error: every way to a number, measured in turn, as ratios that a machine's mood hardly moves.

A module of `subjects` with a function `benchmarks()` is a part of it; nothing lists the modules.
"""

from __future__ import annotations

import fnmatch
import importlib
import pkgutil
from collections.abc import Iterable
from functools import cache

from fogproof.bench import subjects
from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.errors import InvalidInputError

__all__ = ["Benchmark", "Goal", "Way", "all_benchmarks", "select"]


@cache
def all_benchmarks() -> tuple[Benchmark, ...]:
    """Return every benchmark, in the order of the modules' names."""
    names = sorted(f"{subjects.__name__}.{found.name}" for found in pkgutil.iter_modules(subjects.__path__))
    groups = (getattr(importlib.import_module(name), "benchmarks", None) for name in names)
    return tuple(benchmark for group in groups if group is not None for benchmark in group())


def select(patterns: Iterable[str]) -> list[Benchmark]:
    """Return the benchmarks whose name is one of the patterns or matches it as a glob; all without patterns.

    >>> [benchmark.name for benchmark in select(["sampl*"])]
    ['samplers']
    """
    patterns = list(patterns) or ["*"]
    chosen: dict[str, Benchmark] = {}
    for pattern in patterns:
        hits = [b for b in all_benchmarks() if fnmatch.fnmatchcase(b.name, pattern)]
        if not hits:
            names = ", ".join(b.name for b in all_benchmarks())
            raise InvalidInputError(f"no benchmark is called {pattern!r}; there are {names}", pattern)
        chosen |= {benchmark.name: benchmark for benchmark in hits}
    return list(chosen.values())
