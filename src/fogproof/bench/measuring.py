"""Measuring in turn: each round runs every way once, so that all meet the machine in the same moods."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import math
import os
import platform
import statistics
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.bench.benchmark import Benchmark, Way

FEWEST = 3
"""Rounds at least; the first, which compiles and caches, is not counted."""


@dataclass(frozen=True)
class WayTime:
    """What was measured of one way.

    fastest, median   seconds of the processor per unit, times the way's factor
    ratio, low, high  of its time to the base's in the same round: median and quartiles
    error    relative, None where there is none
    front    whether no other way of the benchmark is both faster and more accurate
    goal     as text, "" if none; `met` None without one
    """

    benchmark: str
    way: str
    unit: str
    fastest: float
    median: float
    ratio: float
    low: float
    high: float
    error: float | None
    front: bool
    goal: str
    met: bool | None
    rounds: int


def measure(benchmark: Benchmark, seconds: float) -> list[WayTime]:
    """Return what was measured of each way, in about so many seconds by the clock."""
    ways = benchmark.ways()
    started = time.perf_counter()
    errors = {name: _first(way) for name, way in ways.items()}
    times: dict[str, list[float]] = {name: [] for name in ways}
    while len(times[benchmark.base]) < FEWEST or time.perf_counter() - started < seconds * benchmark.rounds:
        for name, way in ways.items():
            before = way.clock()
            way.run()
            times[name].append((way.clock() - before) / way.units * way.factor)
    medians = {name: statistics.median(each) for name, each in times.items()}
    found = []
    for name in ways:
        ratios = np.array(times[name]) / np.maximum(times[benchmark.base], 1e-12)
        low, ratio, high = np.quantile(ratios, (0.25, 0.5, 0.75)).tolist()
        goal = benchmark.goals.get(name)
        found.append(
            WayTime(
                benchmark.name,
                name,
                benchmark.unit,
                min(times[name]),
                medians[name],
                ratio,
                low,
                high,
                errors[name],
                _on_the_front(name, medians, errors),
                str(goal or ""),
                None if goal is None else goal.met(ratio),
                len(times[name]),
            )
        )
    return found


def _first(way: Way) -> float | None:
    result = way.run()
    return None if way.error is None else float(way.error(result))


def _on_the_front(name: str, times: Mapping[str, float], errors: Mapping[str, float | None]) -> bool:
    """Return whether a way is not beaten in both (Pareto); False without an error."""
    mine = errors[name]
    if mine is None or math.isnan(mine):
        return False
    others = ((times[n], e) for n, e in errors.items() if n != name and e is not None and not math.isnan(e))
    return not any(t <= times[name] and e <= mine and (t, e) != (times[name], mine) for t, e in others)


def missing(benchmark: Benchmark) -> bool:
    """Return whether what a benchmark needs is not installed."""
    return bool(benchmark.needs) and importlib.util.find_spec(benchmark.needs) is None


def machine() -> dict[str, Any]:
    """Return what was measured on."""
    versions = {}
    for package in (
        "fogproof",
        "numpy",
        "scipy",
        "numba",
        "mitsuba",
        "miepython",
        "PythonicDISORT",
        "mpmath",
        "python-flint",
    ):
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return {
        "platform": platform.platform(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load": list(os.getloadavg()) if hasattr(os, "getloadavg") else None,
        "python": platform.python_version(),
        "versions": versions,
        "vectors": _vectors(),
    }


def _vectors() -> str:
    """Return the widest instructions that both NumPy and the processor have, "baseline" if none beyond those of every build."""
    found = np.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", [])
    return str(found[-1]) if found else "baseline"


def _processor() -> str:
    try:
        with open("/proc/cpuinfo") as file:
            names = [line.partition(":")[2].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor()


def table(rows: Iterable[WayTime]) -> str:
    """Return all ratios with their goals, as Markdown."""
    head = "| benchmark | way | ratio | quartiles | goal | time per unit | error | front |\n|---|---|--:|---|---|--:|--:|---|"
    lines = [
        f"| {row.benchmark} | {row.way} | {row.ratio:.3g} | {row.low:.3g} … {row.high:.3g} | {_goal(row)} | "
        f"{_time(row.median)} / {row.unit} | {'' if row.error is None else f'{row.error:.1e}'} | {'yes' if row.front else ''} |"
        for row in rows
    ]
    return "\n".join([head, *lines])


def _goal(row: WayTime) -> str:
    return "" if row.met is None else f"{row.goal}: {'met' if row.met else 'NOT met'}"


def _time(seconds: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.2g} s"
