"""Mitsuba's variant, and functions of its types called with arrays: at once where a usable LLVM is found, row by row otherwise.

Dr.Jit takes whatever libLLVM it finds. Versions before 17 end the process on some plugins ("Cannot select: fmaximum"), so the
vectorised variant is taken only where `DRJIT_LIBLLVM_PATH` names a library, or one of version 17 or later stands in a usual place.
"""

from __future__ import annotations

import glob
import importlib.util
import math
import os
import re
import threading
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, TypeVar

import numpy as np

from fogproof.domains import SpherePart, UnitSphere
from fogproof.errors import NotInstalledError

_PLACES = (
    "/usr/lib/*/",
    "/usr/lib/",
    "/usr/local/lib/",
    "/usr/lib64/",
    "/usr/lib/llvm-*/lib/",
    "/opt/homebrew/opt/llvm/lib/",
)
_NAMES = ("libLLVM.so.*", "libLLVM-*.so*", "libLLVM*.dylib")
_OLDEST = 17
T = TypeVar("T")
_CALLING = threading.RLock()  # Dr.Jit's state is the process's, and a second thread would meet a half-imported package


Plugin = Mapping[str, Any] | Callable[[], Mapping[str, Any]]
"""What `mitsuba.load_dict` takes, or a function that makes it: grids and images are made by Mitsuba itself."""


def _anywhere(x: np.ndarray) -> np.ndarray:
    return np.ones(len(x), dtype=bool)


SPHERE = UnitSphere()
ANYWHERE = SpherePart(_anywhere, 4 * math.pi)
"""All directions, without a chart of them: what is judged there is judged by labels alone."""


def installed() -> bool:
    """Return whether Mitsuba can be imported, without importing it."""
    return importlib.util.find_spec("mitsuba") is not None


@cache
def vectorised() -> bool:
    """Return whether an LLVM is there that the vectorised variant can use; if so, Dr.Jit is told of it."""
    if os.environ.get("DRJIT_LIBLLVM_PATH"):
        return True
    found: list[tuple[int, str]] = []
    for place in _PLACES:
        for name in _NAMES:
            for path in glob.glob(place + name):
                version = re.search(r"LLVM[-.a-z]*(\d+)", os.path.basename(path))
                if version:
                    found.append((int(version[1]), path))
    if not found or max(found)[0] < _OLDEST:
        return False
    os.environ["DRJIT_LIBLLVM_PATH"] = max(found)[1]
    return True


def load() -> Any:
    """Import Mitsuba and set the variant, or raise `NotInstalledError` with the line that installs it."""
    if not installed():
        raise NotInstalledError("Mitsuba 3", "mitsuba")
    with _CALLING:
        variant = "llvm_ad_rgb" if vectorised() else "scalar_rgb"
        import mitsuba

        if mitsuba.variant() != variant:
            mitsuba.set_variant(variant)
    return mitsuba


def description(plugin: Plugin) -> dict[str, Any]:
    """Return the dict of a plugin."""
    return dict(plugin() if callable(plugin) else plugin)


def loaded(mi: Any, plugin: Plugin) -> Any:
    """Return a plugin as Mitsuba's object."""
    return mi.load_dict(description(plugin))


def built(make: Callable[[Any], T]) -> T:
    """Return `make(mitsuba)`, with nobody else in Dr.Jit."""
    mi = load()
    with _CALLING:
        return make(mi)


def evaluate(function: Callable[..., tuple[Any, ...]], *columns: np.ndarray) -> np.ndarray:
    """Return (n, k) numbers: a function of Mitsuba's types at all rows of some arrays, its answers side by side.

    function  takes a Float for each array (n,), a Point2f or Vector3f for each (n, 2) or (n, 3), and returns a tuple of numbers
              and vectors
    """
    mi = load()
    n = len(columns[0])
    if n == 0:
        probe = evaluate(function, *(np.full((1, *column.shape[1:]), 0.5) for column in columns))
        return probe[:0]
    with _CALLING:
        if vectorised():
            answers = function(*(_wide(mi, column) for column in columns))
            return np.concatenate([_flat(answer, n) for answer in answers], axis=1)
        rows = [
            np.concatenate([np.ravel(np.asarray(answer, dtype=np.float64)) for answer in function(*values)])
            for values in zip(*(_narrow(mi, column) for column in columns), strict=True)
        ]
        return np.stack(rows)


def _wide(mi: Any, column: np.ndarray) -> Any:
    if column.ndim == 1:
        return mi.Float(np.ascontiguousarray(column, dtype=np.float32))
    kind = {2: mi.Point2f, 3: mi.Vector3f}[column.shape[1]]
    return kind(*(mi.Float(np.ascontiguousarray(c, dtype=np.float32)) for c in column.T))


def _narrow(mi: Any, column: np.ndarray) -> list[Any]:
    if column.ndim == 1:
        return list(column.tolist())
    kind = {2: mi.Point2f, 3: mi.Vector3f}[column.shape[1]]
    return [kind(*row) for row in column.tolist()]


def _flat(answer: Any, n: int) -> np.ndarray:
    """Return (n, k) float64 of an array of Dr.Jit, a number, or one row for all."""
    array = np.asarray(answer, dtype=np.float64)
    array = array.reshape(1, 1) if array.ndim == 0 else array[:, None] if array.ndim == 1 else array.T
    return np.broadcast_to(array, (n, array.shape[1]))
