"""Compiled kernels: numba, loaded where it is first needed, with a cache on disk that notices every edit.

Kernels live in this folder. Its files, save this one and `cache_files`, import numba, and nobody imports them at the head of
another file, except each other. So `import fogproof` stays light, and what compiles when can be seen from the names.

numba's own cache looks at the file of the outermost function alone: after an edit of a function it calls in another file, a
new process would still run the old machine code. Here the directory of the cache is named after a hash of all kernel files and
those of the media.
"""

from __future__ import annotations

import hashlib
import os
import sys
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from fogproof.estimators.kernels.cache_files import CacheFiles, prune

_LOCK = threading.RLock()
_MEDIA = Path(__file__).parents[1] / "media"
"""Where each kind of medium says how kernels look it up."""

KERNEL_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function for each combination of argument types it meets, or load it if it has been compiled before.

    Division by zero follows IEEE 754. Without a directory to write to, nothing is kept between processes.
    """
    import numba

    directory = cache_directory(Path(function.__code__.co_filename).parent)
    if directory is None:
        return numba.njit(**KERNEL_OPTIONS)(function)
    with _LOCK:
        before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(directory)
        try:
            compiled = numba.njit(cache=True, **KERNEL_OPTIONS)(function)  # the directory is read here
        finally:
            numba.config.CACHE_DIR = before
    compiled._cache._cache_file = CacheFiles(directory, f"{function.__module__}.{function.__qualname__}")
    return compiled


def inlined(function: Callable[..., Any]) -> Any:
    """Compile a function into each kernel that calls it; a call would cost more than what such a function does."""
    import numba

    return numba.njit(forceinline=True, **KERNEL_OPTIONS)(function)


@cache
def uncached(compiled: Any) -> Any:
    """Return a twin of a kernel for users' functions, compiled once a process: the hash does not know their sources."""
    import numba

    return numba.njit(**KERNEL_OPTIONS)(compiled.py_func)


@cache
def cache_directory(sources: Path) -> Path | None:
    """Return where the kernels of this folder are kept, None if that cannot be written.

    It lies in NUMBA_CACHE_DIR if that is set, else in the user's cache directory.
    """
    import numba

    root = Path(numba.config.CACHE_DIR) if numba.config.CACHE_DIR else _user_cache()
    words = hashlib.blake2b(f"{sys.version} {numba.__version__}".encode(), digest_size=10)
    for file in sorted({*sources.glob("*.py"), *_MEDIA.glob("*.py"), Path(__file__)}):
        words.update(file.read_bytes())
    directory = root / f"kernels-{words.hexdigest()}"
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    prune(root, directory)
    return directory if os.access(directory, os.W_OK | os.X_OK) else None


def _user_cache() -> Path:
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fogproof"
    except RuntimeError:  # nobody's home
        return Path(os.devnull)
