"""Fresh processes: what imports and commands cost beside NumPy's import, in seconds of the processor."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable

from fogproof.bench.benchmark import Benchmark, Goal, Way, of_children


def _fresh(code: str) -> Callable[[], object]:
    return lambda: subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


def _imports() -> dict[str, Way]:
    return {
        "numpy": Way(_fresh("import numpy"), clock=of_children),
        "fogproof": Way(_fresh("import fogproof"), clock=of_children),
        "fogproof list": Way(_fresh("from fogproof.cli import main; main(['list'])"), clock=of_children),
    }


def benchmarks() -> list[Benchmark]:
    """Return them."""
    goals = {"fogproof": Goal("<=", 1.3), "fogproof list": Goal("<=", 8.0)}
    return [Benchmark("imports", "Fresh processes", "process", "numpy", _imports, goals)]
